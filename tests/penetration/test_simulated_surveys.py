"""Simulated surveys against the covariance, and against an adjustment of the same readings."""

import math
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from functools import partial
from typing import Any

import numpy as np
import pytest

from surveyapp.core.network import adjust
from surveyapp.core.penetration.covariance import contributions, total
from surveyapp.core.penetration.mine import Mine, build_mine
from surveyapp.core.penetration.simulation import (
    BLOCK,
    Task,
    Undeclared,
    adjuster,
    simulate_all,
    simulate_block,
    summary,
)
from surveyapp.domain.observations import Observation, ObservationKind
from surveyapp.domain.penetration import (
    AssumedSigmas,
    DeflectionField,
    ExcavationCase,
    GyroSide,
    Heading,
    HeadingStart,
    HeightMethod,
    MeetingPoint,
    Penetration,
    TunnelCase,
    WallRefraction,
)
from surveyapp.domain.project import Station
from surveyapp.domain.traverse import GyroConstant, Network, NetworkPoint, Status
from surveyapp.workflows.spreading import spread
from surveyapp_models.angles import ARCSEC, wrap_two_pi
from tests.penetration.mines import straight


def whole_mine(*, surveys: int = 1, bent: bool = False) -> Mine:
    """Two headings with everything that can be declared."""
    turn = math.radians(30.0) if bent else 0.0
    stations, routes = {}, []
    for name, count, start, sign in (("A", 12, 0.0, 1.0), ("B", 8, 2000.0, -1.0)):
        e, n = 0.0, start
        route = []
        for i in range(count + 1):
            stations[f"{name}{i}"] = Station(f"{name}{i}", e, n, fixed=i == 0)
            route.append(f"{name}{i}")
            azimuth = turn if i < count // 2 else 0.0
            e += sign * 100.0 * math.sin(azimuth)
            n += sign * 100.0 * math.cos(azimuth)
        routes.append(tuple(route))
    shift = stations["A12"].e, stations["A12"].n
    at_b = stations["B8"].e, stations["B8"].n
    for name in routes[1]:
        old = stations[name]
        stations[name] = Station(
            name,
            (old.e or 0.0) + (shift[0] or 0.0) - (at_b[0] or 0.0),
            (old.n or 0.0) + (shift[1] or 0.0) - (at_b[1] or 0.0),
            fixed=old.fixed,
        )
    plan = Penetration(
        case=ExcavationCase.OPPOSITE,
        tunnel=TunnelCase.WITHIN_MINE,
        meeting=MeetingPoint(shift[0] or 0.0, shift[1] or 0.0),
        axis_azimuth=0.0,
        headings=(
            Heading(
                "a",
                routes[0],
                wall=("right",) * 13,
                start=HeadingStart(20 * ARCSEC, 0.01, "surface"),
                height_transfer_m=400.0,
                shaft="one",
            ),
            Heading(
                "b",
                routes[1],
                wall=("left",) * 9,
                start=HeadingStart(12 * ARCSEC, 0.02, "surface"),
                height_transfer_m=300.0,
            ),
        ),
        gyro=(
            GyroSide("A5", "A6", "G", 15 * ARCSEC, reciprocal=True),
            GyroSide("A10", "A11", "H", 10 * ARCSEC),
            GyroSide("B4", "B5", "G", 15 * ARCSEC),
        ),
        sigmas=AssumedSigmas(7 * ARCSEC, 3.0, 2.0, 10.0, 0.001, 0.0015),
        independent_surveys=surveys,
        height=HeightMethod("trig", 0.0, 10 * ARCSEC, 0.001, 0.001),
        refraction=WallRefraction(0.05, shared="heading"),
        deflection=DeflectionField(5 * ARCSEC, 2000.0, math.radians(45.0), "A0"),
    )
    return build_mine(plan, stations, {"G": 8 * ARCSEC, "H": 6 * ARCSEC})


@pytest.mark.statistical
@pytest.mark.parametrize("surveys", [1, 2])
@pytest.mark.parametrize("bent", [False, True])
def test_simulated_readings_confirm_the_covariance(surveys: int, bent: bool) -> None:
    """6000 runs: the standard error of a sigma is 0.9 %; 4 of them."""
    mine = whole_mine(surveys=surveys, bent=bent)
    plane, vertical = total(contributions(mine))
    misses = simulate_all(Task(mine, 5, 6000))
    expected = np.sqrt([plane[0, 0], plane[1, 1], vertical])
    found = np.sqrt(np.mean(misses**2, axis=0))
    assert found == pytest.approx(expected, rel=4.0 / math.sqrt(2.0 * 6000))
    correlation = plane[0, 1] / math.sqrt(plane[0, 0] * plane[1, 1])
    assert np.corrcoef(misses[:, 0], misses[:, 1])[0, 1] == pytest.approx(correlation, abs=0.05)


@pytest.mark.statistical
@pytest.mark.parametrize(("gyro", "printed"), [((0,), 0.3045), ((0, 10, 19), 0.1226)])
def test_simulated_drive_along_a_wall(gyro: tuple[int, ...], printed: float) -> None:
    mine = straight(20, gyro, shared=8.0, gradient=0.1)
    found = summary([simulate_all(Task(mine, 2, 8000))], Task(mine, 2, 8000))
    assert found.sigma.lateral_m == pytest.approx(printed, rel=4.0 / math.sqrt(16000.0))


def test_a_survey_is_adjusted_as_adjust_does() -> None:
    """The same readings through the network adjustment of ``adjust``: the same azimuths."""
    mine = straight(8, (0, 4, 7), shared=8.0)
    generator = np.random.default_rng(11)
    errors = generator.normal(0.0, mine.arrays.reading)
    turned = adjuster(mine) @ errors
    observations = []
    for row, error in zip(mine.headings[0].rows, errors.tolist(), strict=True):
        side = row.side
        if row.instrument:
            kind, value = ObservationKind.GYRO, wrap_two_pi(error)
            observations.append(
                Observation(kind, f"P{side}", f"P{side + 1}", value, row.reading, constant="G")
            )
        else:
            value = wrap_two_pi(math.pi + error)
            observations.append(
                Observation(
                    ObservationKind.ANGLE,
                    f"P{side}",
                    f"P{side + 1}",
                    value,
                    row.reading,
                    back=f"P{side - 1}",
                )
            )
    observations += [
        Observation(ObservationKind.DISTANCE, f"P{i}", f"P{i + 1}", 100.0, 0.001) for i in range(8)
    ]
    points = tuple(
        NetworkPoint(
            f"P{i}",
            0.0,
            100.0 * i,
            None,
            *((Status.FIXED, Status.FIXED) if i == 0 else (Status.FREE, Status.FREE)),
        )
        for i in range(9)
    )
    network = Network(points, tuple(observations), constants=(GyroConstant("G", 0.0, 8 * ARCSEC),))
    adjusted = {point.name: (point.e, point.n) for point in adjust(network).points}
    for i in range(8):
        (e0, n0), (e1, n1) = adjusted[f"P{i}"], adjusted[f"P{i + 1}"]
        azimuth = math.atan2((e1 or 0.0) - (e0 or 0.0), (n1 or 0.0) - (n0 or 0.0))
        assert azimuth == pytest.approx(float(turned[i]), abs=1e-3 * ARCSEC)


class LosesEveryOther(Executor):
    """Computes here, and loses every other block with its worker."""

    def __init__(self, for_ever: bool = False) -> None:
        self.given = 0
        self.for_ever = for_ever

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        self.given += 1
        future: Future[Any] = Future()
        if self.for_ever or self.given % 2:
            future.set_exception(BrokenProcessPool("a worker was killed"))
        else:
            future.set_result(fn(*args, **kwargs))
        return future


def test_results_depend_on_nobody_who_computes() -> None:
    mine = straight(20, (0, 10), shared=8.0)
    task = Task(mine, 9, 4 * BLOCK + 100)
    assert task.blocks == 5
    alone = np.concatenate(list(spread(partial(simulate_block, task), range(5), None)))
    assert len(alone) == task.runs
    with ThreadPoolExecutor(3) as executor:
        many = np.concatenate(list(spread(partial(simulate_block, task), range(5), executor)))
    assert np.array_equal(alone, many)
    for losing in (LosesEveryOther(), LosesEveryOther(for_ever=True)):
        lost = np.concatenate(list(spread(partial(simulate_block, task), range(5), losing)))
        assert np.array_equal(alone, lost)


def test_a_fault_of_a_block_is_no_lost_worker() -> None:
    def wrong(_: int) -> int:
        raise ZeroDivisionError

    with ThreadPoolExecutor(1) as executor, pytest.raises(ZeroDivisionError):
        list(spread(wrong, [1], executor))


@pytest.mark.statistical
def test_undeclared_effects_break_the_bound_as_printed() -> None:
    """A shift of 60" after the first side is missed by the bound; a scale is not seen laterally."""
    mine = straight(20, (0, 10, 19), shared=8.0)
    bound = 1.96 * math.sqrt(float(total(contributions(mine))[0][0, 0]))

    def inside(undeclared: Undeclared) -> float:
        misses = simulate_all(Task(mine, 4, 4000, undeclared))
        return float(np.mean(np.abs(misses[:, 0]) <= bound))

    error = 4.0 * math.sqrt(0.95 * 0.05 / 4000)
    assert inside(Undeclared()) == pytest.approx(0.95, abs=error)
    assert inside(Undeclared(scale_ppm=50.0)) == pytest.approx(0.95, abs=error)
    assert inside(Undeclared(shift=60 * ARCSEC)) < 0.9
