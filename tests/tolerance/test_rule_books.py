"""Every installed rule book: read, complete, and every limit just inside and just outside."""

from __future__ import annotations

from pathlib import Path

import pytest

from surveyapp.core.tolerance import QUANTITIES, Measured, limits_for, rule_book_checks
from surveyapp.core.tolerance.measures import MEASURES
from surveyapp.core.tolerance.quantities import quantity
from surveyapp.domain.rulebook import Limit, RuleBook
from surveyapp.domain.subject import Subject
from surveyapp.errors import SurveyError
from surveyapp.io.rulebooks import installed_rule_book_ids, read_rule_book, rule_book_text

BOOKS = {name: read_rule_book(name, base=Path()) for name in installed_rule_book_ids()}
LIMITS = [(book, limit) for book in BOOKS.values() for limit in book.limits]

# Transcribed by hand from the sources named in the books, not from the books: value of the limit
# with n = 4 and L = 2.5 km (L elsewhere where the row says so), in its own unit.
PRINTED: dict[tuple[str, str], float] = {
    ("cn-coal-15", "rounds"): 40.0,
    ("cn-coal-25", "rounds"): 70.0,
    ("cn-coal-15", "independent-difference"): 40.0,
    ("cn-coal-25", "independent-difference"): 60.0,
    ("cn-coal-15", "independent-mean"): 10.0,
    ("cn-coal-25", "independent-mean"): 15.0,
    ("cn-coal-15", "tape-zero"): 0.5,
    ("cn-coal-25", "tape-zero"): 0.5,
    ("cn-coal-15", "pre-orientation-tracking"): 60.0,
    ("cn-coal-15", "pre-orientation-transit"): 10.0,
    ("cn-coal-15", "sights"): 10.0,
    ("cn-coal-25", "sights"): 25.0,
    ("cn-coal-15", "rotor-rest"): 10.0,
    ("cn-coal-15", "circle-shift"): 0.9 * 45.0,
    ("cn-coal-15", "level"): 0.5,
    ("cn-coal-15", "closed-angles-7"): 28.0,
    ("cn-coal-15", "closed-angles-15"): 60.0,
    ("cn-coal-15", "closed-angles-30"): 120.0,
    ("cn-coal-15", "last-angle-7"): 20.0,
    ("cn-coal-15", "last-angle-15"): 40.0,
    ("cn-coal-15", "last-angle-30"): 80.0,
    ("cn-coal-15", "wires-surface"): 2.0,
    ("cn-coal-15", "wires-underground"): 4.0,
    ("cn-coal-15", "height-transfer"): 2500.0 / 8000.0,
    ("cn-coal-15", "lateral-within-mine"): 0.3,
    ("cn-coal-15", "vertical-within-mine"): 0.2,
    ("cn-coal-15", "lateral-between-mines"): 0.5,
    ("automatic-gyro", "rounds"): 10.0,
    ("automatic-gyro", "calibrations"): 15.0,
    ("metro", "rounds"): 20.0,
    ("mvt-2", "rounds"): 120.0,
    ("freezing-shaft-example", "mutual"): 40.0,
    ("freezing-shaft-example", "repeated"): 25.0,
    ("gb-50026-tunnel", "lateral-1"): 100.0,
    ("tb-10101-rail-tunnel", "lateral-1"): 100.0,
    ("jtg-c10-road-tunnel", "lateral-1"): 150.0,
    ("gotthard", "lateral"): 250.0,
    ("gotthard", "vertical"): 125.0,
    ("qld-rs10", "underground"): 50.0 * 2.7,
    ("qld-rs10", "surface"): 15.0 * 2.7,
}
UNCONFIRMED_BOOKS = {
    "metro",
    "mvt-2",
    "gb-50026-tunnel",
    "tb-10101-rail-tunnel",
    "jtg-c10-road-tunnel",
}


def variables_for(limit: Limit) -> dict[str, float]:
    """n and L for which the limit applies."""
    for length in (2.5, 5.5, 9.0, 12.0, 15.0, 18.0, 19.5):
        variables = {"n": 4.0, "L": length}
        book = RuleBook("b", "b", "s", (limit,))
        if limits_for(book, limit.quantity, variables=variables):
            return variables
    raise AssertionError(f"{limit.id} never applies")


@pytest.mark.parametrize(("book", "limit"), LIMITS, ids=[f"{b.id}.{x.id}" for b, x in LIMITS])
def test_every_limit_is_met_just_inside_and_not_met_just_outside(
    book: RuleBook, limit: Limit
) -> None:
    variables = variables_for(limit)
    ((_, bound),) = [
        item for item in limits_for(book, limit.quantity, variables=variables) if item[0] is limit
    ]
    assert bound > 0.0
    # a project may set a parameter of the book, and not below
    least = limit.sense == "at least" or quantity(limit.quantity).subject == "parameter"
    better = 1.0 if least else -1.0
    for factor, expected in (
        (1.0 + better * 1e-6, True),
        (1.0, True),
        (1.0 - better * 1e-6, False),
    ):
        item = Measured(
            limit.quantity,
            bound * factor,
            "here",
            "",
            variables,
            limit.class_name,
            subject=Subject.project(),
        )
        (check,) = [c for c in rule_book_checks(book, [item]) if c.rule == f"{book.id}.{limit.id}"]
        assert check.passed is expected
        assert check.confirmed is limit.confirmed
        assert check.unit == limit.unit
        assert check.value == pytest.approx(check.limit, rel=2e-6)


@pytest.mark.parametrize(("name", "printed"), PRINTED.items(), ids=[".".join(k) for k in PRINTED])
def test_limits_are_what_the_sources_print(name: tuple[str, str], printed: float) -> None:
    book = BOOKS[name[0]]
    limit = next(item for item in book.limits if item.id == name[1])
    values = {
        item.id: bound
        for item, bound in limits_for(book, limit.quantity, variables={"n": 4.0, "L": 2.5})
    }
    assert quantity(limit.quantity).in_unit(values[limit.id], limit.unit) == pytest.approx(printed)


@pytest.mark.parametrize(
    ("book", "lengths"),
    [
        ("gb-50026-tunnel", {3.999: 100, 4.0: 150, 7.9: 150, 8.0: 200, 9.999: 200, 10.0: None}),
        (
            "tb-10101-rail-tunnel",
            {3.9: 100, 5: 130, 8: 160, 12: 200, 14: 250, 17: 320, 19.9: 360, 20: None},
        ),
        ("jtg-c10-road-tunnel", {2.9: 150, 3.0: 200, 5.9: 200, 6.0: 300, 50.0: 300}),
    ],
)
def test_breakthrough_tolerances_step_with_the_length(
    book: str, lengths: dict[float, float | None]
) -> None:
    for length, millimetres in lengths.items():
        found = limits_for(BOOKS[book], "lateral", variables={"L": length})
        assert [1000.0 * bound for _, bound in found] == pytest.approx(
            [] if millimetres is None else [millimetres]
        )


def test_a_class_takes_its_own_limits_only() -> None:
    found = limits_for(BOOKS["cn-coal-15"], "lateral", class_name="between_mines")
    assert [(limit.id, bound) for limit, bound in found] == [("lateral-between-mines", 0.5)]


def test_what_no_source_confirms_is_marked_and_only_warns() -> None:
    for book, limit in LIMITS:
        if book.id in UNCONFIRMED_BOOKS or "General knowledge" in limit.source:
            assert not limit.confirmed, (book.id, limit.id)
        assert limit.clause
        assert limit.source


def test_a_limit_without_data_is_open_and_says_what_is_missing() -> None:
    checks = rule_book_checks(BOOKS["cn-coal-15"], [])
    measurable = [
        limit
        for limit in BOOKS["cn-coal-15"].limits
        if quantity(limit.quantity).subject != "parameter"
    ]
    assert len(checks) == len(measurable)
    assert all(check.passed is None and check.value is None for check in checks)
    assert all("missing: " in check.text for check in checks)


def test_every_orientation_quantity_is_measured_and_used_by_a_book() -> None:
    own = {item.id for item in QUANTITIES if item.subject == "orientation"}
    assert own == set(MEASURES)
    used = {limit.quantity for _, limit in LIMITS}
    assert {item.id for item in QUANTITIES} == used


def test_an_edited_copy_in_a_project_is_read_by_its_path(tmp_path: Path) -> None:
    text = rule_book_text("mvt-2", base=Path()).replace("limit = 120.0", "limit = 90.0")
    (tmp_path / "own.toml").write_text(text.replace('"mvt-2"', '"own"'), encoding="utf-8")
    book = read_rule_book("own.toml", base=tmp_path)
    assert (book.id, book.limits[0].limit) == ("own", 90.0)


def test_an_unknown_rule_book_names_the_nearest() -> None:
    with pytest.raises(SurveyError) as caught:
        read_rule_book("cn-coal-16", base=Path())
    assert "cn-coal-15" in caught.value.problems[0].hint


BAD = """
id = "bad"
title = "Bad"
source = "nobody"
colour = "red"
[[limit]]
id = "a"
quantity = "tape_zeros"
limit = 1
unit = "div"
clause = "1"
source = "s"
confirmed = true
[[limit]]
id = "a"
quantity = "tape_zero"
limit = "__import__('os')"
unit = "arcsec"
clause = "1"
source = "s"
[[limit]]
id = "c"
quantity = "lateral"
limit = -1.0
unit = "m"
clause = "1"
source = "s"
confirmed = false
sense = "below"
"""


def test_all_problems_of_a_rule_book_come_together(tmp_path: Path) -> None:
    (tmp_path / "bad.toml").write_text(BAD, encoding="utf-8")
    with pytest.raises(SurveyError) as caught:
        read_rule_book("bad.toml", base=tmp_path)
    said = "\n".join(str(problem) for problem in caught.value.problems)
    for words in (
        "colour is not known",
        "quantity is not known",
        "tape_zero",
        "two limits have one id",
        "limit is no formula",
        "not measured in arcsec",
        "confirmed is neither",
        "limit is no number",
        "sense is not known",
    ):
        assert words in said
