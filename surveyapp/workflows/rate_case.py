"""The case of a rate sensor's log: its stops, at rest or on a table."""

from __future__ import annotations

import math
from functools import partial
from typing import Any

import numpy as np

from surveyapp.core.sensors.rate.position_log import ACCELEROMETERS, GYROS
from surveyapp.diagnosis.rate_lines import (
    Stretch,
    interference_dict,
    judge_lines,
    with_lines_of,
)
from surveyapp.diagnosis.rate_stops import stops_of
from surveyapp.diagnosis.result import Diagnosis
from surveyapp.diagnosis.subjects.rate import RateTurn, rate_case
from surveyapp.domain.project import ResultWarning
from surveyapp.domain.sensor_entry import SensorLogEntry
from surveyapp.io.sensor_logs.reading import LogFile, Need
from surveyapp.workflows.diagnosing_sensor import SensorCase
from surveyapp_models.effects.effect import Effect

OPTIONAL = (
    "table_rate_deg_s",
    "table_angle_deg",
    "round",
    "temperature_c",
    "mag_x_uT",
    "mag_y_uT",
    "mag_z_uT",
)


def case(file: LogFile, entry: SensorLogEntry, own: tuple[Effect, ...]) -> SensorCase:
    """Read the log and make its case."""
    table = file.has("position")
    columns = (*GYROS, "position") if table else (*GYROS, *ACCELEROMETERS)
    optional = (*OPTIONAL, *ACCELEROMETERS)
    log = file.read(Need(columns=columns, varying=GYROS, optional=optional, biased=True))
    latitude = None if entry.latitude_deg is None else math.radians(entry.latitude_deg)
    stops, turns, told = stops_of(log, latitude=latitude)
    warnings = list(log.warnings)
    if told:
        warnings.append(ResultWarning("latitude_unknown", told))
    stretches = [
        Stretch(*stop.rows, 0.0 if stop.known is None else float(np.abs(stop.known).max()))
        for stop in stops
        if stop.rows is not None
    ]
    lines = judge_lines(
        log.columns["time_s"], [log.columns[c] for c in GYROS], stretches, ("x", "y", "z")
    )
    return SensorCase(
        rate_case(stops, turns, identity=entry.id, extra=own),
        tuple(warnings),
        {"stops": len(stops), "turns": len(turns), **interference_dict(lines)},
        partial(_directions, turns=turns) if turns else None,
        partial(with_lines_of, judged=lines),
    )


def _directions(diagnosis: Diagnosis, *, turns: list[RateTurn]) -> dict[str, Any]:
    """How far gravity is missed after a turn, by the base model and by the best one, rms."""
    times = np.repeat([turn.duration_s for turn in turns], 2)

    def missed(residuals: tuple[float, ...]) -> float:
        angles = np.array(residuals[-times.size :]) * times
        return math.degrees(math.sqrt(float(np.sum(angles**2)) / len(turns)))

    return {
        "gravity_direction": {
            "before_deg": missed(diagnosis.residuals_before),
            "after_deg": missed(diagnosis.residuals_best),
            "turns": len(turns),
        }
    }
