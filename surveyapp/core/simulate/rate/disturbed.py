"""Effects that are added to what the gyros of a simulated log put out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from surveyapp.core.simulate.rate.log import SimulatedLog
from surveyapp.core.simulate.specification import Effect
from surveyapp_models.arrays import Floats

NODES_C: Final = (-10.0, 5.0, 20.0, 30.0, 40.0)
"""Chamber temperatures of source 000-25."""


def sizes_of(effects: Sequence[Effect]) -> dict[str, float]:
    """Size of each effect by its id."""
    return {e.id: e.size for e in effects}


def _option(effects: Sequence[Effect], identity: str, name: str, default: float) -> float:
    for effect in effects:
        if effect.id == identity:
            return float(dict(effect.options).get(name) or default)
    return default


def disturbed(
    log: SimulatedLog, effects: Sequence[Effect], rng: np.random.Generator
) -> SimulatedLog:
    """The sensor warms by 5 K, and effects are added to what the gyros put out."""
    columns = dict(log.columns)
    time = columns["time_s"]
    warmth = 5.0 * (1.0 - np.exp(-time / (0.4 * float(time[-1]))))
    columns["temperature_c"] = 20.0 + warmth + rng.normal(0.0, 0.02, time.size)
    for name in (c for c in log.columns if c.startswith("gyr_")):
        columns[name] = columns[name] + sizes_of(effects).get("temperature", 0.0) * warmth
    return struck(SimulatedLog(columns, log.texts, log.truth), effects, rng)


def struck(log: SimulatedLog, effects: Sequence[Effect], rng: np.random.Generator) -> SimulatedLog:
    """A line in gyro x, a field that is switched, one stop of gyro x that is off."""
    sizes = sizes_of(effects)
    columns = dict(log.columns)
    time = columns["time_s"]
    names = [c for c in log.columns if c.startswith("gyr_")]
    if "interference_line" in sizes:
        hz = _option(effects, "interference_line", "hz", 2.48)
        wave = sizes["interference_line"] * np.sin(2.0 * np.pi * hz * time)
        columns[names[0]] = columns[names[0]] + wave
    if "magnetic_sensitivity" in sizes:
        columns |= switched_field(columns, sizes["magnetic_sensitivity"], names, rng)
    if "gross_error" in sizes:
        words = np.array(log.texts["position"])
        places = sorted(set(words.tolist()))
        struck = words == places[int(rng.integers(len(places)))]
        if "reference_temperature_c" in columns:
            struck &= columns["reference_temperature_c"] == NODES_C[int(rng.integers(5))]
        struck &= columns["table_rate_deg_s"] > 0.0
        columns[names[0]] = columns[names[0]] + sizes["gross_error"] * struck
    return SimulatedLog(columns, log.texts, dict(log.truth) | {"effects": sizes})


def switched_field(
    columns: Mapping[str, Floats],
    sensitivity: float,
    names: Sequence[str],
    rng: np.random.Generator,
) -> dict[str, Floats]:
    """A fluxgate beside the gyros in a field that is switched, and what the gyros make of it.

    ``sensitivity`` [unit of the gyros / uT].
    """
    time = columns["time_s"]
    found: dict[str, Floats] = {}
    for k, (axis, name) in enumerate(zip("xyz", names, strict=True)):
        period = float(time[-1]) / (3.0 + 2.0 * k)
        field_ut = 50.0 * np.sign(np.sin(2.0 * np.pi * time / period + 0.3 * k))
        found[f"mag_{axis}_uT"] = field_ut + rng.normal(0.0, 0.5, time.size)
        found[name] = columns[name] + sensitivity * field_ut
    return found
