"""Strikes: what no longer counts, and who takes its place."""

import pytest

from surveyapp.domain.readings import FieldBook, ReadingKind
from surveyapp.errors import SurveyError
from surveyapp.io.fieldbook import parse_field_book
from surveyapp_models.angles import AngleUnit

HEADER = "seq,kind,value,face,side,target,note\n"


def book(*rows: str) -> FieldBook:
    text = HEADER + "".join(f"{i},{row}\n" for i, row in enumerate(rows, 1))
    return parse_field_book(text, angle_unit=AngleUnit.DEG, where="b")


def order(found: FieldBook) -> list[str]:
    """Live rows: seq, with an m where the row counts as missed."""
    return [f"{r.seq}{'m' if r.kind is ReadingKind.MISSED else ''}" for r in found.live]


def test_the_successor_stands_at_the_place_of_the_struck_row() -> None:
    found = book(
        "reversal,1,,,,",
        "reversal,90,,,,",
        "strike,2,,,,typed 90",
        "reversal,9,,,,",
        "reversal,1.2,,,,",
    )
    assert order(found) == ["1", "4", "5"]
    assert found.struck == (2,)
    assert len(found.rows) == 5


def test_a_struck_turning_point_without_successor_is_missed() -> None:
    found = book("reversal,1,,,,", "reversal,9,,,,", "reversal,1.2,,,,", "strike,3,,,,bump")
    assert order(found) == ["1", "2", "3m"]
    assert found.live[2].value is None


def test_the_next_turning_point_of_the_other_side_is_no_successor() -> None:
    """The observer strikes a doubtful left point; the swing goes on to the right."""
    rows = [
        "reversal,9,,,,",
        "reversal,1,,,,",
        "reversal,8.8,,,,",
        "reversal,1.2,,,,",
        "strike,4,,,,",
    ]
    rows += ["reversal,8.6,,,,", "reversal,1.4,,,,", "reversal,8.4,,,,"]
    assert order(book(*rows)) == ["1", "2", "3", "4m", "6", "7", "8"]


def test_explicit_sides_decide_before_magnitudes() -> None:
    rows = ["reversal,9,,R,,", "reversal,1,,L,,", "strike,2,,,,", "reversal,8.8,,R,,"]
    assert order(book(*rows)) == ["1", "2m", "4"]
    rows = ["reversal,9,,R,,", "reversal,1,,L,,", "strike,2,,,,", "reversal,1.1,,L,,"]
    assert order(book(*rows)) == ["1", "4"]


def test_early_in_a_run_later_points_tell_the_side() -> None:
    rows = ["reversal,181,,,,", "reversal,179.1,,,,", "strike,2,,,,", "reversal,181.2,,,,"]
    rows += ["reversal,179.2,,,,", "reversal,181.1,,,,"]
    found = book(*rows)
    assert order(found) == ["1", "2m", "4", "5", "6"]
    assert [str(r.side) for r in found.live] == ["R", "L", "R", "L", "R"]


def test_a_chain_of_strikes_ends_at_the_first_place() -> None:
    rows = ["reversal,1,,,,", "reversal,90,,,,", "strike,2,,,,", "reversal,91,,,,", "strike,4,,,,"]
    rows += ["reversal,9,,,,", "reversal,1.2,,,,", "reversal,8.8,,,,"]
    assert order(book(*rows)) == ["1", "6", "7", "8"]


def test_a_chain_that_ends_in_nothing_is_missed_at_the_first_place() -> None:
    rows = [
        "reversal,1,,L,,",
        "reversal,9,,R,,",
        "strike,2,,,,",
        "reversal,9.1,,R,,",
        "strike,4,,,,",
    ]
    rows += ["reversal,1.2,,L,,"]
    assert order(book(*rows)) == ["1", "4m", "6"]


def test_a_correction_after_the_run_returns_to_its_place() -> None:
    rows = ["backsight,40,L,,,", "reversal,1,,,,", "reversal,90,,,,", "reversal,1.2,,,,"]
    rows += ["backsight,40.1,L,,,", "strike,3,,,,mistyped", "reversal,9,,,,"]
    found = book(*rows)
    assert order(found) == ["1", "2", "7", "4", "5"]
    assert [str(found.place_of(r)) for r in found.of_kind(ReadingKind.BACKSIGHT)] == [
        "before",
        "after",
    ]


def test_a_sight_entered_as_turning_point_does_not_pull_the_run_before_the_sights() -> None:
    rows = ["reversal,40,,,,", "strike,1,,,,wrong kind", "backsight,40,L,,,", "backsight,220,R,,,"]
    found = book(*rows, "reversal,1,,,,", "reversal,9,,,,", "reversal,1.2,,,,")
    assert order(found) == ["3", "4", "5", "6", "7"]
    sights = found.of_kind(ReadingKind.BACKSIGHT)
    assert [str(found.place_of(r)) for r in sights] == ["before", "before"]


def test_a_sight_is_not_moved_from_after_to_before() -> None:
    rows = ["backsight,40,L,,,", "backsight,220,R,,,", "strike,1,,,,", "reversal,1,,,,"]
    rows += ["reversal,9,,,,", "backsight,40.1,L,,,"]
    assert order(book(*rows)) == ["2", "4", "5", "6"]


def test_a_sight_struck_after_the_run_is_not_replaced_by_one_after_it() -> None:
    rows = ["backsight,40,L,,,", "reversal,1,,,,", "reversal,9,,,,", "strike,1,,,,"]
    rows += ["backsight,40.1,L,,,"]
    assert order(book(*rows)) == ["2", "3", "5"]


def test_a_sight_is_replaced_by_its_own_face_and_target() -> None:
    rows = ["backsight,40,L,,A,", "strike,1,,,,", "backsight,220,R,,A,", "backsight,90,L,,B,"]
    rows += ["backsight,40.1,L,,A,", "reversal,1,,,,"]
    assert order(book(*rows)) == ["5", "3", "4", "6"]


def test_a_tape_zero_stays_on_its_side_of_the_run() -> None:
    rows = ["tape_zero,5,,,,", "tape_zero,-4,,,,", "strike,2,,,,", "tape_zero,-4.1,,,,"]
    rows += ["tape_zero,4.8,,,,", "reversal,1,,,,", "reversal,9,,,,", "tape_zero,6,,,,"]
    rows += ["tape_zero,-5,,,,", "strike,8,,,,"]
    found = book(*rows)
    assert order(found) == ["1", "4", "5", "6", "7", "8m", "9"]


def test_other_kinds_are_replaced_by_the_next_of_their_kind() -> None:
    rows = ["temperature,200,,,,", "note,,,,,", "strike,1,,,,"]
    with pytest.raises(SurveyError, match="strike names a row") as caught:
        book(*rows, "strike,77,,,,")
    assert len(caught.value.problems) == 1
    assert order(
        book("temperature,120,,,,", "note,,,,,", "strike,1,,,,", "temperature,20,,,,")
    ) == [
        "4",
        "2",
    ]


def timed(*rows: str) -> FieldBook:
    """A book whose rows are ten seconds apart."""
    text = "elapsed_s," + HEADER
    text += "".join(f"{10 * i},{i},{row}\n" for i, row in enumerate(rows, 1))
    return parse_field_book(text, angle_unit=AngleUnit.DEG, where="b")


@pytest.mark.parametrize("between", ["scale_reversal,-7,,,,", "missed,,,,,"])
def test_a_passage_behind_the_next_turning_point_is_a_later_one(between: str) -> None:
    begin = ["scale_reversal,7,,,,", "transit,0,,,,", "strike,2,,,,too late"]
    assert order(timed(*begin, "transit,0,,,,", between)) == [
        "1",
        "4",
        "5m" if between.startswith("missed") else "5",
    ]
    found = timed(*begin, between, "transit,0,,,,")
    assert [row.seq for row in found.live] == [1, 4, 5]


@pytest.mark.parametrize(
    ("rows", "word"),
    [
        (["note,,,,,", "strike,3,,,,", "note,,,,,"], "stand above"),
        (["note,,,,,", "strike,1,,,,", "strike,2,,,,"], "cannot be struck"),
        (["note,,,,,", "strike,1,,,,", "strike,1,,,,"], "already"),
        (["note,,,,,", "strike,x,,,,"], "names no row"),
        (["note,,,,,", "strike,,,,,"], "names no row"),
        (["strike,1,,,,"], "stand above"),
    ],
)
def test_a_strike_names_an_earlier_row_that_counts(rows: list[str], word: str) -> None:
    with pytest.raises(SurveyError, match=word):
        book(*rows)


def test_two_strikes_in_a_row_are_filled_in_order_of_place() -> None:
    rows = [
        "reversal,1,,L,,",
        "reversal,99,,R,,",
        "reversal,98,,L,,",
        "strike,3,,,,",
        "strike,2,,,,",
    ]
    rows += ["reversal,9,,R,,", "reversal,1.2,,L,,"]
    assert order(book(*rows)) == ["1", "6", "7"]
