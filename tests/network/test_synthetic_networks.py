"""Synthetic networks of every kind against dense QR on numerically differentiated equations."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np
import pytest

from surveyapp.core.leastsquares import solution
from surveyapp.core.network import adjust, gaussnewton
from surveyapp.core.network.linearise import LINEARISATION
from surveyapp.domain.observations import Observation, ObservationKind
from surveyapp.domain.traverse import GyroConstant, Network, NetworkPoint, Status
from tests.network.network_factory import ARC, Independent, make

K = ObservationKind
CASES = [
    # kinds, datum, correlated
    (("distance",), "fixed", False),
    (("distance",), "free", False),
    (("direction",), "fixed", False),
    (("direction",), "free", False),
    (("angle",), "fixed", False),
    (("angle",), "free", False),
    (("angle", "distance"), "fixed", False),
    (("angle", "distance"), "free", False),
    (("angle", "distance"), "fixed", True),
    (("direction", "distance"), "fixed", False),
    (("direction", "distance"), "free", False),
    (("direction", "distance"), "free", True),
    (("direction", "distance", "azimuth"), "fixed", False),
    (("direction", "distance", "azimuth"), "free", False),
    (("direction", "distance", "gyro"), "fixed", False),
    (("direction", "distance", "gyro"), "free", False),
    (("direction", "distance", "gyro"), "fixed", True),
    (("angle", "distance", "gyro", "azimuth"), "fixed", False),
    (("distance", "azimuth"), "free", False),
    (("distance", "coordinate"), "free", False),
    (("direction", "distance", "coordinate"), "free", True),
    (("distance", "vector"), "fixed", False),
    (("distance", "vector"), "free", True),
    (("vector",), "free", False),
    (("height_difference",), "fixed", False),
    (("height_difference",), "free", False),
    (("height_difference",), "free", True),
    (("slope_distance",), "fixed", False),
    (("slope_distance", "zenith"), "fixed", False),
    (("slope_distance", "zenith", "direction"), "fixed", False),
    (("slope_distance", "zenith", "direction"), "free", False),
    (("slope_distance", "zenith", "direction"), "free", True),
    (("slope_distance", "zenith", "angle", "height_difference"), "fixed", False),
    (("distance", "direction", "height_difference"), "free", False),
    (("slope_distance", "zenith", "direction", "gyro", "azimuth"), "fixed", True),
    (("slope_distance", "zenith", "angle", "distance", "gyro", "vector"), "free", True),
]  # fmt: skip
IDS = [f"{'+'.join(kinds)}-{datum}{'-cov' if c else ''}" for kinds, datum, c in CASES]


@lru_cache(maxsize=4)
def solved(network: Network, defect: int) -> tuple[Independent, tuple[Any, ...]]:
    """Numerically differentiated equations and their solution, once for both routes."""
    other = Independent(network)
    return other, other.solve(defect)


def compare(network: Network, tolerance: float = 2e-6) -> None:
    result = adjust(network)
    other, (x, cofactor, squares, redundancy) = solved(network, result.defect)
    assert result.dof == len(other.observations) - len(x) + result.defect
    assert result.global_test.sum_of_squares == pytest.approx(squares, rel=1e-6, abs=1e-9)
    sums = sum(item.redundancy for item in result.observations)
    assert sums == pytest.approx(result.dof, abs=1e-6)
    np.testing.assert_allclose(
        [item.redundancy for item in result.observations], redundancy, atol=1e-5
    )
    number = {key: i for i, key in enumerate(other.keys)}
    for point in result.points:
        for i, value in enumerate((point.e, point.n, point.h)):
            row = number.get(("point", point.name, i))
            if row is None:
                continue
            assert value == pytest.approx(x[row], abs=tolerance)
            for j in range(3):
                column = number.get(("point", point.name, j))
                if column is not None:
                    scale = np.sqrt(cofactor[row, row] * cofactor[column, column])
                    assert point.covariance[i][j] == pytest.approx(
                        cofactor[row, column], abs=1e-5 * scale
                    )


@pytest.mark.parametrize(("kinds", "datum", "correlated"), CASES, ids=IDS)
def test_both_routes_agree_with_it(
    kinds: tuple[str, ...], datum: str, correlated: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    network, _ = make(len(kinds) * 7 + len(datum), kinds, datum=datum, correlated=correlated)
    compare(network)
    monkeypatch.setattr(gaussnewton, "DENSE_UNKNOWNS", 0)
    monkeypatch.setattr("surveyapp.core.leastsquares.ordering.ROOT_UNKNOWNS", 6)
    compare(network)


def test_both_routes_agree_on_a_larger_network(monkeypatch: pytest.MonkeyPatch) -> None:
    network, _ = make(3, ("direction", "distance", "gyro"), points=40, datum="free")
    sparse = adjust(network)
    assert 3 * len(sparse.points) > 100
    monkeypatch.setattr(gaussnewton, "DENSE_UNKNOWNS", 10_000)
    dense = adjust(network)
    assert dense.defect == sparse.defect == 2  # the known constant orients the network
    for a, b in zip(dense.points, sparse.points, strict=True):
        assert a.e == pytest.approx(b.e, abs=1e-7)
        np.testing.assert_allclose(a.covariance, b.covariance, rtol=1e-6, atol=1e-14)
    for u, v in zip(dense.observations, sparse.observations, strict=True):
        assert u.redundancy == pytest.approx(v.redundancy, abs=1e-8)
        assert u.mdb_effect_m == pytest.approx(v.mdb_effect_m, rel=1e-5)


def loop(count: int, kinds: tuple[str, ...]) -> Network:
    """A long closed traverse, two points fixed, with noise."""
    rng = np.random.default_rng(count)
    turn = 2.0 * math.pi * np.arange(count) / count
    places = np.stack((np.sin(turn), np.cos(turn)), axis=1) * count * 12.0
    names = [f"P{i}" for i in range(count)]

    def azimuth(a: int, b: int) -> float:
        east, north = places[b % count] - places[a % count]
        return math.atan2(east, north)

    observations = []
    for i, name in enumerate(names):
        fore, back = names[(i + 1) % count], names[i - 1]
        if "angle" in kinds:
            value = azimuth(i, i + 1) - azimuth(i, i - 1) + rng.normal(0.0, 7 * ARC)
            observations.append(Observation(K.ANGLE, name, fore, value, 7 * ARC, back=back))
        else:
            for target, j in ((back, i - 1), (fore, i + 1)):
                value = azimuth(i, j) + rng.normal(0.0, 5 * ARC)
                observations.append(Observation(K.DIRECTION, name, target, value, 5 * ARC))
        if i:
            length = float(np.hypot(*(places[(i + 1) % count] - places[i])))
            observations.append(Observation(K.DISTANCE, name, fore, length, 0.002))
        if i % 10 == 0 and "gyro" in kinds:
            value = azimuth(i, i + 1) + rng.normal(0.0, 15 * ARC)
            observations.append(Observation(K.GYRO, name, fore, value, 15 * ARC, constant="G"))
    points = tuple(
        NetworkPoint(n, float(p[0]), float(p[1]), None, *((Status.FIXED,) * 2 if i < 2 else ()))
        for i, (n, p) in enumerate(zip(names, places, strict=True))
    )
    constants = (GyroConstant("G", 0.0, 20 * ARC),) if "gyro" in kinds else ()
    return Network(points, tuple(observations), constants=constants)


@pytest.mark.parametrize("kinds", [("angle",), ("direction",), ("angle", "gyro"), ("gyro",)])
def test_long_loops_agree_on_both_routes(
    kinds: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    network = loop(90, kinds)
    sparse = adjust(network)
    monkeypatch.setattr(gaussnewton, "DENSE_UNKNOWNS", 10_000)
    dense = adjust(network)
    for a, b in zip(dense.points, sparse.points, strict=True):
        assert a.e == pytest.approx(b.e, abs=1e-6)
        np.testing.assert_allclose(a.covariance, b.covariance, rtol=1e-5, atol=1e-12)
    for u, v in zip(dense.observations, sparse.observations, strict=True):
        assert u.redundancy == pytest.approx(v.redundancy, abs=1e-6)
        assert u.sigma_adjusted == pytest.approx(v.sigma_adjusted, rel=1e-5)
        assert u.standardized == pytest.approx(v.standardized, abs=1e-3)
        assert u.mdb_effect_m == pytest.approx(v.mdb_effect_m, rel=1e-3)


@pytest.mark.parametrize("kinds", [("angle", "gyro"), ("gyro",)])
def test_redundancies_of_a_very_long_loop_sum_to_the_degrees_of_freedom(
    kinds: tuple[str, ...],
) -> None:
    result = adjust(loop(3000, kinds), relative=False)
    total = sum(item.redundancy for item in result.observations)
    assert total == pytest.approx(result.dof, rel=1e-6)


def test_a_long_free_loop_settles() -> None:
    network = loop(1500, ("direction",))
    free = tuple(
        replace(p, status_e=Status.CONSTRAINED, status_n=Status.CONSTRAINED) for p in network.points
    )
    result = adjust(replace(network, points=free), relative=False)
    # the leg between the two fixed points was not measured
    assert (result.defect, result.dof) == (3, 2)


def test_every_kind_has_its_linearisation() -> None:
    assert set(LINEARISATION) == set(ObservationKind)


@pytest.mark.parametrize("kind", list(LINEARISATION))
def test_partials_are_the_central_differences(kind: ObservationKind) -> None:
    rng = np.random.default_rng(4)
    width = {"angle": 6, "slope_distance": 6, "zenith": 6, "direction": 5, "gyro": 5}
    width |= {"distance": 4, "azimuth": 4}
    slots = width.get(str(kind), 2 if "vector" in kind or "difference" in kind else 1)
    values = rng.uniform(0.0, 300.0, slots)
    places = np.arange(slots)[None, :]
    constant = np.array([0.2])
    partials = LINEARISATION[kind](values, places, constant).partials[0]
    for i in range(slots):
        step = np.zeros(slots)
        step[i] = 1e-4
        high = LINEARISATION[kind](values + step, places, constant).computed[0]
        low = LINEARISATION[kind](values - step, places, constant).computed[0]
        assert partials[i] == pytest.approx((high - low) / 2e-4, rel=1e-6, abs=1e-9)


@pytest.mark.parametrize(
    "kinds",
    [
        ("distance", "azimuth"),  # distances alone leave two mirror images
        ("direction",),
        ("direction", "distance"),
        ("angle", "distance"),
        ("angle", "azimuth"),
        ("vector", "distance"),
    ],
)
def test_nothing_but_observations_is_needed(kinds: tuple[str, ...]) -> None:
    network, _ = make(21, kinds, points=9)
    result = adjust(network)
    bare = tuple(
        point if point.status_e == "fixed" else replace(point, e=None, n=None)
        for point in network.points
    )
    alone = adjust(replace(network, points=bare))
    for a, b in zip(result.points, alone.points, strict=True):
        assert a.e == pytest.approx(b.e, abs=1e-6)
        assert a.n == pytest.approx(b.n, abs=1e-6)


@pytest.mark.parametrize("seed", range(6))
def test_a_free_trilateration_is_built_from_nothing(seed: int) -> None:
    network, _ = make(seed, ("distance",), points=9, datum="free", reach=200.0)
    bare = tuple(replace(point, e=None, n=None) for point in network.points)
    result, alone = adjust(network), adjust(replace(network, points=bare))
    assert alone.dof == result.dof
    assert alone.global_test.sum_of_squares == pytest.approx(
        result.global_test.sum_of_squares, rel=1e-6
    )


def test_rank_tolerances_leave_room_on_both_sides() -> None:
    assert 1e-12 < solution.RANK_TOLERANCE < 1e-7
