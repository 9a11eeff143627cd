"""Arbitrary TOML data and arbitrary cells never give anything but a result or a SurveyError."""

import contextlib
from pathlib import Path
from tempfile import TemporaryDirectory

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from surveyapp.domain.readings import COLUMNS
from surveyapp.errors import SurveyError
from surveyapp.io.fieldbook import parse_field_book
from surveyapp.io.project import read_project
from surveyapp.io.tomltext import toml_key, toml_value
from surveyapp_models.angles import AngleUnit

WORDS = st.sampled_from(
    [
        "A",
        "B",
        "line:A-B",
        "pooled",
        "known",
        "tracking",
        "survey",
        "dms",
        "gon",
        "wild-gak1",
        "r.csv",
    ]
)
LEAF = st.one_of(
    WORDS,
    st.text(max_size=8),
    st.integers(),
    st.floats(allow_nan=False, allow_infinity=False),
    st.booleans(),
    st.dates(),
)
VALUE = st.recursive(
    LEAF,
    lambda inner: st.one_of(
        st.lists(inner, max_size=3), st.dictionaries(st.text(max_size=4), inner, max_size=3)
    ),
    max_leaves=5,
)
KEYS = {
    "station": ("name", "e", "n", "lat", "lon", "y_west", "x_south", "h", "deflection"),
    "instrument": ("id", "card", "constant", "constant_choice", "effect", "sigma", "period"),
    "orientation": (
        "id", "station", "target", "instrument", "method", "purpose", "azimuth_known", "book",
        "eccentric", "effect", "date", "rounds", "centring_mm", "order",
    ),
    "sensor_log": ("id", "file", "sha256"),
}  # fmt: skip
TABLE = st.sampled_from(sorted(KEYS)).flatmap(
    lambda kind: st.tuples(
        st.just(kind), st.dictionaries(st.sampled_from(KEYS[kind]), VALUE, max_size=12)
    )
)
CELL = st.one_of(
    st.sampled_from(
        ["1", "2", "3", "reversal", "strike", "missed", "tape_zero", "10-00-00", "L", ""]
    ),
    st.floats().map(str),
    st.text(max_size=6),
)


@given(tables=st.lists(TABLE, max_size=6), top=st.dictionaries(WORDS, VALUE, max_size=2))
@settings(
    max_examples=120,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow],
)
def test_any_project_data_is_read_or_refused(
    tables: list[tuple[str, dict[str, object]]], top: dict[str, object]
) -> None:
    lines = ["format = 1", *(f"{toml_key(k)} = {toml_value(v)}" for k, v in top.items())]
    for kind, table in tables:
        lines.append(f"[[{kind}]]")
        lines += [f"{toml_key(k)} = {toml_value(v)}" for k, v in table.items()]
    with TemporaryDirectory() as name:
        folder = Path(name)
        text = "\n".join(lines)
        (folder / "project.toml").write_text(text, encoding="utf-8", errors="replace")
        (folder / "r.csv").write_text("seq,kind,value\n1,reversal,10-00-00\n", encoding="utf-8")
        with contextlib.suppress(SurveyError):
            read_project(folder)


@given(
    rows=st.lists(st.lists(CELL, min_size=3, max_size=11), max_size=8),
    unit=st.sampled_from(list(AngleUnit)),
    quoted=st.booleans(),
)
@settings(max_examples=150, deadline=None, derandomize=True)
def test_any_cells_are_read_or_refused(
    rows: list[list[str]], unit: AngleUnit, quoted: bool
) -> None:
    mark = '"' if quoted else ""
    body = "".join(",".join(f"{mark}{cell}{mark}" for cell in row) + "\n" for row in rows)
    with contextlib.suppress(SurveyError):
        parse_field_book(",".join(COLUMNS) + "\n" + body, angle_unit=unit, where="b")


KINDS = st.sampled_from(
    ["reversal", "scale_reversal", "tape_zero", "missed", "backsight", "transit"]
)
ROW = st.one_of(
    st.tuples(KINDS, st.integers(0, 3599).map(lambda k: f"{k / 10:.1f}"), st.sampled_from("LR ")),
    st.tuples(st.just("strike"), st.integers(1, 12).map(str), st.just(" ")),
)


@given(rows=st.lists(ROW, max_size=14))
@settings(max_examples=300, deadline=None, derandomize=True)
def test_live_rows_are_the_rows_that_are_not_struck(rows: list[tuple[str, str, str]]) -> None:
    text = "seq,kind,value,side,elapsed_s\n"
    for seq, (kind, value, side) in enumerate(rows, 1):
        shown = "" if kind == "missed" else value
        text += f"{seq},{kind},{shown},{side.strip()},{seq}\n"
    try:
        book = parse_field_book(text, angle_unit=AngleUnit.DEG, where="b")
    except SurveyError:
        return
    live = [r.seq for r in book.live]
    assert len(live) == len(set(live))
    whole = {r.seq for r in book.rows if r.seq not in book.struck and r.kind != "strike"}
    assert whole <= set(live)
    extra = set(live) - whole
    assert extra <= set(book.struck)
    assert all(r.kind == "missed" and r.value is None for r in book.live if r.seq in extra)
