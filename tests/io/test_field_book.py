"""Columns, units and tokens of the field book; every refusal names its line."""

import math

import pytest

from surveyapp.domain.readings import FieldBook, ReadingKind, Side
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.fieldbook import parse_field_book
from surveyapp_models.angles import ARCSEC, AngleUnit

HEADER = "seq,time,elapsed_s,kind,value,unit,face,side,target,temperature_c,note\n"


def read(text: str, unit: AngleUnit = AngleUnit.DMS) -> FieldBook:
    return parse_field_book(text, angle_unit=unit, where="book.csv")


def refused(text: str, unit: AngleUnit = AngleUnit.DMS) -> tuple[Problem, ...]:
    with pytest.raises(SurveyError) as caught:
        read(text, unit)
    return caught.value.problems


def only(text: str, unit: AngleUnit = AngleUnit.DMS) -> Problem:
    problems = refused(text, unit)
    assert len(problems) == 1, problems
    return problems[0]


@pytest.mark.parametrize("text", ["179-01-56.0", "179:01:56", "179 01 56", "179°01'56\""])
def test_every_dms_spelling_is_the_same_angle(text: str) -> None:
    escaped = '"' + text.replace('"', '""') + '"'
    book = read(f"seq,kind,value\n1,backsight,{escaped}\n")
    assert book.rows[0].value == pytest.approx(math.radians(179 + 116 / 3600), abs=1e-15)
    assert book.rows[0].text == text


def test_columns_are_found_by_name_and_others_may_be_absent() -> None:
    book = read("value,weather,KIND,seq\n200.5,rain,backsight,7\n", AngleUnit.GON)
    assert book.rows[0].seq == 7
    assert book.rows[0].value == pytest.approx(200.5 * math.pi / 200)


def test_bom_crlf_and_blank_lines_do_not_matter() -> None:
    plain = "seq,kind,value\n1,backsight,10-00-00\n2,backsight,190-00-00\n"
    odd = "\ufeff" + plain.replace("\n", "\r\n").replace("2,", "\r\n2,")
    odd_rows = [(r.seq, r.kind, r.value) for r in read(odd).rows]
    assert odd_rows == [(r.seq, r.kind, r.value) for r in read(plain).rows]


def test_lines_of_commas_are_empty_lines() -> None:
    assert len(read("seq,kind,value\n,,\n1,note,\n").rows) == 1


def test_unit_column_wins_over_the_project() -> None:
    book = read("seq,kind,value,unit\n1,backsight,100,gon\n2,backsight,90,deg\n")
    assert [r.value for r in book.rows] == pytest.approx([math.pi / 2, math.pi / 2])


@pytest.mark.parametrize(("text", "unit"), [("400", "gon"), ("360", "deg"), ("360-00-00", "dms")])
def test_a_full_circle_counts_as_zero(text: str, unit: str) -> None:
    assert read(f"seq,kind,value,unit\n1,backsight,{text},{unit}\n").rows[0].value == 0.0


@pytest.mark.parametrize(
    ("value", "unit", "word"),
    [
        ("365-00-00", "dms", "gon"),
        ("365", "deg", "gon"),
        ("198.9247", "dms", "gon or deg in the unit column"),
        ("179-01-56", "gon", "dms in the unit column"),
        ("-10-00-00", "dms", ""),
        ("-10", "gon", ""),
        ("400.001", "gon", ""),
        ("north", "dms", ""),
        ("nan", "deg", ""),
        ("inf", "gon", ""),
        ("1e999", "deg", ""),
    ],
)
def test_what_is_no_circle_reading_is_refused(value: str, unit: str, word: str) -> None:
    problem = only(f"seq,kind,value,unit\n5,reversal,{value},{unit}\n")
    assert problem.where == "book.csv, line 2 (seq 5)"
    assert problem.found == value
    assert word in problem.hint


@pytest.mark.parametrize(
    ("kind", "value", "unit", "expected"),
    [
        ("scale_reversal", "-7.5", "", -7.5),
        ("tape_zero", "+11.4", "div", 11.4),
        ("level_along", "12", "arcsec", 12 * ARCSEC),
        ("level_across", "-3", "", -3 * ARCSEC),
        ("supply", "24.1", "V", 24.1),
        ("supply", "400", "Hz", 400.0),
        ("supply", "850", "mA", 850.0),
        ("temperature", "-4.5", "", -4.5),
        ("temperature", "-4.5", "C", -4.5),
    ],
)
def test_values_and_their_own_units(kind: str, value: str, unit: str, expected: float) -> None:
    row = read(f"seq,kind,value,unit\n1,{kind},{value},{unit}\n").rows[0]
    assert row.value == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize(
    ("kind", "value", "unit"),
    [
        ("scale_reversal", "7.5", "dms"),
        ("reversal", "7.5", "div"),
        ("supply", "24", ""),
        ("supply", "24", "C"),
        ("level_along", "1-00-00", "dms"),
        ("temperature", "20", "K"),
        ("temperature", "2000", "C"),
        ("tape_zero", "nan", ""),
        ("tape_zero", "inf", ""),
        ("tape_zero", "1e300", ""),
        ("backsight", "10-00-00", "s"),
        ("backsight", "", ""),
    ],
)
def test_wrong_units_and_values_are_refused(kind: str, value: str, unit: str) -> None:
    assert only(f"seq,kind,value,unit\n1,{kind},{value},{unit}\n").where.startswith(
        "book.csv, line 2"
    )


def test_semicolons_are_one_problem_with_a_hint() -> None:
    problem = only("seq;kind;value\n1;reversal;10,5\n2;reversal;11,5\n")
    assert "semicolons" in problem.what
    assert "point" in problem.hint


@pytest.mark.parametrize(
    "text",
    [
        "seq,kind,value\n1,tape_zero,11,4\n",
        'seq,kind,value\n1,tape_zero,"11,4"\n',
        "seq,kind,value,unit\n1,tape_zero,11,4\n",
        'seq,kind,value,unit\n1,backsight,"11,4",gon\n',
    ],
)
def test_decimal_commas_are_refused_with_a_hint(text: str) -> None:
    assert "point" in only(text).hint


def test_missing_columns_name_the_nearest() -> None:
    problems = refused("seq,knd,val\n1,a,b\n")
    assert [p.what for p in problems] == ["there is no column kind", "there is no column value"]
    assert "knd" in problems[0].hint


def test_a_doubled_column_is_refused() -> None:
    assert "two columns" in only("seq,kind,value,value\n1,note,,\n").what


def test_an_unknown_kind_names_the_nearest() -> None:
    assert "reversal" in only("seq,kind,value\n1,reversl,10-00-00\n").hint


@pytest.mark.parametrize("seq", ["", "x", "1.5", "-1", "99999999999", "²"])
def test_seq_is_a_whole_number(seq: str) -> None:
    assert "seq" in only(f"seq,kind,value\n{seq},note,\n").what


def test_seq_is_unique_and_increasing() -> None:
    problems = refused("seq,kind,value\n1,note,\n3,note,\n3,note,\n2,note,\n4,note,\n")
    assert [p.where for p in problems] == ["book.csv, line 4", "book.csv, line 5"]


def test_time_goes_forward_in_seconds() -> None:
    text = HEADER + "1,,10,note,,,,,,,\n2,,10,note,,,,,,,\n3,,9.5,note,,,,,,,\n"
    assert "goes back" in only(text).what


def test_a_struck_row_may_have_a_wrong_time_and_a_wrong_value() -> None:
    text = HEADER + "1,,9000,reversal,365-00-00,,,,,,\n2,,,strike,1,,,,,,typed wrong\n"
    text += "3,,900,reversal,181-00-00,,,,,,\n"
    assert [r.seq for r in read(text).live] == [3]


@pytest.mark.parametrize(
    "time", ["2026-11-22T08:15:30+01:00", "2026-11-22T07:15:30Z", "2026-11-22T07:15:30.25+00:00"]
)
def test_time_with_offset_is_read(time: str) -> None:
    row = read(HEADER + f"1,{time},,note,,,,,,,\n").rows[0]
    assert row.time is not None
    assert row.time.timestamp() == pytest.approx(1795331730, abs=0.3)


@pytest.mark.parametrize("time", ["2026-11-22T08:15:30", "08:15", "yesterday", "2026-13-01T00:00Z"])
def test_time_without_offset_is_refused(time: str) -> None:
    assert "time" in only(HEADER + f"1,{time},,note,,,,,,,\n").what


def test_a_transit_needs_its_moment() -> None:
    assert "moment" in only(HEADER + "1,,,transit,0,,,,,,\n").what
    assert read(HEADER + "1,,12.4,transit,0,,,,,,\n").rows[0].elapsed_s == 12.4


def test_face_and_side_in_lower_case() -> None:
    book = read(HEADER + "1,,,backsight,10-00-00,,l,,,,\n2,,,reversal,10-00-00,,,r,,,\n")
    assert [(str(r.face or ""), str(r.side or "")) for r in book.rows] == [("L", ""), ("", "R")]
    assert "face" in only(HEADER + "1,,,backsight,10-00-00,,X,,,,\n").what


def test_missed_has_no_value() -> None:
    assert "missed" in only("seq,kind,value\n1,missed,10-00-00\n").what


def test_control_characters_and_open_quotes_are_refused() -> None:
    assert "control" in only(HEADER + "1,,,note,,,,,,,\x1b[31m\n").what
    assert "CSV" in only(HEADER + '1,,,note,,,,,,,"open\n').what


def test_all_problems_of_a_book_come_together() -> None:
    text = "seq,kind,value,unit\n1,reversal,x,\n2,supply,24,\n3,nonsense,,\n4,missed,1,\n"
    assert [p.where for p in refused(text)] == [
        "book.csv, line 2 (seq 1)",
        "book.csv, line 3 (seq 2)",
        "book.csv, line 4 (seq 3)",
        "book.csv, line 5 (seq 4)",
    ]


def test_a_file_of_another_kind_does_not_flood_the_screen() -> None:
    problems = refused("seq,kind,value\n" + "x\n" * 1000)
    assert len(problems) == 101
    assert problems[-1].what == "900 further problems"


def test_a_tail_without_newline_does_not_count() -> None:
    book = read("seq,kind,value\n1,backsight,10-00-00\n2,backsight,190-0")
    assert [r.seq for r in book.rows] == [1]
    assert book.torn_tail == "2,backsight,190-0"


def test_an_empty_book_has_no_rows() -> None:
    assert read("") == FieldBook((), ())
    assert read(HEADER).rows == ()


def test_sides_are_inferred_for_live_rows_only() -> None:
    book = read("seq,kind,value\n1,reversal,10-00-00\n2,reversal,350-00-00\n3,reversal,9-00-00\n")
    assert [r.side for r in book.live] == [Side.RIGHT, Side.LEFT, Side.RIGHT]
    assert [r.side for r in book.rows] == [None, None, None]
    assert book.of_kind(ReadingKind.REVERSAL) == book.live
