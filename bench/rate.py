"""Rate sensors: what the tests hold in a subset, over whole campaigns, and how long it takes.

Coverage of the twelve parameters over 200 records, of the heading by indexing over 600 runs, the
scatter of the gyro on a total station; speed of a spectrum of 1e7 samples, of six positions from 40
minutes at 100 Hz, of quaternions against a plain loop.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from surveyapp.core.sensors.rate.indexing import solve_indexing
from surveyapp.core.sensors.rate.indexing_values import Setting, Stop
from surveyapp.core.sensors.rate.six_position_log import (
    SixPositionOptions,
    calibrate_six_positions,
)
from surveyapp.core.simulate.rate.log import SimulatedLog
from surveyapp.core.simulate.rate.recipes import example_unit
from surveyapp.core.simulate.rate.table_programmes import DEG_H, TableRun, six_position_log
from surveyapp.diagnosis.long_records.averaged import averaged_spectrum
from surveyapp.domain.sensor_log import SensorLog
from surveyapp_models.angles import wrap_pi
from surveyapp_models.arrays import Floats
from surveyapp_models.rate import quaternions
from surveyapp_models.rate.attitude import attitude_matrix, axis_rotation, earth_rate

RECORDS = 200
HEADINGS = 600
SIGMA = 0.05 * DEG_H


def as_read(log: SimulatedLog) -> SensorLog:
    """The log as a file of it would be read."""
    time_s = log.columns["time_s"]
    return SensorLog(
        id="log",
        columns=log.columns,
        units=dict.fromkeys(log.columns, "1"),
        size=time_s.size,
        texts={k: tuple(v) for k, v in log.texts.items()},
        rate_hz=1.0 / float(np.median(np.diff(time_s))),
    )


def coverage_of_parameters() -> Iterator[str]:
    unit = example_unit({}, TableRun(turns=2.0, interval_s=0.25, pause_s=1.0))
    unit = replace(unit, warm_up_s=10.0, static_s=5.0)
    inside: dict[str, list[bool]] = {}
    for seed in range(RECORDS):
        log = six_position_log(unit, np.random.default_rng(seed))
        for item in calibrate_six_positions(as_read(log), SixPositionOptions()).parameters:
            if item.value is not None and item.sigma is not None:
                off = abs(item.value - float(str(log.truth[item.name])))
                inside.setdefault(item.name, []).append(off <= 1.96 * item.sigma)
    shares = {name: float(np.mean(values)) for name, values in inside.items()}
    yield f"six positions, {RECORDS} records: coverage of the 95 % interval by parameter"
    yield f"  {min(shares.values()):.3f} to {max(shares.values()):.3f}"


def coverage_of_headings() -> Iterator[str]:
    rng = np.random.default_rng(1)
    inside = wrong = told = 0
    for k in range(HEADINGS):
        phi = math.radians((0, 20, 40, 60, -45)[k % 5])
        pitch, roll = ((0, 0), (12, -5), (25, 10))[k % 3]
        index = ((0, 90, 180, 270), (0, 180))[k % 2]
        heading = rng.uniform(0.0, 2.0 * math.pi)
        body = attitude_matrix(heading=heading, pitch=math.radians(pitch), roll=math.radians(roll))
        bias = rng.normal(0.0, 10.0, 3) * DEG_H
        found = solve_indexing([_stop(body, phi, bias, a, rng=rng) for a in index], Setting(phi))
        if found.verdict != "resolved":
            told += 1
            continue
        off = abs(wrap_pi(found.roots[0].heading - heading)) / found.roots[0].heading_sigma()
        inside, wrong = inside + (off <= 1.96), wrong + (off > 6.0)
    count = HEADINGS - told
    yield f"heading by indexing, {HEADINGS} runs: coverage {inside / count:.3f}, wrong root {wrong}"
    yield f"  not resolved and told so: {told}"


def _stop(
    body: Floats, latitude: float, bias: Floats, angle: float, *, rng: np.random.Generator
) -> Stop:
    sensor = body @ axis_rotation(2, -math.radians(angle))
    rate = sensor.T @ earth_rate(latitude) + bias + rng.normal(0.0, SIGMA, 3)
    force = sensor.T @ np.array([0.0, 0.0, 9.80665]) + rng.normal(0.0, 1e-3, 3)
    return Stop(math.radians(angle), rate, np.full(3, SIGMA), force, np.full(3, 1e-3))


def speed() -> Iterator[str]:
    rng = np.random.default_rng(1)
    pieces = (
        rng.normal(0.0, 1.0, 1 << 20)
        + 0.02 * np.cos(2.0 * np.pi * 0.12483 * (np.arange(1 << 20) + k * (1 << 20)))
        for k in range(10)
    )
    begin = time.perf_counter()
    lines = averaged_spectrum(pieces).lines()
    took = time.perf_counter() - begin
    yield f"lines of 1.05e7 samples, noise made as well: {took:.1f} s, {len(lines)} found"
    unit = example_unit({}, TableRun(turns=10.0, interval_s=0.01))
    log = as_read(six_position_log(replace(unit, warm_up_s=180.0), rng))
    begin = time.perf_counter()
    calibrate_six_positions(log, SixPositionOptions())
    minutes = log.size / 6000.0
    yield f"six positions from {minutes:.0f} min at 100 Hz: {time.perf_counter() - begin:.2f} s"
    rates = rng.normal(0.0, 0.2, (1_000_000, 3))
    begin = time.perf_counter()
    quaternions.integrate(rates, interval_s=0.01)
    fast = time.perf_counter() - begin
    begin = time.perf_counter()
    q = np.array([1.0, 0.0, 0.0, 0.0])
    for row in rates[:20_000]:
        q = quaternions.multiply(q, quaternions.from_rotation_vector(row * 0.01))
    slow = 50.0 * (time.perf_counter() - begin)
    yield f"1e6 quaternion steps: {fast:.2f} s, a plain loop {slow:.0f} s ({slow / fast:.0f} times)"


def run() -> Iterator[str]:
    yield from coverage_of_parameters()
    yield from coverage_of_headings()
    yield from speed()
