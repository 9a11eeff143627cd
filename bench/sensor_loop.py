"""The loop on compass and tilt logs: false alarms, names under noise that wanders, switch times.

``SURVEYAPP_BENCH_RUNS`` records a line (200); lines are kept in ``SURVEYAPP_BENCH_STORE``. AR(1):
.95 from sample to sample, driven by .1 uT (.1 arcsec); a walk of 6 uT (6 arcsec) from end to end,
each axis by itself. Which is wrong: any name.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial

import numpy as np
from scipy.signal import lfilter

from bench._stored import stored
from surveyapp.core.simulate.sensors import simulate_compass, simulate_tilt
from surveyapp.core.simulate.specification import Effect
from surveyapp.diagnosis.sensors.diagnosis import SensorDiagnosis, diagnose_sensor
from surveyapp.diagnosis.sensors.records import compass_record, tilt_record
from surveyapp.domain.sensor_log import SensorLog
from surveyapp_models.arrays import Floats

RUNS = int(os.environ.get("SURVEYAPP_BENCH_RUNS", "200"))
Noise = Callable[[int, np.random.Generator], Floats]


def white(rows: int, rng: np.random.Generator) -> Floats:
    """Nothing beside the sensor's own white noise."""
    del rng
    return np.zeros(rows)


def ar1(rows: int, rng: np.random.Generator) -> Floats:
    """Correlated by .95 from one row to the next."""
    return np.asarray(lfilter([0.1], [1.0, -0.95], rng.normal(size=rows)))


def walk(rows: int, rng: np.random.Generator) -> Floats:
    """A random walk over 6 units from its lowest to its highest."""
    path = np.cumsum(rng.normal(size=rows))
    return np.asarray(path * 6.0 / np.ptp(path))


def log_of(
    kind: str, rng: np.random.Generator, *effects: Effect
) -> tuple[SensorLog, dict[str, float]]:
    """A simulated log as a file of it would be read, and the truth of its first effect."""
    files, truth = (simulate_compass if kind == "compass" else simulate_tilt)(effects, rng)
    head, rest = files[f"sensors/{kind}.csv"].split("\n", 1)
    table = np.loadtxt(rest.splitlines(), delimiter=",")
    columns = {name: table[:, i].copy() for i, name in enumerate(head.split(","))}
    units = dict.fromkeys(columns, "1")
    time = columns["time_s"]
    log = SensorLog(kind, columns, units, time.size, rate_hz=1.0 / float(time[1] - time[0]))
    return log, (truth["effects"][0] if truth["effects"] else {})


def disturbed(log: SensorLog, noise: Noise, rng: np.random.Generator) -> SensorLog:
    """The log with noise on every axis of the sensor."""
    own = ("mag_", "tilt_")
    columns = {
        name: values + noise(log.size, rng) if name.startswith(own) else values
        for name, values in log.columns.items()
    }
    return replace(log, columns=columns)


def found_in(log: SensorLog, kind: str, *, attitude: bool = True) -> SensorDiagnosis:
    """Diagnosis of a log, of a compass with its reference attitude or without."""
    if not attitude:
        columns = {k: v for k, v in log.columns.items() if not k.startswith("ref_")}
        log = replace(log, columns=columns)
    record = compass_record(log) if kind == "compass" else tilt_record(log)
    return diagnose_sensor(record, identity=kind, n_log=log.size)


def named(kind: str, noise: Noise, runs: int, *, attitude: bool = True) -> float:
    """Share of clean records under a noise in which anything is named."""
    wrong = 0
    for seed in range(runs):
        log, _ = log_of(kind, np.random.default_rng([seed, 1]))
        log = disturbed(log, noise, np.random.default_rng([seed, 2]))
        wrong += bool(found_in(log, kind, attitude=attitude).document["adopted"])
    return wrong / runs


def switch_times(size: float, runs: int) -> tuple[float, float]:
    """Share of switches of a size [uT] that are named, and of their times within a second."""
    seen, within = 0, []
    for seed in range(runs):
        rng = np.random.default_rng([seed, 3])
        effect = Effect("interference_step", size)
        log, truth = log_of("compass", rng, effect)
        for item in found_in(log, "compass").document["adopted"]:
            if item["effect"] != "interference_step":
                continue
            seen += 1
            for place in item["grid"]:
                value = np.inf if place["value"] is None else place["value"]
                within.append(abs(value - truth[place["name"]]) <= 1.0)
    return seen / runs, float(np.mean(within)) if within else 0.0


def run() -> Iterator[str]:
    """Every line."""
    for kind, attitude in (("compass", True), ("compass", False), ("tilt", True)):
        shares = [
            stored(
                f"sensor loop {kind} {noise.__name__}",
                (RUNS, attitude),
                partial(named, kind, noise, RUNS, attitude=attitude),
            )
            for noise in (white, ar1, walk)
        ]
        told = "" if attitude else " without attitude"
        numbers = "white {:.3f}, AR(1) {:.3f}, walk {:.3f}".format(*shares)
        yield f"{kind}{told}, {RUNS} records: named in {numbers}"
    for size in (15.0, 6.0, 3.0):
        make = partial(switch_times, size, RUNS)
        share, within = stored("sensor loop switch", (RUNS, size), make)
        yield f"switch of {size:g} uT: named {share:.3f}, times within 1 s {within:.3f}"
