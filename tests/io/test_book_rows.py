"""What the books of traverses and shafts have in common: a header that names each column once."""

from typing import Any

import pytest

from surveyapp.io.shafts.book import parse_shaft_book
from surveyapp.io.traverse.rows import parse_traverse
from surveyapp_models.angles import AngleUnit

BOOKS: dict[Any, tuple[str, str]] = {
    parse_traverse: ("kind,at,to,value,sigma", "distance,A,B,100.000,2"),
    parse_shaft_book: ("kind,place,at,to,value,sigma", "distance,surface,A,W1,12.000,1"),
}


@pytest.fixture(params=list(BOOKS), ids=lambda parse: parse.__name__)
def parse(request: pytest.FixtureRequest) -> Any:
    return request.param


def problems_of(parse: Any, text: str) -> tuple[list[Any], list[tuple[str, str]]]:
    rows, problems = parse(text, angle_unit=AngleUnit.DMS, where="book.csv")
    return rows, [(problem.what, problem.where) for problem in problems]


def test_a_whole_book_is_read_with_comments_and_empty_lines(parse: Any) -> None:
    header, row = BOOKS[parse]
    rows, problems = problems_of(parse, f"# of 2026\n{header}\n\n{row}\n")
    assert (len(rows), problems) == (1, [])
    assert rows[0].line == 4


def test_two_columns_of_one_name_are_refused_rather_than_one_of_them_taken(parse: Any) -> None:
    header, row = BOOKS[parse]
    rows, problems = problems_of(parse, f"{header},value\n{row},99.000\n")
    assert rows == []
    assert [what for what, _ in problems] == ["there are two columns value"]
    assert problems[0][1] == "book.csv, line 1"


def test_semicolons_are_told(parse: Any) -> None:
    header, row = BOOKS[parse]
    text = f"{header}\n{row}\n".replace(",", ";")
    _, problems = problems_of(parse, text)
    assert [what for what, _ in problems] == ["the columns are separated by semicolons"]


def test_a_header_of_a_thousand_columns_is_refused_at_once(parse: Any) -> None:
    header, row = BOOKS[parse]
    many = ",".join(f"x{number}" for number in range(1000))
    _, problems = problems_of(parse, f"{header},{many}\n{row}\n")
    assert len(problems) == 1
    assert "1000" in problems[0][0] or "columns" in problems[0][0]


def test_a_decimal_comma_makes_more_values_than_columns(parse: Any) -> None:
    header, row = BOOKS[parse]
    _, problems = problems_of(parse, f"{header}\n{row.replace('.000', ',000')}\n")
    assert problems == [("more values than columns", "book.csv, line 2")]


def test_every_row_with_a_problem_is_told(parse: Any) -> None:
    header, row = BOOKS[parse]
    wrong = row.replace("distance", "distant")
    _, problems = problems_of(parse, f"{header}\n{wrong}\n{row}\n{wrong}\n")
    assert problems == [
        ("the kind is not known", "book.csv, line 2"),
        ("the kind is not known", "book.csv, line 4"),
    ]
