"""Breakthroughs: speed, workers, 10,000 simulated misses, and what undeclared effects do.

The campaign takes 400 mines of random shape (two headings, 10 to 30 sides each, gyro sides, walls,
centring, deflections) and 25 surveys of each: how many of the 10,000 misses lie inside the 95 %
bound that was predicted, on clean data and with something in the mine that nobody declared.
"""

from __future__ import annotations

import math
import resource
import time
from collections.abc import Iterator
from concurrent.futures import Executor, ProcessPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np

from surveyapp import api
from surveyapp.core.penetration.covariance import contributions, total
from surveyapp.core.penetration.evaluation import closure_test, covariance3
from surveyapp.core.penetration.mine import Mine, build_mine
from surveyapp.core.penetration.placement import Candidate, outlook
from surveyapp.core.penetration.search import best_placements, enumerated, exchanged, greedy
from surveyapp.core.penetration.simulation import Task, Undeclared, simulate_all
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
    Wall,
    WallRefraction,
)
from surveyapp.domain.project import Station
from surveyapp.workflows.predicting import ready_mine
from surveyapp.workflows.simulating import simulated_misses
from surveyapp_models.angles import ARCSEC

MINES, SURVEYS = 400, 25
SAMPLE = Path(__file__).parents[1] / "projects" / "synthetic-breakthrough"


def random_mine(seed: int) -> Mine:
    """Two headings that meet in the origin, driving north, with everything declared."""
    rng = np.random.default_rng([20261128, seed])
    stations: dict[str, Station] = {}
    headings, gyro = [], []
    walled = bool(rng.random() < 0.5)
    for name, sign in (("A", 1.0), ("B", -1.0)):
        count = int(rng.integers(10, 31))
        e, n, route = 0.0, 0.0, [f"{name}{count}"]
        stations[route[0]] = Station(route[0], e, n)
        bend = float(rng.normal(0.0, 0.4))
        for i in range(count - 1, -1, -1):
            azimuth = bend * (1.0 - i / count) + float(rng.normal(0.0, 0.05))
            length = float(rng.uniform(60.0, 140.0))
            e, n = e - sign * length * math.sin(azimuth), n - sign * length * math.cos(azimuth)
            route.insert(0, f"{name}{i}")
            stations[route[0]] = Station(route[0], e, n, fixed=i == 0)
        side: Wall = "right" if (rng.random() < 0.5) == (sign > 0) else "left"
        wall: tuple[Wall, ...] = (side,) * (count + 1) if walled else ()
        start = HeadingStart(float(rng.uniform(5, 25)) * ARCSEC, 0.01)
        headings.append(Heading(name, tuple(route), wall=wall, start=start))
        chosen = rng.choice(count, int(rng.integers(1, 4)), replace=False)
        gyro += [GyroSide(f"{name}{k}", f"{name}{k + 1}", "G", 15 * ARCSEC) for k in chosen]
    plan = Penetration(
        case=ExcavationCase.OPPOSITE,
        tunnel=TunnelCase.WITHIN_MINE,
        meeting=MeetingPoint(0.0, 0.0),
        axis_azimuth=0.0,
        headings=tuple(headings),
        gyro=tuple(gyro),
        sigmas=AssumedSigmas(7 * ARCSEC, 2.0, 2.0, 3.0, 0.0008, 0.0008),
        height=HeightMethod("levelling", 0.015),
        refraction=WallRefraction(0.05) if walled else None,
        deflection=DeflectionField(4 * ARCSEC, 3000.0, math.radians(45.0), "A0"),
    )
    return build_mine(plan, stations, {"G": 8 * ARCSEC})


def straight(sides: int, gyro: range, *, bent: bool = False, shared: float = 8.0) -> Mine:
    """A drive of 100 m sides, straight or turned by 60 degrees in the middle."""
    azimuth = np.zeros(sides)
    azimuth[sides // 2 :] = math.radians(60.0) if bent else 0.0
    e = np.concatenate([[0.0], np.cumsum(100.0 * np.sin(azimuth))]).tolist()
    n = np.concatenate([[0.0], np.cumsum(100.0 * np.cos(azimuth))]).tolist()
    stations = {f"P{i}": Station(f"P{i}", e[i], n[i], fixed=i == 0) for i in range(sides + 1)}
    plan = Penetration(
        case=ExcavationCase.ONE_END,
        tunnel=TunnelCase.WITHIN_MINE,
        meeting=MeetingPoint(e[-1], n[-1]),
        axis_azimuth=float(azimuth[-1]),
        headings=(Heading("A", tuple(stations)),),
        gyro=tuple(GyroSide(f"P{i}", f"P{i + 1}", "G", 15 * ARCSEC) for i in gyro),
        sigmas=AssumedSigmas(7 * ARCSEC),
    )
    return build_mine(plan, stations, {"G": shared * ARCSEC})


def speed(executor: Executor | None) -> Iterator[str]:
    """Covariance, plan, simulation; one worker against two."""
    began = time.perf_counter()
    contributions(straight(1000, range(0, 1000, 50)))
    yield f"covariance, 1000 sides, 20 gyro sides: {time.perf_counter() - began:.3f} s"
    for sides in (40, 200, 1000):
        mine = straight(sides, range(1))
        free = [Candidate(0, i, "G", 15 * ARCSEC) for i in range(1, sides)]
        began = time.perf_counter()
        best_placements(outlook(mine, free), 5)
        yield f"plan of 5 among {sides} sides: {time.perf_counter() - began:.3f} s"
    yield from every_placement()
    computed = api.compute(SAMPLE)
    mine = ready_mine(computed.orientation.project, computed.result).mine
    began = time.perf_counter()
    simulate_all(Task(mine, 1, 10_000))
    yield f"10,000 surveys of the sample, one process: {time.perf_counter() - began:.2f} s"
    yield from workers(Task(mine, 1, 800_000), "surveys of the sample", executor)
    large = straight(400, range(0, 400, 20))
    yield from workers(Task(large, 1, 50_000), "surveys of a mine of 400 sides", executor)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    yield f"peak memory {peak:.0f} MB"


def every_placement() -> Iterator[str]:
    """Exchange against all placements of 5 among 40 free sides, straight and bent, A and B."""
    for bent in (False, True):
        for shared in (0.0, 8.0):
            mine = straight(41, range(1), bent=bent, shared=shared)
            free = [Candidate(0, i, "G", 15 * ARCSEC) for i in range(1, 41)]
            start = outlook(mine, free)
            began = time.perf_counter()
            every = enumerated(start, 5)
            spent = time.perf_counter() - began
            same = exchanged(start, greedy(start, 5)).sets[0] == every.sets[0]
            yield (
                f"{math.comb(40, 5)} placements, {'bent' if bent else 'straight'}, constant "
                f'{shared:g}" shared: {spent:.2f} s, best {every.lateral[0]:.4f} m, '
                f"exchange finds the same: {same}"
            )


def workers(task: Task, name: str, executor: Executor | None) -> Iterator[str]:
    """The same work with one worker and with two, processes warm."""
    spent, found = [], []
    for count in (1, 2):
        with ProcessPoolExecutor(count) as pool:
            list(pool.map(math.sqrt, range(8 * count)))
            simulated_misses(replace(task, runs=task.runs // 10), pool)
            began = time.perf_counter()
            found.append(np.concatenate(simulated_misses(task, pool)))
            spent.append(time.perf_counter() - began)
    same = np.array_equal(found[0], found[1])
    yield (
        f"{task.runs} {name}: one worker {spent[0]:.1f} s, two {spent[1]:.1f} s "
        f"({spent[0] / spent[1]:.2f} times faster), the same numbers: {same}"
    )
    if executor is not None:
        began = time.perf_counter()
        misses = np.concatenate(simulated_misses(task, executor))
        same = np.array_equal(found[0], misses)
        yield f"on the cluster {time.perf_counter() - began:.1f} s, the same numbers: {same}"


def campaign() -> Iterator[str]:
    """Share of misses inside the predicted 95 % bound, and how many are called inconsistent."""
    cases = (
        ("clean", Undeclared()),
        ('shift of 60" after the first side of one heading', Undeclared(shift=60 * ARCSEC)),
        ("gradient of 0.3 K/m along the walls", Undeclared(gradient=0.3)),
        ("scale of 50 ppm", Undeclared(scale_ppm=50.0)),
    )
    for name, undeclared in cases:
        inside, consistent, count = 0, 0, 0
        for seed in range(MINES):
            mine = random_mine(seed)
            if undeclared.gradient and mine.plan.refraction is None:
                continue
            covariance = covariance3(mine)
            bound = 1.96 * math.sqrt(float(total(contributions(mine))[0][0, 0]))
            misses = simulate_all(Task(mine, seed, SURVEYS, undeclared))
            inside += int(np.sum(np.abs(misses[:, 0]) <= bound))
            consistent += sum(
                closure_test(tuple(miss), covariance, heights=True).consistent
                for miss in misses.tolist()
            )
            count += len(misses)
        share = inside / count
        error = math.sqrt(0.95 * 0.05 / count)
        yield (
            f"{name}: {count} misses, inside the 95 % bound {share:.4f} (s.e. {error:.4f}); "
            f"called consistent {consistent / count:.4f}"
        )


def run(executor: Executor | None = None) -> Iterator[str]:
    """Speed, then the campaign."""
    yield from speed(executor)
    yield from campaign()
