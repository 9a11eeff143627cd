"""Clean logs of two rounds on a table that leans: alarms with its axis measured, and as vertical.

``SURVEYAPP_BENCH_RUNS`` records a cell (150).
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from dataclasses import replace
from typing import Any
from unittest.mock import patch

import numpy as np

from bench.rate import as_read
from bench.rate_log_loop import simulated
from surveyapp.core.sensors.rate.table_axis import axis_rate
from surveyapp.core.simulate.rate import recipes
from surveyapp.diagnosis import rate_stops
from surveyapp.diagnosis.engine import diagnose
from surveyapp.domain.sensor_entry import SensorLogEntry
from surveyapp.workflows import rate_case
from surveyapp_models.constants import EARTH_RATE

RUNS = int(os.environ.get("SURVEYAPP_BENCH_RUNS", "150"))
LEANS = (0.0, 0.3, 3.0)
"""Degrees."""
KIND = "six positions, two rounds"


def _vertical(*_: Any, latitude: float) -> tuple[float, bool]:
    """The axis taken for vertical."""
    return EARTH_RATE * math.sin(latitude), True


def alarms(lean_deg: float, *, measured: bool) -> float:
    """Share of clean records in which something is detected."""
    made_unit = recipes.example_unit

    def leaning(*args: Any) -> Any:
        unit = made_unit(*args)
        return replace(unit, table=replace(unit.table, tilt_along=math.radians(lean_deg)))

    entry = SensorLogEntry("log", "rate", "", latitude_deg=math.degrees(recipes.LATITUDE))
    told = 0
    with (
        patch.object(recipes, "example_unit", leaning),
        patch.object(rate_stops, "axis_rate", axis_rate if measured else _vertical),
    ):
        for seed in range(RUNS):
            log = as_read(simulated(KIND, "", np.random.default_rng([seed, 1, 77])))
            made = rate_case.case_of_log(replace(log, path="log"), entry)
            found = diagnose(made.case, advise=False)
            if made.finished is not None:
                found, _ = made.finished(found)
            told += found.verdict != "adequate"
    return told / RUNS


def run() -> Iterator[str]:
    """Every lean both ways."""
    yield f"{RUNS} clean records of two rounds a cell: alarms, axis measured / taken for vertical"
    for lean in LEANS:
        shares = [alarms(lean, measured=measured) for measured in (True, False)]
        yield f"  {lean:g} degrees: {' / '.join(f'{s:.3f}' for s in shares)}"
