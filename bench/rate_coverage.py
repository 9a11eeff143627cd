"""Rate sensors: coverage of every stated 95 % interval, programme by programme.

Six positions with the static and rate method beside it, the unit over temperature with and without
the room-temperature log (nodes, reference temperature and what is predicted between nodes),
fog-station and hand-held stops: ``SURVEYAPP_BENCH_RUNS`` records each (200), and as many of the
bias of a hand-held unit whose bias wanders. The heading by indexing over five latitudes, three
attitudes and two programmes, ten runs for each record (2000), and fifty for the wrong root
(10,000). A share of 200 lies in .92 to .98 at 95 % with p = .94; one of 2000 in .94 to .96 with
p = .96. ``SURVEYAPP_BENCH_STORE`` names a folder in which finished parts are kept.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from bench._stored import stored
from bench.rate import SIGMA, as_read
from surveyapp.core.sensors.rate.fog_station_log import calibrate_fog_station
from surveyapp.core.sensors.rate.indexing import solve_indexing
from surveyapp.core.sensors.rate.indexing_values import Setting, Stop
from surveyapp.core.sensors.rate.multi_position_log import (
    MultiPositionOptions,
    calibrate_multi_position,
)
from surveyapp.core.sensors.rate.position_log import resting_rows
from surveyapp.core.sensors.rate.six_position_log import SixPositionOptions, calibrate_six_positions
from surveyapp.core.sensors.rate.temperature_log import calibrate_temperature
from surveyapp.core.sensors.rate.temperature_nodes import TemperatureOptions
from surveyapp.core.simulate.rate.disturbed import NODES_C
from surveyapp.core.simulate.rate.recipes import example_unit, hand_run
from surveyapp.core.simulate.rate.table_programmes import (
    DEG_H,
    FogStationRun,
    ImuOnTable,
    TableRun,
    accelerometer_truth,
    fog_station_log,
    gyro_truth,
    six_position_log,
    temperature_log,
)
from surveyapp.core.simulate.rate.vehicle import hand_held_log
from surveyapp.domain.calibration import SensorParameter
from surveyapp_models.angles import ARCSEC, wrap_pi
from surveyapp_models.arrays import Floats
from surveyapp_models.rate.attitude import attitude_matrix, axis_rotation, earth_rate
from surveyapp_models.rate.fog_station import FogOnTelescope
from surveyapp_models.rate.triad import Triad
from surveyapp_models.rate.turntable import Table

RUNS = int(os.environ.get("SURVEYAPP_BENCH_RUNS", "200"))
PART = 50
"""Records of a stored part."""
HEADINGS = 500
"""Headings of a stored part."""
WRONG_SIGMAS = 6.0
"""A heading this far off by its own sigma is another root."""
BETWEEN_C = (12.0, 35.0)
"""Temperatures between the nodes at which is predicted."""


@dataclass(frozen=True, slots=True)
class Interval:
    """A stated value with its truth; the sigma makes 1.96 of it the 95 % interval."""

    name: str
    value: float
    sigma: float
    truth: float

    @property
    def holds(self) -> bool:
        """Whether the truth lies in it."""
        return abs(self.value - self.truth) <= 1.96 * self.sigma


Programme = Callable[[np.random.Generator], Iterable[Interval]]


def intervals(
    parameters: Iterable[SensorParameter | Mapping[str, Any]],
    truth: Mapping[str, object],
    *,
    of: str = "",
) -> Iterator[Interval]:
    """Intervals of the parameters that have a value, a sigma and a known truth."""
    for item in parameters:
        cell = item.to_dict() if isinstance(item, SensorParameter) else item
        known = truth.get(cell["name"])
        if cell["value"] is not None and cell["sigma"] is not None and known is not None:
            name = f"{cell['name']}{of}"
            yield Interval(name, cell["value"], cell["sigma"], float(str(known)))


def six_position(rng: np.random.Generator) -> Iterator[Interval]:
    """Twelve parameters from two whole turns each way, and the static and rate method."""
    unit = example_unit({}, TableRun(turns=2.0, interval_s=0.25, pause_s=1.0))
    table = replace(unit.table, azimuth=rng.uniform(0.0, 2.0 * math.pi))
    unit = replace(unit, table=table, warm_up_s=10.0, static_s=15.0, flip_sigma=30.0 * ARCSEC)
    unit = replace(unit, run=replace(unit.run, rate_error=1e-5))
    log = six_position_log(unit, rng)
    options = SixPositionOptions(30.0 * ARCSEC, 1e-5, table.latitude)
    found = calibrate_six_positions(as_read(log), options)
    yield from intervals(found.parameters, log.truth)
    yield from intervals(found.extra["traditional"]["parameters"], log.truth, of=", static")


def _chamber_unit(rng: np.random.Generator) -> ImuOnTable:
    """A unit whose accelerometers are mounted to 200 arcsec."""
    unit = example_unit({}, TableRun(turns=2.0, interval_s=0.25, pause_s=1.0))
    tilts = rng.normal(0.0, 200.0 * ARCSEC, (3, 3)) * (1.0 - np.eye(3))
    table = Table(unit.table.latitude, azimuth=rng.uniform(0.0, 2.0 * math.pi))
    force = replace(unit.accelerometer, misalignment=tilts)
    return replace(unit, accelerometer=force, table=table, warm_up_s=10.0, static_s=5.0)


def _over_temperature(
    unit: ImuOnTable, rng: np.random.Generator
) -> Callable[[float], tuple[Triad, Triad]]:
    """Biases on cubics of the temperature, drawn anew."""
    gyro = rng.normal(0.0, 1.0, (3, 3)) * np.array([[3.0], [1.2], [0.6]]) * DEG_H
    force = rng.normal(0.0, 0.01, 3)

    def at(node: float) -> tuple[Triad, Triad]:
        t = (node - 20.0) / 30.0
        bias = unit.gyro.bias + t * gyro[0] + t**2 * gyro[1] + t**3 * gyro[2]
        return replace(unit.gyro, bias=bias), replace(
            unit.accelerometer, bias=unit.accelerometer.bias + force * t
        )

    return at


def temperature(rng: np.random.Generator, *, room: bool = True) -> Iterator[Interval]:
    """Five nodes of three positions; accelerometers' misalignments from room temperature."""
    unit = _chamber_unit(rng)
    at = _over_temperature(unit, rng)
    log = temperature_log(unit, rng, nodes_c=NODES_C, at=at)
    rests = resting_rows(as_read(six_position_log(unit, rng))) if room else None
    options = TemperatureOptions(unit.table.latitude, BETWEEN_C, room=rests)
    found = calibrate_temperature(as_read(log), options)
    nodes = log.truth["nodes"]
    assert isinstance(nodes, dict)
    for node in found.extra["nodes"]:
        key = f"{node['temperature_c']:g}"
        yield from intervals(node["parameters"], nodes[key], of=", node")
    yield from intervals(found.parameters, nodes["20"], of=", 20 C")
    for point in found.extra["predicted"]:
        gyro, force = at(point["temperature_c"])
        truth = gyro_truth(gyro) | accelerometer_truth(force)
        yield from intervals(point["parameters"], truth, of=", between")


def temperature_alone(rng: np.random.Generator) -> Iterator[Interval]:
    """The same without a log at room temperature: the accelerometers' bias and scale factor."""
    found = temperature(rng, room=False)
    return (one for one in found if one.name.startswith("accelerometer"))


def fog_station(rng: np.random.Generator) -> Iterator[Interval]:
    """Two passes of ten sets; the table's rate is off by 4.2e-5 each way, and stated so."""
    fog = FogOnTelescope(
        constant=math.radians(171.13), scale=2e-5, bias=1.0 * DEG_H, noise=1.6 * DEG_H
    )
    run = TableRun(
        rate=math.radians(60.0), turns=2.0, interval_s=0.04, pause_s=0.5, rate_error=4.2e-5
    )
    reading = fog.constant - math.radians(6.6)
    spec = FogStationRun(fog, Table(math.radians(34.0)), run, reading, sets=10, passes=2)
    log = as_read(fog_station_log(spec, rng))
    found = calibrate_fog_station(log, rule="increases", relative_rate_sigma=4.2e-5, problems=[])
    truth = {"instrument_constant": math.degrees(fog.constant), "scale_factor": fog.scale * 1e6}
    return intervals(found.parameters, truth | {"elevation": math.radians(6.6) / ARCSEC})


def multi_position(rng: np.random.Generator) -> Iterator[Interval]:
    """Eighteen stops by hand."""
    run = replace(hand_run({"stops": 18.0}, rng), interval_s=0.04, warmth=0.0)
    log = hand_held_log(run, rng)
    found = calibrate_multi_position(as_read(log), MultiPositionOptions(run.latitude))
    return intervals(found.parameters, log.truth)


PROGRAMMES: Mapping[str, Programme] = {
    "six-position": six_position,
    "temperature": temperature,
    "temperature without room log": temperature_alone,
    "fog-station": fog_station,
    "multi-position": multi_position,
}


def held_of(programme: Programme, first: int, last: int, *, seed: int = 0) -> dict[str, list[bool]]:
    """Whether each interval of the records first to last (exclusive) holds, by parameter."""
    inside: dict[str, list[bool]] = {}
    for run in range(first, last):
        for one in programme(np.random.default_rng([seed, run])):
            inside.setdefault(one.name, []).append(bool(one.holds))
    return inside


def coverage_of(programme: Programme, runs: int, *, seed: int = 0) -> dict[str, tuple[float, int]]:
    """Share of 95 % intervals that hold the truth, and how many there were, by parameter."""
    inside = held_of(programme, 0, runs, seed=seed)
    return {name: (float(np.mean(held)), len(held)) for name, held in inside.items()}


def headings(runs: int, *, seed: int = 1, first: int = 0) -> tuple[int, int, int]:
    """Resolved headings whose interval holds, wrong roots among them, and how many were told."""
    inside = wrong = told = 0
    for k in range(first, first + runs):
        rng = np.random.default_rng([seed, k])
        phi = math.radians((0, 20, 40, 60, -45)[k % 5])
        pitch, roll = ((0, 0), (12, -5), (25, 10))[(k // 5) % 3]
        index = ((0, 90, 180, 270), (0, 180))[(k // 15) % 2]
        heading = rng.uniform(0.0, 2.0 * math.pi)
        body = attitude_matrix(heading=heading, pitch=math.radians(pitch), roll=math.radians(roll))
        bias = rng.normal(0.0, 10.0, 3) * DEG_H
        stops = [_stop(body, phi, bias, math.radians(angle), rng=rng) for angle in index]
        found = solve_indexing(stops, Setting(phi))
        if found.verdict != "resolved":
            told += 1
            continue
        off = abs(wrap_pi(found.roots[0].heading - heading)) / found.roots[0].heading_sigma()
        inside, wrong = inside + int(off <= 1.96), wrong + int(off > WRONG_SIGMAS)
    return inside, wrong, told


def _stop(
    body: Floats, latitude: float, bias: Floats, angle: float, *, rng: np.random.Generator
) -> Stop:
    sensor = body @ axis_rotation(2, -angle)
    rate = sensor.T @ earth_rate(latitude) + bias + rng.normal(0.0, SIGMA, 3)
    force = sensor.T @ np.array([0.0, 0.0, 9.80665]) + rng.normal(0.0, 1e-3, 3)
    return Stop(angle, rate, np.full(3, SIGMA), force, np.full(3, 1e-3))


def _parts(total: int, size: int) -> list[tuple[int, int]]:
    return [(first, min(first + size, total)) for first in range(0, total, size)]


def of_programme(name: str, runs: int) -> dict[str, tuple[float, int]]:
    """Coverage by parameter, part by part."""
    inside: dict[str, list[bool]] = {}
    for first, last in _parts(runs, PART):
        found = stored(
            f"rate_coverage {name} {first}",
            last,
            lambda first=first, last=last: held_of(PROGRAMMES[name], first, last),  # type: ignore[misc]
        )
        for parameter, held in found.items():
            inside.setdefault(parameter, []).extend(held)
    return {key: (float(np.mean(held)), len(held)) for key, held in inside.items()}


def of_headings(runs: int, *, seed: int) -> tuple[float, int, int]:
    """Coverage, wrong roots and headings told as not resolved, part by part."""
    total = np.zeros(3, dtype=np.int64)
    for first, last in _parts(runs, HEADINGS):
        total += stored(
            f"rate_coverage headings {seed} {first}",
            last,
            lambda first=first, last=last: headings(last - first, seed=seed, first=first),  # type: ignore[misc]
        )
    inside, wrong, told = total.tolist()
    return inside / max(runs - told, 1), wrong, told


def run() -> Iterator[str]:
    """Every programme."""
    for name in PROGRAMMES:
        found = of_programme(name, RUNS)
        low, high = min(found.values()), max(found.values())
        yield f"{name}, {RUNS} records: {low[0]:.3f} to {high[0]:.3f} over {len(found)} parameters"
        outside = [f"{k} {v[0]:.3f}" for k, v in found.items() if not 0.92 <= v[0] <= 0.98]
        yield "  outside .92 to .98: " + (", ".join(outside) or "none")
    share, wrong, told = of_headings(10 * RUNS, seed=1)
    yield f"heading by indexing, {10 * RUNS} runs: {share:.3f}, wrong root {wrong}, told {told}"
    share, wrong, told = of_headings(50 * RUNS, seed=2)
    yield f"wrong root silently in {50 * RUNS} runs: {wrong}; not resolved and told: {told}"
