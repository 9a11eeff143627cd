"""Layout without a survey: column widths, faces, axes, text."""

from __future__ import annotations

import io
import math

import pypdf
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from surveyapp.report.blocks import (
    Anchor,
    Document,
    Heading,
    KeyValues,
    Label,
    Line,
    Signature,
    Table,
)
from surveyapp.report.blocks import Figure as Drawing
from surveyapp.report.numbers import plain, signed_angle
from surveyapp.report.pdf import write_pdf
from surveyapp.report.pdf.tables import column_widths
from surveyapp.report.plots import Frame, axis, half_wave
from surveyapp.report.text import block_text, display_width
from surveyapp.report.typeface import MISSING, Face, language_of, runs
from surveyapp_models.angles import ARCSEC

COLUMN = st.tuples(st.floats(5.0, 900.0), st.floats(0.05, 1.0))


@settings(deadline=None, derandomize=True)
@given(st.lists(COLUMN, min_size=1, max_size=12))
def test_columns_fill_the_page_and_never_leave_it(columns: list[tuple[float, float]]) -> None:
    natural = [width for width, _ in columns]
    smallest = [width * share for width, share in columns]
    widths = column_widths(natural, smallest, 490.0)
    assert sum(widths) <= 490.0 + 1e-6
    if sum(natural) <= 490.0:
        assert widths == natural
    elif sum(smallest) <= 490.0:
        assert sum(widths) == pytest.approx(490.0, abs=0.1)
        assert all(w >= s - 1e-6 for w, s in zip(widths, smallest, strict=True))


LATIN = Face("latin", lambda code: code < 0x500)
HAN = Face("han", lambda code: 0x4E00 <= code <= 0x9FFF)


def test_runs_change_the_face_where_the_script_changes() -> None:
    assert runs("Шахта 潼金矿 3", (LATIN, HAN)) == [
        ("latin", "Шахта "),
        ("han", "潼金矿 "),
        ("latin", "3"),
    ]
    assert runs("a\tb", (LATIN,)) == [("latin", "a b")]
    assert runs("서", (LATIN, HAN)) == [("latin", MISSING)]


@settings(deadline=None, derandomize=True)
@given(st.text(max_size=40))
def test_runs_lose_no_character(text: str) -> None:
    assert sum(len(run) for _, run in runs(text, (LATIN, HAN))) == len(text)


def test_language_decides_the_last_resort() -> None:
    assert [language_of(t) for t in ("潼金矿", "東京のかな", "서울")] == ["zh", "ja", "ko"]


@settings(deadline=None, derandomize=True)
@given(st.lists(st.floats(-1e6, 1e6), max_size=20), st.booleans())
def test_an_axis_holds_its_values_and_has_ticks(values: list[float], centred: bool) -> None:
    made = axis(values, about_zero=centred)
    assert made.low < made.high
    assert all(made.low <= value <= made.high for value in values)
    assert 2 <= len(made.ticks) <= 13
    assert all(math.isfinite(tick) for tick in made.ticks)


def test_ticks_are_round() -> None:
    assert axis([0.0, 10.0]).ticks == pytest.approx([0.0, 5.0, 10.0], abs=1e-9) or set(
        axis([0.0, 10.0]).ticks
    ) == {0.0, 2.5, 5.0, 7.5, 10.0}
    assert axis([-229.5, 231.5], about_zero=True).ticks == pytest.approx([-200.0, 0.0, 200.0])


def test_a_half_wave_passes_through_its_turning_points() -> None:
    points = [(1.0, -3.0), (2.0, 2.5), (3.0, -2.0)]
    curve = half_wave(points)
    assert all(point in curve for point in points)
    assert min(y for _, y in curve) == -3.0
    assert max(y for _, y in curve) == 2.5


def test_a_table_in_a_terminal_keeps_its_columns_with_wide_characters() -> None:
    text = block_text(Table(("name", "n"), (("潼金矿", "1"), ("ab", "22")), "lr"))
    assert len({display_width(line) for line in text.splitlines()}) == 1


def test_a_figure_in_a_terminal_shows_its_labels() -> None:
    frame = Frame(axis([0.0, 4.0]), axis([-1.0, 1.0]))
    parts = [*frame.axes("turning point", "arcsec"), *frame.marks([(2.0, 0.5)], "dot")]
    text = block_text(frame.figure("Residuals", parts))
    assert "turning point" in text
    assert "*" in text


def test_numbers_say_what_is_not_known() -> None:
    assert plain(None) == plain(math.inf) == plain(math.nan) == "-"
    assert plain(-0.0001, 2) == "0.00"
    assert signed_angle(-1519.79 * ARCSEC) == "-25'19.79\""
    assert signed_angle(3723.45 * ARCSEC) == "+1\N{DEGREE SIGN}02'03.45\""
    assert signed_angle(-1e-9 * ARCSEC) == '+0.00"'
    assert signed_angle(59.999 * ARCSEC) == "+1'00.00\""


def test_odd_blocks_can_be_written() -> None:
    """A word longer than a page is wide, markup in text, an empty table, hundreds of rows."""
    blocks = (
        Heading("<b>&amp;</b> \x07"),
        KeyValues((("k" * 300, "v" * 3000),)),
        Table(("a", "b"), ()),
        Table(("x" * 400, "y"), (("z" * 900, "1" * 300),) * 2, struck=frozenset({1})),
        Table(("n",), tuple((str(i),) for i in range(300)), "r"),
        Drawing("f", 50.0, 20.0, (Line((0, 0), (50, 20), "mean"), Label((5, 5), "潼金矿"))),
    )
    document = Document("t", "h" * 500, ("f" * 500, "g"), blocks)
    written = write_pdf(document)
    assert written.pages > 3
    assert write_pdf(document).data == written.data


def test_a_cell_taller_than_a_page_loses_no_word() -> None:
    words = " ".join(f"w{index}" for index in range(3000))
    blocks = (Table(("a", "b"), (("x", words), ("y", "last"))), KeyValues((("k", words),)))
    written = write_pdf(Document("t", "h", ("f",), blocks))
    reader = pypdf.PdfReader(io.BytesIO(written.data))
    found = " ".join(page.extract_text() for page in reader.pages).split()
    assert [found.count(f"w{index}") for index in (0, 1234, 2999)] == [2, 2, 2]
    assert "last" in found


def test_the_heading_of_the_signatures_stands_with_its_lines() -> None:
    """Wherever on a page the record ends: every second of its last 36 lines is tried."""
    end = (Heading("Signatures"), Signature(("Observed", "Computed", "Checked")))
    counts = []
    for lines in range(20, 56, 2):
        rows = tuple((f"row {k}",) for k in range(lines))
        written = write_pdf(Document("t", "h", ("f",), (Table(("a",), rows), *end)))
        pages = [page.extract_text() for page in pypdf.PdfReader(io.BytesIO(written.data)).pages]
        (page,) = [text for text in pages if "Signatures" in text]
        assert "Observed" in page, lines
        assert "Checked" in page, lines
        counts.append(len(pages))
    # on the page of what stands before, as long as there is room: 56 mm of 253 mm
    assert counts == sorted(counts)
    assert counts[0] == 1


@pytest.mark.parametrize("anchor", ["start", "middle", "end"])
def test_a_label_keeps_its_letters_wherever_it_stands(anchor: Anchor) -> None:
    for tenth in range(400, 460):
        figure = Drawing("a figure", 120.0, 20.0, (Label((tenth / 10, 1.0), "time [s]", anchor),))
        assert "time [s]" in block_text(figure), tenth
