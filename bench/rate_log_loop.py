"""The loop on logs of tables, chambers, a total station and rests: detected, right, wrong.

The table of docs/explanation/rate-sensors.md. ``SURVEYAPP_BENCH_RUNS`` records a cell (200),
``SURVEYAPP_BENCH_PARTS`` some of the kinds of log, ``SURVEYAPP_BENCH_STORE`` a folder in which
finished cells are kept.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from bench._stored import stored
from bench.rate import as_read
from surveyapp.core.simulate.rate.log import SimulatedLog
from surveyapp.core.simulate.rate.recipes import LATITUDE, PROGRAMMES
from surveyapp.core.simulate.rate.table_programmes import DEG_H
from surveyapp.core.simulate.specification import Effect
from surveyapp.diagnosis.engine import diagnose
from surveyapp.diagnosis.result import Diagnosis
from surveyapp.domain.sensor_entry import SensorLogEntry
from surveyapp.workflows import fog_case, rate_case
from surveyapp_models.angles import ARCSEC

RUNS = int(os.environ.get("SURVEYAPP_BENCH_RUNS", "200"))
HOUR = DEG_H / 3600.0
WALK = "random_walk"
"""No effect that is named: what every gyro has wandered by the end, standard deviation."""
SIZES: Mapping[str, float] = {
    "scale_asymmetry": 2e-4,
    "temperature": 1.0 * DEG_H,
    "interference_line": 1.5 * DEG_H,
    "bias_ramp": 10.0 * HOUR,
    "magnetic_sensitivity": 0.01 * DEG_H,
    "flip_error": 120.0 * ARCSEC,
    "gross_error": 3.0 * DEG_H,
    WALK: 3.0 * DEG_H,
}
"""As the simulator takes them; the flip is that of one position of one round."""
KINDS: Mapping[str, tuple[str, str, tuple[str, ...]]] = {
    "six positions": ("rate", "six-position", tuple(k for k in SIZES if k != "flip_error")),
    "six positions, two rounds": ("rate", "six-position", tuple(SIZES)),
    "temperature": (
        "rate",
        "temperature",
        ("scale_asymmetry", "interference_line", "magnetic_sensitivity", "gross_error", WALK),
    ),
    "gyro on a total station": (
        "fog-station",
        "",
        ("temperature", "interference_line", "bias_ramp", "gross_error", WALK),
    ),
    "at rest": (
        "rate",
        "static",
        (
            "temperature",
            "interference_line",
            "bias_ramp",
            "magnetic_sensitivity",
            "gross_error",
            WALK,
        ),
    ),
}


def simulated(kind: str, effect: str, rng: np.random.Generator) -> SimulatedLog:
    """A log of a kind with one effect, or none, or with gyros that wander."""
    if effect == WALK:
        return _wandering(simulated(kind, "", rng), rng)
    command, programme, _ = KINDS[kind]
    recipe = PROGRAMMES[command][programme][0]
    size = SIZES.get(effect, 0.0)
    effects = [] if not effect or effect == "flip_error" else [Effect(effect, size)]
    if not kind.endswith("rounds"):
        return recipe(effects, rng)
    kept = [e for e in effects if e.id != "bias_ramp"]
    first = recipe(kept, rng)
    second = recipe([e for e in kept if e.id != "gross_error"], rng)
    if effect == "flip_error":
        second = _crooked(second, rng)
    whole = _joined(first, second)
    drift = SIZES[effect] * whole.columns["time_s"] if effect == "bias_ramp" else 0.0
    gyros = {f"gyr_{a}_rad_s": whole.columns[f"gyr_{a}_rad_s"] + drift for a in "xyz"}
    return SimulatedLog({**whole.columns, **gyros}, whole.texts, whole.truth)


def _wandering(log: SimulatedLog, rng: np.random.Generator) -> SimulatedLog:
    """The log with a random walk of its own in every gyro."""
    columns = dict(log.columns)
    for name in [c for c in columns if c.startswith("gyr_")]:
        step = SIZES[WALK] / math.sqrt(columns[name].size)
        columns[name] = columns[name] + np.cumsum(rng.normal(0.0, step, columns[name].size))
    return SimulatedLog(columns, log.texts, log.truth)


def _crooked(log: SimulatedLog, rng: np.random.Generator) -> SimulatedLog:
    """One position of a log in which the unit sits askew about the two axes across."""
    words = np.array(log.texts["position"])
    place = sorted(set(words.tolist()))[int(rng.integers(6))]
    axis = "xyz".index(place[0])
    turn = np.zeros(3)
    turn[[k for k in range(3) if k != axis]] = rng.choice([-1.0, 1.0], 2) * SIZES["flip_error"]
    up = 1.0 if place[1] == "+" else -1.0
    along = np.zeros(3)
    along[axis] = up
    leak = np.cross(turn, along)
    columns = dict(log.columns)
    rate = -np.deg2rad(columns["table_rate_deg_s"]) * (words == place)
    for k, a in enumerate("xyz"):
        columns[f"gyr_{a}_rad_s"] = columns[f"gyr_{a}_rad_s"] + leak[k] * rate
    return SimulatedLog(columns, log.texts, log.truth)


def _joined(first: SimulatedLog, second: SimulatedLog) -> SimulatedLog:
    """Two rounds of one record."""
    columns = {}
    begin = float(first.columns["time_s"][-1]) + 0.1
    for name, values in first.columns.items():
        other = second.columns[name] + (begin if name == "time_s" else 0.0)
        columns[name] = np.concatenate([values, other])
    sizes = [log.columns["time_s"].size for log in (first, second)]
    columns["round"] = np.repeat([1.0, 2.0], sizes)
    words = [*first.texts["position"], *second.texts["position"]]
    return SimulatedLog(columns, {"position": words}, first.truth)


@dataclass(frozen=True)
class Told:
    """What a diagnosis said: whether anything, what it named, rms left out before and after."""

    detected: bool
    names: frozenset[str]
    left_out: float


def diagnosed(kind: str, effect: str, seed: int) -> Told:
    """Diagnosis of one record, with the lines of its samples."""
    rng = np.random.default_rng([seed, list(KINDS).index(kind)])
    log = as_read(simulated(kind, effect, rng))
    fog = KINDS[kind][0] == "fog-station"
    entry = SensorLogEntry(
        "log", "fog-station" if fog else "rate", "", latitude_deg=math.degrees(LATITUDE)
    )
    made = (fog_case if fog else rate_case).case_of_log(replace(log, path="log"), entry)
    found: Diagnosis = diagnose(made.case, advise=False)
    keys = {}
    if made.finished is not None:
        found, keys = made.finished(found)
    names = frozenset(a.effect for a in found.adopted)
    told = found.to_dict()
    pair = told["before"]["loo_rms"], told["after"]["loo_rms"]
    if effect == "interference_line" and keys["interference"]:
        held = [item["held_out"] for item in keys["interference"]]
        pair = min(((h["before"], h["after"]) for h in held), key=lambda h: h[1] / h[0])
    return Told(found.verdict != "adequate", names, (pair[1] or 0.0) / (pair[0] or 1.0))


def cell(kind: str, effect: str) -> list[float]:
    """Shares detected, rightly and wrongly named, and the median of after through before."""
    every = [diagnosed(kind, effect, seed) for seed in range(RUNS)]
    wanted = {effect} - {"", WALK}
    right = [bool(wanted) and t.names == wanted for t in every]
    ratio = [t.left_out for t, good in zip(every, right, strict=True) if good]
    return [
        float(np.mean([t.detected for t in every])),
        float(np.mean(right)),
        float(np.mean([bool(t.names - wanted) for t in every])),
        float(np.median(ratio)) if ratio else math.nan,
    ]


def run() -> Iterator[str]:
    """Every cell."""
    yield f"{RUNS} records a cell: detected / rightly / wrongly named, left-out rms after / before"
    wanted = os.environ.get("SURVEYAPP_BENCH_PARTS", "")
    for kind, (_, _, effects) in KINDS.items():
        if wanted and kind not in wanted.split(","):
            continue
        yield kind
        for effect in ("", *effects):
            shares = stored(
                f"rate_log_loop {kind} {effect}",
                RUNS,
                lambda kind=kind, effect=effect: cell(kind, effect),  # type: ignore[misc]
            )
            told = " / ".join(f"{s:.2f}" for s in shares)
            yield f"  {effect or 'none'}: {told}"
