"""The case of a rate sensor's log: its stops, at rest or on a table."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from surveyapp.core.sensors.rate.position_log import ACCELEROMETERS, GYROS
from surveyapp.diagnosis.crooked_seats import with_seats
from surveyapp.diagnosis.engine import base_model
from surveyapp.diagnosis.rate_lines import Stretch, with_lines_beside
from surveyapp.diagnosis.rate_stops import LOG_COLUMNS, stops_of
from surveyapp.diagnosis.result import Diagnosis
from surveyapp.diagnosis.subjects.rate import RateTurn, rate_case, seats_of
from surveyapp.domain.sensor_entry import SensorLogEntry
from surveyapp.domain.sensor_log import SensorLog
from surveyapp.io.sensor_logs.reading import LogFile, Need
from surveyapp.workflows.adopted_effects import stop_datum
from surveyapp.workflows.diagnosing_sensor import SensorCase
from surveyapp_models.effects.effect import Effect

Finish = Callable[[Diagnosis], tuple[Diagnosis, dict[str, Any]]]


def case(file: LogFile, entry: SensorLogEntry, own: tuple[Effect, ...]) -> SensorCase:
    """Read the log and make its case."""
    table = file.has("position")
    still = not table and not any(file.has(c) for c in ACCELEROMETERS)
    beside: tuple[str, ...] = ("position",) if table else (() if still else ACCELEROMETERS)
    need = Need(columns=(*GYROS, *beside), varying=GYROS, optional=LOG_COLUMNS, biased=True)
    log = file.read(need)
    return case_of_log(log, entry, own)


def case_of_log(log: SensorLog, entry: SensorLogEntry, own: tuple[Effect, ...] = ()) -> SensorCase:
    """The case of a log that was read.

    Raises
    ------
    SurveyError
    """
    latitude = None if entry.latitude_deg is None else math.radians(entry.latitude_deg)
    stops, turns, told = stops_of(log, latitude=latitude)
    stretches = [
        Stretch(*stop.rows, 0.0 if stop.known is None else float(np.abs(stop.known).max()))
        for stop in stops
        if stop.rows is not None
    ]
    made = rate_case(stops, turns, identity=entry.id, extra=own)
    seats, seated = None if turns else seats_of(stops), None
    if seats is not None:
        seated = partial(with_seats, seats=seats, before=base_model(made))
        made = rate_case(stops, turns, identity=entry.id, extra=own, seats=seats)
        # beside crooked seats, which are named, anything is a further effect
        made = replace(made, levels=replace(made.levels, first=made.levels.further))
    lines = partial(
        with_lines_beside,
        log=log,
        columns=dict(zip("xyz", GYROS, strict=True)),
        stretches=stretches,
        datum=stop_datum(stops, made.columns),
    )
    return SensorCase(
        made,
        (*log.warnings, *told),
        {"stops": len(stops), "turns": len(turns)},
        partial(_directions, turns=turns) if turns else None,
        partial(_finished, lines=lines, seated=seated),
        log.sha256 or "",
    )


def _finished(
    found: Diagnosis, *, lines: Finish, seated: Callable[[Diagnosis], Diagnosis] | None
) -> tuple[Diagnosis, dict[str, Any]]:
    """The diagnosis with the lines of its samples, and with the seats that its base model holds."""
    found, keys = lines(found)
    return (found if seated is None else seated(found)), keys


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
