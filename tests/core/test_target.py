"""The target of a determination: the session's own, else what its rule book's limits come to."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from surveyapp.core.observing.target import target_of
from surveyapp.domain.project import OrientationSession
from surveyapp.domain.readings import FieldBook
from surveyapp.domain.rulebook import Limit, RuleBook
from surveyapp.io.rulebooks import installed_rule_book_ids, read_rule_book
from surveyapp_models.angles import RHO_ARCSEC

BY_HAND = {
    # limit on two rounds, m = limit / (2 sqrt 2), 95 % = 1.959964 m, worked out on paper
    "automatic-gyro": (10.0, 3.5355, 6.9295, True),
    "cn-coal-15": (40.0, 14.1421, 27.7181, True),
    "cn-coal-25": (70.0, 24.7487, 48.5067, True),
    "freezing-shaft-example": (40.0, 14.1421, 27.7181, True),
    "metro": (20.0, 7.0711, 13.8590, False),
    "mvt-2": (120.0, 42.4264, 83.1542, False),
}
SILENT = {
    "gb-50026-tunnel",
    "gotthard",
    "jtg-c10-road-tunnel",
    "qld-rs10",
    "tb-10101-rail-tunnel",
    "at-mvo-2013",
    "de-markschbergv",
    "ussr-1985",
    "vsn-160-69",
    "wa-mines-2022",
}


def session(**override: object) -> OrientationSession:
    return OrientationSession(
        id="r1",
        station="A",
        target="B",
        instrument="G1",
        method="tracking",
        purpose="survey",
        book_path="observations/r1.csv",
        book=FieldBook((), ()),
        override=tuple(override.items()),
    )


def limit(quantity: str, value: float | str, **more: object) -> Limit:
    return Limit("x", quantity, value, "arcsec", "", "Art. 1", "own", confirmed=True, **more)  # type: ignore[arg-type]


def book(*limits: Limit) -> RuleBook:
    return RuleBook("office", "Own", "own", limits)


def test_every_installed_rule_book_is_accounted_for() -> None:
    assert set(installed_rule_book_ids()) == set(BY_HAND) | SILENT


@pytest.mark.parametrize("name", sorted(BY_HAND))
def test_two_rounds_may_differ_by_two_root_two_sigma(name: str) -> None:
    bound, sigma, interval, confirmed = BY_HAND[name]
    target = target_of(session(), read_rule_book(name, base=Path()))
    assert target is not None
    assert target.origin == "rule_book"
    assert target.book == name
    assert target.clause
    assert target.quantity == "rounds_difference"
    assert target.limit is not None
    assert target.sigma is not None
    assert target.limit * RHO_ARCSEC == pytest.approx(bound)
    assert target.sigma * RHO_ARCSEC == pytest.approx(sigma, abs=1e-4)
    assert target.interval95 * RHO_ARCSEC == pytest.approx(interval, abs=1e-3)
    assert target.confirmed is confirmed


@pytest.mark.parametrize("name", sorted(SILENT))
def test_a_rule_book_of_breakthroughs_sets_no_target(name: str) -> None:
    assert target_of(session(), read_rule_book(name, base=Path())) is None


def test_the_wanted_interval_of_the_session_wins() -> None:
    coal = read_rule_book("cn-coal-15", base=Path())
    target = target_of(session(wanted_interval_arcsec=8.0), coal)
    assert target is not None
    assert target.origin == "session"
    assert target.interval95 * RHO_ARCSEC == pytest.approx(8.0)
    assert target_of(session(wanted_interval_arcsec=8.0), None) == target
    assert target_of(session(), None) is None


def test_a_book_of_means_alone_asks_root_two_more_of_one() -> None:
    target = target_of(session(), book(limit("independent_mean_sigma", 10.0)))
    assert target is not None
    assert target.sigma is not None
    assert target.sigma * RHO_ARCSEC == pytest.approx(10.0 * math.sqrt(2.0))


def test_the_tightest_limit_counts_and_what_cannot_be_evaluated_does_not() -> None:
    target = target_of(
        session(),
        book(
            limit("rounds_difference", 60.0),
            limit("rounds_difference", "20 * n"),
            limit("rounds_difference", "10 * L"),
            limit("rounds_difference", 5.0, sense="at least"),
        ),
    )
    assert target is not None
    assert target.limit is not None
    assert target.limit * RHO_ARCSEC == pytest.approx(40.0)
