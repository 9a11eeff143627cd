"""Rate sensors: processor seconds and memory of the large cases.

Lines of a record of 1e7 samples (``find_interference`` on a column that is mapped to disk), six
positions from 40 minutes at 100 Hz, two hundred programmes by a pool, motion of 1e7 samples in
pieces, a hand-held record of 50,000 samples with its loop, a million quaternion steps. Memory is
what numpy and Python allocate at most beside the record itself (tracemalloc).
"""

from __future__ import annotations

import math
import tempfile
import time
import tracemalloc
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np

from bench.rate import as_read
from surveyapp.core.sensors.rate.motion_pieces import ACCELEROMETERS, GYROS, states_of
from surveyapp.core.sensors.rate.multi_position_log import (
    MultiPositionOptions,
    calibrate_multi_position,
)
from surveyapp.core.sensors.rate.six_position_log import SixPositionOptions, calibrate_six_positions
from surveyapp.core.simulate.rate.log import SimulatedLog
from surveyapp.core.simulate.rate.recipes import example_unit, hand_run
from surveyapp.core.simulate.rate.table_programmes import TableRun, six_position_log
from surveyapp.core.simulate.rate.vehicle import VehicleRun, hand_held_log, usual_drive, vehicle_log
from surveyapp.diagnosis.engine import diagnose
from surveyapp.diagnosis.long_records.interference import find_interference
from surveyapp.diagnosis.rate_stops import stops_of
from surveyapp.diagnosis.subjects.rate import rate_case
from surveyapp.domain.sensor_log import SensorLog
from surveyapp_models.arrays import Floats
from surveyapp_models.rate import quaternions
from surveyapp_models.rate.triad import Triad

SAMPLES = 10_000_000
HZ = 100.0
PROGRAMMES = 200


def _mapped(folder: Path, name: str, size: int) -> Floats:
    """An array of that size on disk."""
    return np.memmap(folder / name, dtype=np.float64, mode="w+", shape=(size,))


def _measured(work: Callable[[], str]) -> str:
    """What a work tells, its processor seconds, then its memory in a second run."""
    begin = time.process_time()
    told = work()
    took = time.process_time() - begin
    tracemalloc.start()
    work()
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    return f"{told}: {took:.1f} s of processor, {peak / 1e6:.0f} MB beside the record"


def lines(folder: Path) -> str:
    """A line of .02 sd in white noise."""
    rng = np.random.default_rng(1)
    time_s, values = _mapped(folder, "time", SAMPLES), _mapped(folder, "value", SAMPLES)
    for first in range(0, SAMPLES, 1_000_000):
        rows = np.arange(first, min(first + 1_000_000, SAMPLES))
        time_s[rows] = rows / HZ
        values[rows] = rng.normal(size=rows.size) + 0.02 * np.cos(2.0 * np.pi * 12.48 * rows / HZ)

    def work() -> str:
        found = find_interference(time_s, values)
        return f"{len(found.lines)} line in a record of {SAMPLES:.0e} samples"

    return _measured(work)


def long_drive(folder: Path, size: int = SAMPLES) -> SensorLog:
    """One drive over and over, its columns on disk."""
    run = VehicleRun(
        usual_drive(8),
        gyro=Triad(bias=np.array([0.002, -0.001, 0.0015]), noise=0.001),
        accelerometer=Triad(noise=0.02),
    )
    once = vehicle_log(run, np.random.default_rng(1))
    length = once.columns["time_s"].size
    columns = {c: _mapped(folder, c, size) for c in ("time_s", *ACCELEROMETERS, *GYROS)}
    for first in range(0, size, length):
        part = slice(first, min(first + length, size))
        for name, column in columns.items():
            column[part] = once.columns[name][: part.stop - first]
        columns["time_s"][part] += first / HZ
    return SensorLog(
        id="drive", columns=columns, units=dict.fromkeys(columns, "1"), size=size, rate_hz=HZ
    )


def motion(folder: Path) -> str:
    """States of a drive of 28 hours."""
    log = long_drive(folder)

    def work() -> str:
        found = states_of(log, false_alarm=0.01)
        return f"motion of {SAMPLES:.0e} samples, {len(found.segments)} segments"

    return _measured(work)


def six_positions() -> str:
    """Forty minutes at 100 Hz."""
    unit = example_unit({}, TableRun(turns=10.0, interval_s=0.01))
    log = as_read(six_position_log(replace(unit, warm_up_s=180.0), np.random.default_rng(1)))
    begin = time.process_time()
    calibrate_six_positions(log, SixPositionOptions())
    took = time.process_time() - begin
    return f"six positions from {log.size / 6000.0:.0f} min at 100 Hz: {took:.2f} s of processor"


def _programme(seed: int) -> float:
    unit = example_unit({}, TableRun(turns=2.0, interval_s=0.25, pause_s=1.0))
    log = as_read(six_position_log(unit, np.random.default_rng(seed)))
    found = calibrate_six_positions(log, SixPositionOptions())
    return found.value("bias_x") or math.nan


def pool() -> str:
    """Two hundred records simulated and calibrated by two processes."""
    begin = time.perf_counter()
    with ProcessPoolExecutor(2) as executor:
        found = list(executor.map(_programme, range(PROGRAMMES), chunksize=10))
    took = time.perf_counter() - begin
    spread = float(np.std(found))
    return f"{len(found)} programmes by a pool: {took:.1f} s, bias x scatters {spread:.4f} deg/h"


def hand_held() -> str:
    """Fifty thousand samples: parameters, then the loop."""
    rng = np.random.default_rng(1)
    run = hand_run({"stops": 84.0, "g_sensitivity": math.radians(0.002)}, rng)
    log = as_read(_first(hand_held_log(replace(run, warmth=0.0), rng), 50_000))
    begin = time.process_time()
    calibrate_multi_position(log, MultiPositionOptions(run.latitude))
    stops, turns, _ = stops_of(log, latitude=run.latitude)
    found = diagnose(rate_case(stops, turns, identity="unit"))
    took = time.process_time() - begin
    names = ", ".join(item.effect for item in found.adopted) or "nothing"
    return (
        f"hand-held record of {log.size} samples, {len(stops)} stops, with its loop: "
        f"{took:.1f} s of processor, {names} named"
    )


def _first(log: SimulatedLog, rows: int) -> SimulatedLog:
    return SimulatedLog({k: v[:rows] for k, v in log.columns.items()}, {}, log.truth)


def steps() -> str:
    """A million quaternion steps against a plain loop over 20,000."""
    rates = np.random.default_rng(1).normal(0.0, 0.2, (1_000_000, 3))
    begin = time.process_time()
    quaternions.integrate(rates, interval_s=0.01)
    fast = time.process_time() - begin
    begin = time.process_time()
    q = np.array([1.0, 0.0, 0.0, 0.0])
    for row in rates[:20_000]:
        q = quaternions.multiply(q, quaternions.from_rotation_vector(row * 0.01))
    slow = 50.0 * (time.process_time() - begin)
    constant = np.tile([0.1, -0.2, 0.3], (1_000_000, 1))
    last = quaternions.integrate(constant, interval_s=1e-4)[-1]
    off = np.abs(last - quaternions.from_rotation_vector(100.0 * constant[0])).max()
    return (
        f"1e6 quaternion steps: {fast:.2f} s of processor, a plain loop {slow:.0f} s "
        f"({slow / fast:.0f} times); constant rate off by {off:.0e}"
    )


def run() -> Iterator[str]:
    """Every case."""
    yield six_positions()
    yield hand_held()
    yield steps()
    yield pool()
    with tempfile.TemporaryDirectory() as name:
        yield lines(Path(name))
    with tempfile.TemporaryDirectory() as name:
        yield motion(Path(name))
