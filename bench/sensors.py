"""Sensors: the gate of the ellipsoid, coverage of the coefficients, and speed against others.

``SURVEYAPP_BENCH_RUNS`` records a cell (200); ``SURVEYAPP_BENCH_PARTS`` some of speed, gate,
coverage (all). Each line is printed when it is ready.
"""

from __future__ import annotations

import math
import os
import time
import tracemalloc
from collections.abc import Callable, Iterator
from functools import partial
from statistics import median

import numpy as np

from bench._stored import stored
from surveyapp.core.sensors.allan import allan_variances, octaves
from surveyapp.core.sensors.compass_calibration import calibrate_ellipsoid
from surveyapp.core.sensors.filters import LocalLevel, kalman, particles
from surveyapp.core.sensors.noise_coefficients import coefficients_of
from surveyapp.core.simulate.sensors import flicker_noise
from surveyapp.diagnosis.sensors.diagnosis import diagnose_sensor
from surveyapp.diagnosis.sensors.records import compass_record
from surveyapp.domain.sensor_log import SensorLog
from surveyapp_models.arrays import Floats
from surveyapp_models.compass.heading import heading_of, level_field, tilted

RECORDS = int(os.environ.get("SURVEYAPP_BENCH_RUNS", "200"))
PARTS = os.environ.get("SURVEYAPP_BENCH_PARTS", "speed,gate,coverage").split(",")
SAMPLES = 10_000_000
SHAPES = ("sphere", "30", "15", "cap", "5", "2")


def _seconds(function: Callable[[], object]) -> float:
    """Processor time, so that other work on the machine does not count."""
    start = time.process_time()
    function()
    return time.process_time() - start


def _directions(shape: str, rng: np.random.Generator, n: int) -> Floats:
    psi = rng.uniform(0.0, 2.0 * np.pi, n)
    if shape in ("sphere", "cap"):
        z = rng.uniform(-1.0 if shape == "sphere" else 0.66, 1.0, n)
        level = np.sqrt(1.0 - z**2)
        return np.column_stack([level * np.cos(psi), level * np.sin(psi), z])
    span = math.radians(float(shape))
    field = level_field(psi, size=1.0, dip=math.radians(65.0))
    return tilted(field, pitch=rng.uniform(-span, span, n), roll=rng.uniform(-span, span, n))


def _distorted(
    shape: str, seed: int, sigma: float, n: int = 400
) -> tuple[SensorLog, Floats, Floats]:
    """A record, its hard iron, and the matrix that corrects its soft iron."""
    rng = np.random.default_rng([seed, len(shape), 16])
    hard = rng.normal(0.0, 12.0, 3)
    soft = rng.normal(0.0, 0.06, (3, 3))
    soft = 0.5 * (soft + soft.T)
    soft -= np.trace(soft) / 3.0 * np.eye(3)
    values, vectors = np.linalg.eigh(soft)
    corrects = (vectors * np.exp(values)) @ vectors.T
    field = 50.0 * _directions(shape, rng, n)
    points = field @ np.linalg.inv(corrects) + hard + rng.normal(0.0, sigma, field.shape)
    columns = {f"mag_{axis}_uT": points[:, i] for i, axis in enumerate("xyz")}
    columns["time_s"] = np.arange(n) / 20.0
    return SensorLog("c", columns, {}, n, rate_hz=20.0), hard, corrects


def _worst(used: dict[str, float], hard: Floats, corrects: Floats) -> float:
    """Largest error of a corrected level heading [deg]."""
    names = ("xx", "yy", "zz", "xy", "xz", "yz")
    xx, yy, zz, xy, xz, yz = (used[f"used_soft_iron_{p}"] for p in names)
    w = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    b = np.array([used[f"used_hard_iron_{axis}"] for axis in "xyz"])
    psi = np.radians(np.arange(0.0, 360.0, 10.0))
    read = level_field(psi, size=50.0, dip=math.radians(65.0)) @ np.linalg.inv(corrects) + hard
    error = heading_of((read - b) @ w) - psi
    return float(np.max(np.abs(np.degrees((error + np.pi) % (2.0 * np.pi) - np.pi))))


def _cell(shape: str, sigma: float) -> tuple[int, int]:
    """How many records are accepted, and how many of these have a wrong heading."""
    accepted = wrong = 0
    for seed in range(RECORDS):
        log, hard, corrects = _distorted(shape, seed, sigma)
        result = calibrate_ellipsoid(log, limit=math.radians(0.5))
        if result.met:
            accepted += 1
            wrong += _worst(dict(result.constants), hard, corrects) > 1.5
    return accepted, int(wrong)


def gate() -> Iterator[str]:
    """Accepted records of each shape, and how many of them have a heading worse than 1.5 deg."""
    for sigma in (0.3, 1.0):
        for shape in SHAPES:
            make = partial(_cell, shape, sigma)
            accepted, wrong = stored(f"gate {shape}", (RECORDS, sigma), make)
            yield f"gate, {shape} at {sigma} uT: {accepted} of {RECORDS} accepted, {wrong} wrong"


def _series(size: dict[str, float], rng: np.random.Generator, n: int, dt: float) -> Floats:
    series = size.get("Q", 0.0) * np.diff(rng.normal(size=n + 1)) / dt
    series += size.get("N", 0.0) / math.sqrt(dt) * rng.normal(size=n)
    series += size.get("B", 0.0) * flicker_noise(n, rng)
    series += size.get("K", 0.0) * math.sqrt(dt) * np.cumsum(rng.normal(size=n))
    return np.asarray(series + size.get("R", 0.0) * dt * np.arange(n))


def coverage() -> Iterator[str]:
    """Coverage of 1.96 sigma where a coefficient is determined, and wrongly determined ones."""
    for truth in (
        {"Q": 0.02, "N": 0.5, "B": 0.3},
        {"N": 1.0, "K": 0.15},
        {"N": 1.0, "R": 0.004},
        {"Q": 0.02, "N": 0.5, "B": 0.3, "K": 0.02},
    ):
        held: dict[str, list[bool]] = {symbol: [] for symbol in truth}
        wrong = absent = 0
        for seed in range(RECORDS):
            series = _series(truth, np.random.default_rng([seed, 7]), 100_000, 0.01)
            for item in coefficients_of(series, interval=0.01):
                if item.symbol not in truth:
                    absent += 1
                    wrong += item.value is not None
                elif item.value is not None and item.sigma is not None:
                    held[item.symbol].append(
                        abs(item.value - truth[item.symbol]) < 1.96 * item.sigma
                    )
        told = ", ".join(
            f"{s} {np.mean(v):.3f} of {len(v)}" if v else f"{s} never determined"
            for s, v in held.items()
        )
        yield f"coefficients {truth}: {told}; absent ones determined {wrong} of {absent}"


def speed() -> list[str]:
    """Against allantools and filterpy, one thread."""
    import allantools
    from filterpy.kalman import KalmanFilter

    series = np.random.default_rng(1).normal(size=SAMPLES)
    factors = octaves(SAMPLES)[:22]
    taus = np.array(factors, dtype=float)
    ratios = []
    for _ in range(4):
        ours = _seconds(lambda: allan_variances(series, factors))
        theirs = _seconds(lambda: allantools.oadev(series, rate=1.0, data_type="freq", taus=taus))
        ratios.append(theirs / ours)
    tracemalloc.start()
    allan_variances(series, factors)
    peak = (tracemalloc.get_traced_memory()[1] + series.nbytes) / series.nbytes
    tracemalloc.stop()
    short, model = series[:20_000], LocalLevel(0.01, 1.0)
    kalman(short, model)
    mine = _seconds(lambda: kalman(short, model))
    other = KalmanFilter(dim_x=1, dim_z=1)
    other.x, other.P, other.F, other.H = np.zeros((1, 1)), np.eye(1), np.eye(1), np.eye(1)
    other.Q, other.R = np.array([[model.q]]), np.array([[model.r]])

    def run_other() -> None:
        for value in short:
            other.predict()
            other.update(value)

    filterpy = _seconds(run_other)
    cloud = _seconds(
        lambda: particles(series[:100_000], model, np.random.default_rng(1), count=1000)
    )
    log, _, _ = _distorted("sphere", 1, 0.3, n=10_000)
    compass = _seconds(
        lambda: (
            calibrate_ellipsoid(log, limit=math.radians(0.5)),
            diagnose_sensor(compass_record(log), identity="c", n_log=log.size),
        )
    )
    return [
        f"oadev of {SAMPLES:.0e} samples at {len(factors)} octaves: {median(ratios):.2f} times "
        f"allantools (target 2.5), {peak:.2f} times the data in memory (target 2.2)",
        f"Kalman filter, 20,000 steps: {filterpy / mine:.0f} times filterpy (target 50)",
        f"particle filter, 1e5 x 1000: {cloud:.1f} s (target 8)",
        f"ellipsoid with selection and loop, 10,000 samples: {compass:.2f} s (target 2)",
    ]


def run() -> Iterator[str]:
    """Speed, gate, coverage."""
    for name, part in (("speed", speed), ("gate", gate), ("coverage", coverage)):
        if name in PARTS:
            yield from part()
