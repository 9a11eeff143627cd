"""The case of a total station's gyro on a table: each way of each set, and its samples' lines."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial

import numpy as np

from surveyapp.core.sensors.rate.fog_station_log import GYRO, NEEDED, OPTIONAL, turned_sets
from surveyapp.diagnosis.rate_lines import Stretch, with_lines_beside
from surveyapp.diagnosis.subjects.fog_station import FogTurn, fog_case
from surveyapp.diagnosis.subjects.rate import LEVELS
from surveyapp.domain.sensor_entry import SensorLogEntry
from surveyapp.domain.sensor_log import SensorLog
from surveyapp.io.sensor_logs.reading import LogFile, Need
from surveyapp.workflows.adopted_effects import fog_datum
from surveyapp.workflows.diagnosing_sensor import SensorCase
from surveyapp_models.effects.effect import Effect


def case(file: LogFile, entry: SensorLogEntry, own: tuple[Effect, ...]) -> SensorCase:
    """Read the log and make its case."""
    log = file.read(Need(columns=NEEDED, varying=NEEDED, optional=OPTIONAL, biased=True))
    return case_of_log(log, entry, own)


def case_of_log(log: SensorLog, entry: SensorLogEntry, own: tuple[Effect, ...] = ()) -> SensorCase:
    """The case of a log that was read.

    Raises
    ------
    SurveyError
    """
    sets, warnings = turned_sets(log, [])
    time, values = log.columns["time_s"], log.columns[GYRO]
    warmth = log.columns.get("temperature_c")
    turns = []
    for (pass_id, set_id), turned in sets.items():
        for item in turned:
            first, last = item.stretch.start, item.stretch.stop
            here = None if warmth is None else float(np.mean(warmth[first:last]))
            turns.append(
                FogTurn(
                    output=item.mean(values).mean,
                    rate=-item.rate,
                    set_id=set_id,
                    pass_id=pass_id,
                    elapsed_s=float(np.mean(time[first:last])),
                    temperature_c=here if here is not None and math.isfinite(here) else None,
                    rows=(first, last),
                )
            )
    stretches = [Stretch(*turn.rows, abs(turn.rate)) for turn in turns]
    lines = partial(
        with_lines_beside, log=log, columns={"x": GYRO}, stretches=stretches, datum=fog_datum(log)
    )
    return SensorCase(
        replace(fog_case(turns, identity=entry.id, extra=own), levels=LEVELS),
        (*log.warnings, *warnings),
        {"sets": len(sets)},
        None,
        lines,
        log.sha256 or "",
    )
