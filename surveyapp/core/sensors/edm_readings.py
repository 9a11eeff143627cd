"""Rows of a baseline record as readings, with their heights and their weather."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Final

import numpy as np

from surveyapp.core.edm import EdmReading
from surveyapp.domain.sensor_log import SensorLog
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import counted, said

PLAUSIBLE: Final = {
    "slope_distance_m": (0.1, 20000.0),
    "temperature_c": (-60.0, 70.0),
    "pressure_hpa": (300.0, 1200.0),
    "humidity_percent": (0.0, 100.0),
}


def edm_readings(
    log: SensorLog, heights: Mapping[str, float] | None
) -> tuple[tuple[EdmReading, ...], bool]:
    """Readings, and whether their heights are known."""
    problems = _impossible(log)
    names = [(a, b) for a, b in zip(log.texts["from_pillar"], log.texts["to_pillar"], strict=True)]
    problems += [
        Problem(
            "a distance from a pillar to itself",
            said("{path}, row {i}", path=log.path, i=i),
            a,
            "two pillars",
        )
        for i, (a, b) in enumerate(names, start=1)
        if a == b or not a or not b
    ]
    levelled = heights is not None or all(
        n in log.columns for n in ("from_height_m", "to_height_m")
    )
    if heights is not None:
        unknown = sorted({name for pair in names for name in pair} - set(heights))
        problems += [
            Problem("the height of a pillar is missing", log.path, name, "a row in the heights")
            for name in unknown
        ]
    if problems:
        raise SurveyError(problems)

    def number(name: str, i: int, default: float) -> float:
        values = log.columns.get(name)
        if values is None or not math.isfinite(values[i]):
            return default
        return float(values[i])

    found = []
    for i, (a, b) in enumerate(names):
        low = heights[a] if heights is not None else number("from_height_m", i, 0.0)
        high = heights[b] if heights is not None else number("to_height_m", i, 0.0)
        standard = EdmReading(a, b, float(log.columns["slope_distance_m"][i]), 0.0, 0.0)
        found.append(
            replace(
                standard,
                start_height_m=low + number("height_of_instrument_m", i, 0.0),
                end_height_m=high + number("height_of_target_m", i, 0.0),
                temperature_c=number("temperature_c", i, standard.temperature_c),
                pressure_hpa=number("pressure_hpa", i, standard.pressure_hpa),
                humidity_percent=number("humidity_percent", i, standard.humidity_percent),
            )
        )
    return tuple(found), levelled


def _impossible(log: SensorLog) -> list[Problem]:
    problems = []
    for name, (low, high) in PLAUSIBLE.items():
        values = log.columns.get(name)
        if values is None:
            continue
        bad = np.flatnonzero(~((values >= low) & (values <= high)) & np.isfinite(values))
        problems += [
            Problem(
                counted(
                    "{name} cannot be right in {count} row",
                    "{name} cannot be right in {count} rows",
                    name=name,
                    count=bad.size,
                ),
                said("{path}, row {row}", path=log.path, row=bad[0] + 1),
                f"{values[bad[0]]:g}",
                said("{low:g} to {high:g}", low=low, high=high),
            )
            for _ in range(min(bad.size, 1))
        ]
    return problems
