"""Sides of turning points: counted, inferred, and refused where two are equal in a row."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from surveyapp.domain.readings import ReadingKind
from surveyapp.errors import SurveyError
from surveyapp.io.fieldbook import parse_field_book
from surveyapp_models.angles import AngleUnit


def sides(rows: list[str]) -> str:
    text = "seq,kind,value,side\n" + "".join(f"{i},{row}\n" for i, row in enumerate(rows, 1))
    book = parse_field_book(text, angle_unit=AngleUnit.DEG, where="b")
    return "".join(str(r.side or "-") for r in book.live if r.kind is not ReadingKind.TRANSIT)


def refused(rows: list[str]) -> str:
    with pytest.raises(SurveyError) as caught:
        sides(rows)
    assert len(caught.value.problems) == 1
    return str(caught.value)


def points(values: list[float | None], kind: str = "reversal") -> list[str]:
    return [
        "missed,," if v is None else f"{kind},{v % 360 if kind == 'reversal' else v:.4f},"
        for v in values
    ]


def test_the_larger_reading_is_right() -> None:
    assert sides(points([1.0, 9.0, 1.2, 8.8])) == "LRLR"


def test_across_north_the_larger_reading_is_still_east() -> None:
    assert sides(points([359.0, 1.0, 359.1, 0.9])) == "LRLR"
    assert sides(points([1.0, 359.0, 0.9])) == "RLR"


def test_a_missed_point_takes_part_in_the_count() -> None:
    assert sides(points([1.0, 9.0, None, 8.8, 1.3])) == "LRLRL"
    assert sides(points([None, 9.0, 1.1])) == "LRL"


@pytest.mark.parametrize(
    "values",
    [
        [1.0, 9.0, 8.8, 1.2],
        [1.0, 9.0, 9.2, 1.2],
        [1.0, 9.0, 9.0, 1.2],
        [9.0, 1.0, 1.1],
        [1.0, 1.1, 9.0, 1.2],
        [1.0, 9.0, 1.2, None, None, 1.3, 8.8],
        [1.0, 9.0, None, None, 8.8, 1.2],
    ],
)
def test_two_equal_sides_in_a_row_ask_for_missed(values: list[float | None]) -> None:
    message = refused(points(values))
    assert "do not alternate" in message
    assert "missed" in message


def test_one_missed_too_many_is_noticed() -> None:
    assert "different sides" in refused(points([1.0, 9.0, None, 1.2, 8.8]))
    assert "different sides" in refused(points([1.0, 9.0, None, 1.2]))


def test_equal_labels_in_a_row_ask_for_missed() -> None:
    assert "missed" in refused(["reversal,1,L", "reversal,9,R", "reversal,8.8,R"])
    assert "missed" in refused(["reversal,1,L", "reversal,9,", "reversal,8.8,R"])
    assert sides(["reversal,1,L", "reversal,9,R", "missed,,", "reversal,8.8,R"]) == "LRLR"


def test_labels_fill_in_the_others() -> None:
    assert sides(["reversal,1,", "reversal,9,R", "reversal,1.2,"]) == "LRL"


def test_a_label_against_the_circle_is_refused() -> None:
    assert "contradicts" in refused(["reversal,1,R", "reversal,9,L", "reversal,1.2,R"])


def test_a_reversed_scale_keeps_its_labels_if_they_are_consistent() -> None:
    assert sides(["scale_reversal,-8,R", "scale_reversal,7.8,L", "scale_reversal,-7.6,R"]) == "RLR"
    rows = ["scale_reversal,-8,R", "scale_reversal,7.8,L", "scale_reversal,9.6,R"]
    assert "contradicts" in refused(rows)


def test_transits_between_do_not_matter() -> None:
    text = "seq,kind,value,elapsed_s\n1,scale_reversal,8,\n2,transit,0,10\n3,scale_reversal,-8,\n"
    text += "4,transit,0,60\n5,scale_reversal,7.9,\n"
    book = parse_field_book(text, angle_unit=AngleUnit.DEG, where="b")
    found = [str(r.side) for r in book.of_kind(ReadingKind.SCALE_REVERSAL)]
    assert found == ["R", "L", "R"]


def test_tape_zeros_before_and_after_are_swings_of_their_own() -> None:
    zeros = points([5.0, -4.0, 4.8], "tape_zero")
    run = points([1.0, 9.0, 1.2])
    after = points([6.0, -5.0, 5.8], "tape_zero")
    assert sides(zeros + run + after) == "RLRLRLRLR"


def test_a_missed_tape_zero_counts_and_bounds_nothing() -> None:
    rows = [*points([5.0, -4.0, None, -4.1, 4.6], "tape_zero"), *points([1.0, 9.0, 1.2])]
    assert sides(rows) == "RLRLRLRL"


def test_a_tape_at_rest_has_no_sides() -> None:
    rows = ["tape_zero,0.1,", "tape_zero,0.1,", "tape_zero,0.2,", *points([1.0, 9.0, 1.1])]
    assert sides(rows) == "---LRL"


@given(
    count=st.integers(3, 30),
    amplitude=st.floats(0.05, 40.0),
    ratio=st.floats(0.85, 1.0),
    north=st.floats(0.0, 360.0),
    first=st.sampled_from((1, -1)),
    missed=st.sets(st.integers(1, 28), max_size=3),
)
@settings(max_examples=150, deadline=None, derandomize=True)
def test_a_damped_swing_anywhere_on_the_circle_is_read_right(
    count: int, amplitude: float, ratio: float, north: float, *, first: int, missed: set[int]
) -> None:
    values: list[float | None] = [north + first * amplitude * (-ratio) ** k for k in range(count)]
    for k in missed:
        if k < count:
            values[k] = None
    both = {k % 2 for k, v in enumerate(values) if v is not None}
    if len(both) < 2 or amplitude * ratio**count < 0.001:
        return
    expected = "".join("R" if (k % 2 == 0) == (first > 0) else "L" for k in range(count))
    assert sides(points(values)) == expected


@given(
    count=st.integers(5, 20),
    dropped=st.integers(1, 18),
    ratio=st.floats(0.9, 0.999),
    north=st.floats(0.0, 360.0),
)
@settings(max_examples=100, deadline=None, derandomize=True)
def test_a_dropped_turning_point_is_always_noticed(
    count: int, dropped: int, ratio: float, north: float
) -> None:
    values: list[float | None] = [north + 2.0 * (-ratio) ** k for k in range(count)]
    del values[min(dropped, count - 2)]
    assert "missed" in refused(points(values))
    assert math.isfinite(ratio)
