"""Covariances against Monte Carlo, invariances, variance components."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from surveyapp.core.network import adjust
from surveyapp.core.network.quality import confidence_scale, ellipse, family_critical, global_test
from surveyapp.core.network.variance_components import variance_components
from surveyapp.domain.observations import ObservationKind
from surveyapp.domain.traverse import Network
from tests.network.network_factory import ARC, make
from tests.network.repetitions import covariances, global_tests_failed

K = ObservationKind


@pytest.mark.statistical
def test_covariances_hold_in_repetitions() -> None:
    """250 of the 2000 of ``python -m bench repetitions``; the bounds follow from the number."""
    runs = 250
    found = covariances(runs, seed=20)
    assert abs(found.squares - found.total) < 3.3 * found.squares_sigma
    assert abs(found.distance - found.mean) < 3.3 * found.distance_sigma
    # eigenvalues of a Wishart matrix / runs: 1 +- a few sqrt(2 / runs)
    assert np.all(np.abs(found.eigenvalues - 1.0) < 5.0 * math.sqrt(2.0 / runs))


@pytest.mark.statistical
def test_the_global_test_fails_as_often_as_it_says() -> None:
    # binomial(150, 0.05): 99.9 % within 1 .. 17; bench repetitions draws 2000
    assert 1 <= global_tests_failed(150, seed=5) <= 17


def moved(network: Network, turn: float, east: float, north: float) -> Network:
    c, s = math.cos(turn), math.sin(turn)

    def point(e: float | None, n: float | None) -> tuple[float, float]:
        e, n = e or 0.0, n or 0.0
        return c * e + s * n + east, -s * e + c * n + north  # clockwise by turn

    points = tuple(replace(p, e=point(p.e, p.n)[0], n=point(p.e, p.n)[1]) for p in network.points)
    observations = tuple(
        replace(o, value=o.value + turn) if o.kind in (K.AZIMUTH, K.GYRO) else o
        for o in network.observations
    )
    return replace(network, points=points, observations=observations)


@pytest.mark.parametrize("datum", ["fixed", "free"])
def test_rotation_and_shift_move_the_points_and_nothing_else(datum: str) -> None:
    network, _ = make(41, ("direction", "distance", "azimuth", "angle"), datum=datum)
    turn, east, north = 1.234, 431_000.0, -3_811_000.0
    a, b = adjust(network), adjust(moved(network, turn, east, north))
    assert b.global_test.sum_of_squares == pytest.approx(a.global_test.sum_of_squares, rel=1e-7)
    back = moved(
        replace(
            network,
            points=tuple(
                replace(p, e=q.e, n=q.n) for p, q in zip(network.points, a.points, strict=True)
            ),
        ),
        turn,
        east,
        north,
    )
    for p, q, r in zip(back.points, b.points, a.points, strict=True):
        assert q.e == pytest.approx(p.e, abs=1e-7)
        assert q.n == pytest.approx(p.n, abs=1e-7)
        if q.ellipse is not None and r.ellipse is not None:
            assert q.ellipse.a_m == pytest.approx(r.ellipse.a_m, rel=1e-5)
            gap = q.ellipse.azimuth - r.ellipse.azimuth - turn
            assert math.sin(gap) == pytest.approx(0.0, abs=1e-4)
    for o, u in zip(a.observations, b.observations, strict=True):
        assert u.residual == pytest.approx(o.residual, abs=1e-9)
        assert u.redundancy == pytest.approx(o.redundancy, abs=1e-7)


def test_the_order_of_points_and_observations_does_not_matter() -> None:
    network, _ = make(42, ("direction", "distance", "gyro"), points=30)
    rng = np.random.default_rng(1)
    points = tuple(network.points[i] for i in rng.permutation(len(network.points)))
    order = rng.permutation(len(network.observations))
    observations = tuple(network.observations[i] for i in order)
    a, b = adjust(network), adjust(replace(network, points=points, observations=observations))
    for point in a.points:
        other = b.point(point.name)
        assert other.e == pytest.approx(point.e, abs=1e-8)
        assert other.sigma_e == pytest.approx(point.sigma_e, rel=1e-7)
    for i, place in enumerate(order):
        mine, other_obs = a.observations[place], b.observations[i]
        assert other_obs.standardized == pytest.approx(mine.standardized, abs=1e-6)


def test_variance_components_find_what_was_stated_wrongly() -> None:
    network, _ = make(60, ("direction", "distance"), points=16)
    stated = tuple(
        replace(o, sigma=o.sigma * (3.0 if o.kind is K.DISTANCE else 0.5))
        for o in network.observations
    )
    components, result = variance_components(replace(network, observations=stated))
    found = {item.group: item for item in components}
    assert found["distance"].sigma is not None
    assert abs(found["distance"].factor - 1 / 3) < 4 * found["distance"].sigma
    assert found["direction"].sigma is not None
    assert abs(found["direction"].factor - 2.0) < 4 * found["direction"].sigma
    assert result.global_test.ratio == pytest.approx(1.0, abs=1e-3)


def test_groups_can_be_named() -> None:
    network, _ = make(61, ("distance",), points=16)
    observations = tuple(
        replace(o, group="old" if i % 2 else "new", sigma=o.sigma * (2.0 if i % 2 else 1.0))
        for i, o in enumerate(network.observations)
    )
    components, _ = variance_components(replace(network, observations=observations))
    found = {item.group: item.factor for item in components}
    assert found["old"] == pytest.approx(0.5, abs=0.15)
    assert found["new"] == pytest.approx(1.0, abs=0.25)


def test_quantiles_against_printed_tables() -> None:
    # chi-square 0.975 and 0.025 with 10 degrees of freedom: 20.483 and 3.247
    test = global_test(10.0, 10, sigma_apriori=1.0, probability=0.95)
    assert test.upper == pytest.approx(math.sqrt(20.483 / 10), abs=1e-4)
    assert test.lower == pytest.approx(math.sqrt(3.247 / 10), abs=1e-4)
    # F(2, 10) at 95 %: 4.103; chi-square(2): 5.991
    assert confidence_scale(0.95, 10) == pytest.approx(math.sqrt(2 * 4.103), abs=1e-3)
    assert confidence_scale(0.95, None) == pytest.approx(math.sqrt(5.991), abs=1e-3)
    # normal 1 - 0.05/2: 1.960; tau(0.05, f = 10) = 1.839 (Pope 1976, table)
    assert family_critical(1, 0.05, None) == pytest.approx(1.960, abs=1e-3)
    t = 2.262  # t(0.975, 9)
    assert family_critical(1, 0.05, 10) == pytest.approx(
        math.sqrt(10) * t / math.sqrt(9 + t * t), abs=1e-3
    )
    assert family_critical(5, 0.05, 1) is None
    assert family_critical(0, 0.05, None) is None


def test_an_ellipse_that_can_be_checked_by_hand() -> None:
    north_east = ellipse(np.array([[5.0, 4.0], [4.0, 5.0]]))
    assert (north_east.a_m, north_east.b_m) == pytest.approx((3.0, 1.0))
    assert math.degrees(north_east.azimuth) == pytest.approx(45.0)
    east = ellipse(np.array([[9.0, 0.0], [0.0, 4.0]]))
    assert math.degrees(east.azimuth) == pytest.approx(90.0)
    assert (east.a_m, east.b_m) == (3.0, 2.0)


def test_the_shared_constant_is_estimated_and_correlates_the_sides() -> None:
    network, _ = make(70, ("direction", "distance", "gyro"), points=9)
    known = adjust(network)
    constant = next(item for item in known.shared if item.kind == "gyro_constant")
    assert constant.sigma < 10 * ARC  # better than stated beforehand
    assert abs(constant.value - 25 * ARC) < 4 * constant.sigma
    unknown = adjust(
        replace(network, constants=(replace(network.constants[0], value=0.0, sigma=None),))
    )
    other = next(item for item in unknown.shared if item.kind == "gyro_constant")
    assert unknown.dof == known.dof - 1
    assert other.sigma > constant.sigma
    assert abs(other.value - 25 * ARC) < 4 * other.sigma
