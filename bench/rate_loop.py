"""The loop on hand-held stops: detected, rightly named, wrongly named at 12, 18 and 30 stops.

The table of docs/explanation/sensors.md; ``SURVEYAPP_BENCH_RUNS`` records a cell (200), and
``SURVEYAPP_BENCH_STORE`` a folder in which finished parts are kept; ``SURVEYAPP_BENCH_ODDS`` other
odds than the rule's, to see what keeping walks from names costs.

Noise .05 deg/s a sample at 50 Hz and .006 deg/s from stop to stop; a walk of a given size a
stop on every gyro, and a step of all gyros at once, which are in no catalogue.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from bench._stored import stored
from bench.rate import as_read
from surveyapp.core.simulate.rate.recipes import hand_run
from surveyapp.core.simulate.rate.vehicle import hand_held_log
from surveyapp.diagnosis import wandering
from surveyapp.diagnosis.engine import diagnose
from surveyapp.diagnosis.rate_stops import stops_of
from surveyapp.diagnosis.result import Diagnosis
from surveyapp.diagnosis.subjects.rate import rate_case

RUNS = int(os.environ.get("SURVEYAPP_BENCH_RUNS", "200"))
ODDS = float(os.environ.get("SURVEYAPP_BENCH_ODDS", str(wandering.ODDS)))
STOPS = (12, 18, 30)
PART = 50
"""Records of a stored part."""
DEG = math.radians(1.0)
TOGETHER = "temperature or bias_ramp"
"""What cannot be told apart: right where just this is said."""
CELLS: Mapping[str, tuple[str, Mapping[str, float]]] = {
    "none": ("", {}),
    "g-sensitivity .002 deg/s per m/s2": ("g_sensitivity", {"g_sensitivity": 0.002 * DEG}),
    "g-sensitivity .0008": ("g_sensitivity", {"g_sensitivity": 0.0008 * DEG}),
    "ramp .02 deg/s per min": ("bias_ramp", {"per_minute": 0.02 * DEG}),
    "ramp .008": ("bias_ramp", {"per_minute": 0.008 * DEG}),
    "temperature .0015 deg/s per K, 5 K up and down": (
        "temperature",
        {"per_kelvin": 0.0015 * DEG, "kelvin": 5.0, "cycles": 1.5},
    ),
    "the same, 15 K rising with time": (
        TOGETHER,
        {"per_kelvin": 0.0015 * DEG, "kelvin": 15.0, "cycles": 0.0},
    ),
    "scale asymmetry 4e-3": ("scale_asymmetry", {"scale_asymmetry": 4e-3}),
    "gross error .05 deg/s": ("gross_error", {"gross_error": 0.05 * DEG}),
    "gross error .025": ("gross_error", {"gross_error": 0.025 * DEG}),
    "random walk .003 deg/s": ("", {"random_walk": 0.003 * DEG}),
    "random walk .006": ("", {"random_walk": 0.006 * DEG}),
    "random walk .01": ("", {"random_walk": 0.01 * DEG}),
    "step .012 deg/s": ("", {"step": 0.012 * DEG}),
}


def diagnosed(seed: int, stops: int, sizes: Mapping[str, float]) -> Diagnosis:
    """Diagnosis of one simulated record."""
    rng = np.random.default_rng([seed, stops])
    seconds = stops * 6.0 - 2.0
    beside = ("per_minute", "step", "per_kelvin", "kelvin", "cycles")
    given = {k: v for k, v in sizes.items() if k not in beside}
    if "per_minute" in sizes:
        given["bias_ramp"] = sizes["per_minute"] * seconds / 60.0
    run = hand_run({**given, "stops": float(stops)}, rng)
    run = replace(run, interval_s=0.02, warmth=0.0)
    log = hand_held_log(run, rng)
    if "step" in sizes:
        after = log.columns["time_s"] > 6.0 * rng.integers(3, stops - 2)
        for a in "xyz":
            log.columns[f"gyr_{a}_rad_s"] += sizes["step"] * after
    if "per_kelvin" in sizes:
        share = log.columns["time_s"] / seconds
        swing = np.sin(2.0 * np.pi * sizes["cycles"] * share) if sizes["cycles"] else share
        warmth = sizes["kelvin"] * swing
        log.columns["temperature_c"] += warmth
        for a in "xyz":
            log.columns[f"gyr_{a}_rad_s"] += sizes["per_kelvin"] * warmth
    rests, turns, _ = stops_of(as_read(log), latitude=run.latitude)
    return diagnose(rate_case(rests, turns, identity="unit"), advise=False)


def counts(name: str, stops: int, first: int, last: int) -> list[int]:
    """Records first to last detected, rightly named (and nothing else), wrongly named."""
    wanted, sizes = CELLS[name]
    detected = right = wrong = 0
    for seed in range(first, last):
        found = diagnosed(seed, stops, sizes)
        names = {item.effect for item in found.adopted}
        detected += found.verdict != "adequate"
        if wanted == TOGETHER:
            told = {option for item in found.ambiguous for option in item.any_of}
            right += not names and {"temperature", "bias_ramp"} <= told
        else:
            right += names == {wanted}
        wrong += bool(names - {wanted})
    return [detected, right, wrong]


def cell(name: str, stops: int, runs: int) -> tuple[float, float, float]:
    """Shares of the same, part by part."""
    total = np.zeros(3)
    for first in range(0, runs, PART):
        last = min(first + PART, runs)
        part = stored(
            f"rate_loop {name} {stops} {first}",
            (last, ODDS),
            lambda first=first, last=last: counts(name, stops, first, last),  # type: ignore[misc]
        )
        total += part
    detected, right, wrong = (total / runs).tolist()
    return detected, right, wrong


def run() -> Iterator[str]:
    """Every cell."""
    wandering.ODDS = ODDS
    yield f"{RUNS} records a cell: detected / rightly / wrongly named at {STOPS} stops"
    for name in CELLS:
        told = ["/".join(f"{share:.2f}" for share in cell(name, stops, RUNS)) for stops in STOPS]
        yield f"  {name}: {', '.join(told)}"
