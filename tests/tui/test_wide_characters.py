"""Chinese letters take two columns: charts, plans and figures keep their edges with them."""

from __future__ import annotations

from pathlib import Path

import pytest
from rich.cells import cell_len

from surveyapp.core.observing.typed_rows import plain_signs
from surveyapp.domain.chart import Chart, Series
from surveyapp.report.blocks import Figure, Label, Line
from surveyapp.report.text import block_text, display_width
from surveyapp.tui import texts
from surveyapp.tui.app import SurveyApp
from surveyapp.tui.cells import lines_of
from surveyapp.tui.screens.session import SessionScreen
from surveyapp.tui.widgets.canvas import Canvas
from surveyapp.tui.widgets.chart import chart_text
from surveyapp.tui.widgets.ledger import Ledger
from tests.tui.helpers_tui import (
    SMALL,
    make_project,
    settle,
)

WORDS = "转台每步之后的残差，相对于多位置程序的模型，其中包含温度的影响以及重复性"


def test_a_name_on_a_plan_takes_the_columns_that_it_has() -> None:
    canvas = Canvas(12, 2)
    canvas.sign(4, 0, "测站1")
    canvas.sign(8, 0, "x")  # within the second letter: written already
    canvas.sign(4, 4, "A\u0301b")
    canvas.sign(20, 4, "井")
    lines = canvas.text().plain.split("\n")
    assert [cell_len(line) for line in lines] == [12, 12]
    assert lines[0].lstrip("\u2800").startswith("测站1")
    assert "A\u0301b" in lines[1]


def test_no_line_of_a_chart_is_wider_than_its_place_and_its_words_are_whole() -> None:
    curves = (Series(WORDS, ((0.0, 0.0), (1.0, 1.0))), Series("残差", ((0.0, 1.0),), "dots"))
    chart = Chart(
        WORDS, WORDS, WORDS, curves, y_names=("第一位置", "第二位置"), note=f"{WORDS}，{WORDS}"
    )
    for width in (40, 56, 78):
        lines = chart_text(chart, width=width, height=20).plain.split("\n")
        assert max(map(cell_len, lines)) <= width
        frame = {line.index(mark) for line in lines for mark in "┤│" if mark in line[:width]}
        gutter = {cell_len(line[: line.index("┤")]) for line in lines if "┤" in line}
        assert gutter == {cell_len("第一位置")}
        assert len(frame) <= 2
    told = chart_text(chart, width=78, height=20).plain.replace("\n", "")
    assert f"{WORDS}，{WORDS}" in told  # two lines of it, cut by nobody
    assert lines_of("ab " * 40, 20) == ["ab ab ab ab ab ab ab"[:20], ("ab " * 40)[21:41]]


def test_a_wide_label_of_a_figure_shifts_nothing() -> None:
    parts = (Label((20.0, 5.0), "测站", "start"), Line((0.0, 0.0), (60.0, 0.0)))
    text = block_text(Figure("F", 60.0, 10.0, (*parts, Label((40.0, 5.0), "B", "start"))))
    plain = block_text(Figure("F", 60.0, 10.0, (*parts[1:], Label((40.0, 5.0), "B", "start"))))
    row = next(line for line in text.split("\n") if "B" in line)
    same = next(line for line in plain.split("\n") if "B" in line)
    assert "测站" in row
    assert display_width(row[: row.index("B")]) == same.index("B")


@pytest.mark.parametrize("size", [SMALL, (60, 18)])
async def test_a_hint_ends_its_lines_between_words(
    tmp_path: Path, size: tuple[int, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    """As in German at 80 columns: Nichts muss getippt werde/n."""
    hint = "Aufstellen und horizontieren. Nichts muss getippt werden;\nF8 geht weiter."
    monkeypatch.setattr(texts, "STEP_HINTS", dict.fromkeys(texts.STEP_HINTS, hint), raising=False)
    app = SurveyApp(str(make_project(tmp_path / "p")))
    async with app.run_test(size=size) as pilot:
        await settle(pilot)
        await pilot.press("enter")
        await settle(pilot)
        assert isinstance(app.screen, SessionScreen)
        place = app.screen.query_one(Ledger).region
        strips = app.screen._compositor.render_strips()
        rows = ["".join(s.text for s in strip)[place.x : place.right] for strip in strips]
        words = " ".join(row.strip() for row in rows[place.y : place.bottom] if row.strip())
        assert words == hint.replace("\n", " ")


def test_signs_of_any_keyboard_are_those_of_the_book() -> None:
    assert plain_signs("\uff11\uff17\uff19\uff0d\uff10\uff11\uff0d\uff15\uff16") == "179-01-56"
    assert plain_signs("12\u30025\uff2008\uff1a15") == "12.5@08:15"
    assert plain_signs("\u0662\u0664,\u0661") == "24,1"
    assert (
        plain_signs("179\u00b001\u203256\u2033 \u5ea6 \u00b2")
        == "179\u00b001\u203256\u2033 \u5ea6 \u00b2"
    )
