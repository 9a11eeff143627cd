"""Placement of further gyro sides: the printed tables, brute force, and the whole covariance."""

import itertools
import math
import time
from collections.abc import Sequence

import numpy as np
import pytest

from surveyapp.core.penetration.placement import Candidate, outlook
from surveyapp.core.penetration.planning import measures, plan_sides
from surveyapp.core.penetration.search import (
    best_placements,
    enumerated,
    exchanged,
    greedy,
    least_sides,
)
from surveyapp.domain.penetration import DeflectionField, HeadingStart
from surveyapp_models.angles import ARCSEC
from tests.penetration.mines import lateral, straight

# sides, bent, shared: K -> (best, sides, greedy)
Row = tuple[float, tuple[int, ...] | None, float]
PRINTED: dict[tuple[int, bool, float], dict[int, Row]] = {
    (20, False, 8.0): {
        1: (0.1423, (14,), 0.1423),
        2: (0.1199, (9, 16), 0.1210),
        3: (0.1094, (7, 12, 17), 0.1104),
        5: (0.0990, (4, 8, 11, 14, 18), 0.0991),
    },
    (40, False, 0.0): {
        1: (0.2674, (27,), 0.2674),
        2: (0.1970, (17, 32), 0.2065),
        3: (0.1629, (13, 23, 34), 0.1663),
        5: (0.1273, (8, 15, 22, 29, 36), 0.1285),
    },
    (20, True, 0.0): {
        1: (0.0911, (15,), 0.0911),
        2: (0.0690, (11, 17), 0.0702),
        3: (0.0582, (10, 14, 18), 0.0591),
        5: (0.0462, None, 0.0464),
    },
    (40, True, 0.0): {
        1: (0.2031, (30,), 0.2031),
        2: (0.1481, (22, 34), 0.1536),
        3: (0.1232, (18, 27, 35), 0.1251),
        5: (0.0958, (12, 21, 26, 32, 37), 0.0964),
    },
}
CASES = [(*key, k, *row) for key, rows in PRINTED.items() for k, row in rows.items()]


def candidates(sides: Sequence[int], own: float = 15.0) -> list[Candidate]:
    return [Candidate(0, side, "G", own * ARCSEC) for side in sides]


@pytest.mark.parametrize(("sides", "bent", "shared", "k", "best", "chosen", "first"), CASES)
def test_printed_placements(
    sides: int,
    bent: bool,
    shared: float,
    k: int,
    *,
    best: float,
    chosen: tuple[int, ...] | None,
    first: float,
) -> None:
    mine = straight(sides, (0,), shared=shared, bent=bent)
    start = outlook(mine, candidates(range(1, sides)))
    by_greed = greedy(start, k)
    assert start.batch(np.array([by_greed]))[0] == pytest.approx(first, abs=0.5e-4 + 1e-6)
    found = exchanged(start, by_greed)
    assert found.lateral[0] == pytest.approx(best, abs=0.5e-4 + 1e-6)
    if chosen is not None:
        assert tuple(i + 1 for i in found.sets[0]) == chosen


@pytest.mark.parametrize("sides", [20, 40])
@pytest.mark.parametrize("bent", [False, True])
@pytest.mark.parametrize("shared", [0.0, 8.0])
@pytest.mark.parametrize("k", [1, 2, 3])
def test_exchange_reaches_brute_force(sides: int, bent: bool, shared: float, k: int) -> None:
    start = outlook(straight(sides, (0,), shared=shared, bent=bent), candidates(range(1, sides)))
    every = enumerated(start, k)
    found = exchanged(start, greedy(start, k))
    assert every.exact
    assert found.lateral[0] == pytest.approx(every.lateral[0], rel=1e-12)
    assert list(every.lateral) == sorted(every.lateral)


@pytest.mark.parametrize(("bent", "shared"), [(False, 8.0), (True, 0.0)])
def test_five_of_twenty_by_brute_force(bent: bool, shared: float) -> None:
    start = outlook(straight(20, (0,), shared=shared, bent=bent), candidates(range(1, 20)))
    every = enumerated(start, 5)
    assert exchanged(start, greedy(start, 5)).lateral[0] == pytest.approx(every.lateral[0])


@pytest.mark.parametrize("bent", [False, True])
@pytest.mark.parametrize("shared", [0.0, 8.0])
def test_five_of_forty_by_brute_force(bent: bool, shared: float) -> None:
    """All 575,757 placements of 5 among the 39 sides that side 0 leaves."""
    start = outlook(straight(40, (0,), shared=shared, bent=bent), candidates(range(1, 40)))
    every = enumerated(start, 5)
    found = exchanged(start, greedy(start, 5))
    assert found.lateral[0] == pytest.approx(every.lateral[0], rel=1e-12)
    assert found.sets[0] == every.sets[0]


@pytest.mark.parametrize("surveys", [1, 2])
@pytest.mark.parametrize("gradient", [0.0, 0.1])
@pytest.mark.parametrize("field", [None, DeflectionField(5 * ARCSEC, 3e3, math.pi / 4, "P0")])
def test_a_placement_is_judged_by_the_whole_covariance(
    surveys: int, gradient: float, field: DeflectionField | None
) -> None:
    """Rank-one updates against the whole equations, with every shared cause in the mine."""
    common = {"shared": 8.0, "surveys": surveys, "gradient": gradient, "deflection": field}
    start = HeadingStart(20.0 * ARCSEC)
    free = [side for side in range(20) if side not in (0, 7)]
    mine = straight(20, (0, 7), start=start, **common)  # type: ignore[arg-type]
    view = outlook(mine, candidates(free))
    assert view.lateral == pytest.approx(lateral(mine), rel=1e-12)
    generator = np.random.default_rng(3)
    for _ in range(5):
        chosen = np.sort(generator.choice(len(free), 3, replace=False))
        sides = (0, 7, *(free[i] for i in chosen))
        whole = lateral(straight(20, sides, start=start, **common))  # type: ignore[arg-type]
        assert view.batch(chosen[None, :])[0] == pytest.approx(whole, rel=1e-10)
        step = view
        for i in chosen:
            step = step.with_row(int(i))
        assert step.lateral == pytest.approx(whole, rel=1e-10)
        back = step.with_row(int(chosen[0]), removed=True)
        pair = lateral(straight(20, (0, 7, *(free[i] for i in chosen[1:])), start=start, **common))  # type: ignore[arg-type]
        assert back.lateral == pytest.approx(pair, rel=1e-9)


@pytest.mark.parametrize(
    ("tolerance", "sides"), [(0.60, 2), (0.50, 3), (0.45, 3), (0.40, 6), (0.35, 13), (0.30, None)]
)
def test_least_programme(tolerance: float, sides: int | None) -> None:
    mine = straight(40, (0,), shared=8.0)
    start = outlook(mine, candidates(range(1, 40)))
    found = least_sides(start, tolerance / 2.0)
    assert (None if found is None else len(found[0])) == sides
    plan = plan_sides(mine, candidates(range(1, 40)), 1, tolerance, factor=2.0)
    if sides is None:
        assert plan.least is None
        assert "0.310 m" in plan.why
        assert "second instrument" in plan.why
    else:
        assert plan.least is not None
        assert plan.least.lateral_m * 2.0 <= tolerance
        assert plan.why == ""


def test_measures_beside_further_sides() -> None:
    """From sides 0 and 20 of 40, B: .3302 falls to the printed values."""
    mine = straight(40, (0, 20), shared=8.0)
    found = {item.kind: item for item in measures(mine)}
    assert lateral(mine) == pytest.approx(0.3302, abs=0.5e-4)
    assert found["angles"].lateral_m == pytest.approx(0.2997, abs=0.5e-4)
    assert found["gyro"].lateral_m == pytest.approx(0.2872, abs=0.5e-4)
    assert found["second_survey"].lateral_m == pytest.approx(0.2580, abs=0.5e-4)
    assert set(found) == {
        "angles",
        "gyro",
        "reciprocal",
        "second_instrument",
        "second_survey",
        "calibration_rounds",
    }
    assert (found["reciprocal"].sides_observed, found["second_instrument"].sides_observed) == (2, 2)
    start = outlook(mine, candidates([s for s in range(40) if s not in (0, 20)]))
    for k, value, sides in ((1, 0.2523, (33,)), (2, 0.2267, (12, 33))):
        best = best_placements(start, k)
        free = [s for s in range(40) if s not in (0, 20)]
        assert best.lateral[0] == pytest.approx(value, abs=0.5e-4)
        assert tuple(free[i] for i in best.sets[0]) == sides


def test_two_gyros_of_two_headings_share_nothing_and_one_gyro_adds() -> None:
    """m_c times the lever of each heading: together with one gyro, in squares with two."""
    from surveyapp.core.penetration.covariance import contributions
    from surveyapp.core.penetration.mine import build_mine
    from surveyapp.domain.penetration import (
        AssumedSigmas,
        ExcavationCase,
        GyroSide,
        Heading,
        MeetingPoint,
        Penetration,
        TunnelCase,
    )
    from surveyapp.domain.project import Station

    north = {f"A{i}": Station(f"A{i}", 0.0, 100.0 * i, fixed=i == 0) for i in range(11)}
    south = {f"B{i}": Station(f"B{i}", 0.0, 3000.0 - 100.0 * i, fixed=i == 0) for i in range(21)}
    gyros = (("G", "G"), ("G", "H"))
    found = []
    for first, second in gyros:
        plan = Penetration(
            case=ExcavationCase.OPPOSITE,
            tunnel=TunnelCase.WITHIN_MINE,
            meeting=MeetingPoint(0.0, 1000.0),
            axis_azimuth=0.0,
            headings=(Heading("a", tuple(north)), Heading("b", tuple(south))),
            gyro=(
                GyroSide("A0", "A1", first, 15 * ARCSEC),
                GyroSide("B0", "B1", second, 15 * ARCSEC),
            ),
            sigmas=AssumedSigmas(angle=7 * ARCSEC),
        )
        mine = build_mine(plan, north | south, {"G": 8 * ARCSEC, "H": 8 * ARCSEC})
        parts = [p for p in contributions(mine) if p.source == "gyro_constant"]
        found.append(math.sqrt(sum(p.sigmas[0] ** 2 for p in parts)))
    assert found[0] == pytest.approx(8 * ARCSEC * 3000.0, rel=1e-9)
    assert found[1] == pytest.approx(8 * ARCSEC * math.hypot(1000.0, 2000.0), rel=1e-9)


def test_a_plan_of_a_thousand_sides_is_quick() -> None:
    mine = straight(40, (0,), shared=8.0)
    began = time.process_time()
    best_placements(outlook(mine, candidates(range(1, 40))), 5)
    assert time.process_time() - began < 0.2
    mine = straight(1000, (0,), shared=8.0)
    began = time.process_time()
    found = best_placements(outlook(mine, candidates(range(1, 1000))), 5)
    assert time.process_time() - began < 5.0
    assert len(found.sets[0]) == 5


def test_enumeration_looks_at_every_placement() -> None:
    start = outlook(straight(20, (0,), shared=8.0), candidates(range(1, 20)))
    every = np.array(list(itertools.combinations(range(19), 3)))
    values = start.batch(every)
    assert enumerated(start, 3).lateral[0] == float(values.min())
