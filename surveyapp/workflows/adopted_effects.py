"""Effects that were adopted for a log: taken out of it, or told wherever they are not."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from surveyapp.core.sensors.rate.adopted import (
    AT_STOPS,
    NO_STOPS,
    StopDatum,
    columns_needed,
    without_effects,
)
from surveyapp.core.sensors.rate.fog_station_log import GYRO, turned_sets
from surveyapp.core.sensors.rate.fog_station_log import OPTIONAL as FOG_COLUMNS
from surveyapp.domain.advance import PartDone
from surveyapp.domain.instrument import AdoptedEffect
from surveyapp.domain.sensor_entry import SensorLogEntry
from surveyapp.domain.sensor_log import SensorLog
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import SurveyError
from surveyapp.io.sensor_logs.reading import LogFile, Need
from surveyapp.languages import said

if TYPE_CHECKING:
    from surveyapp.diagnosis.subjects.rate import RateStop
    from surveyapp_models.effects.effect import Columns


def left_in(entry: SensorLogEntry | None) -> tuple[ResultWarning, ...]:
    """That a result is of the log as it was read, the effects adopted for it included."""
    if entry is None or not entry.effects:
        return ()
    names = ", ".join(dict.fromkeys(effect.id for effect in entry.effects))
    text = said(
        "adopted for this log and left in: {names}; noise is that of the log as it was read",
        names=names,
    )
    return (ResultWarning("adopted_not_applied", text),)


def need_with_adopted(need: Need, entry: SensorLogEntry | None) -> Need:
    """A need with the columns that the adopted effects of the log take."""
    if entry is None or not entry.effects or need.optional is None:
        return need
    more = [c for c in columns_needed(entry.effects) if c not in need.columns]
    return replace(need, optional=tuple(dict.fromkeys((*need.optional, *more))))


def read_without_adopted(
    file: LogFile, need: Need, entry: SensorLogEntry | None, *, progress: PartDone | None = None
) -> SensorLog:
    """A log of any kind read for a command, without the effects that were adopted for it.

    Beside what the command needs, the columns are read in which the diagnosis found the stops.

    Raises
    ------
    SurveyError
    """
    if entry is None or not entry.effects:
        return file.read(need, progress=progress)
    if entry.kind in ("compass", "tilt"):
        from surveyapp.core.sensors.adopted_effects import EVENT_COLUMNS, without_events

        log = file.read(_beside(need, EVENT_COLUMNS), progress=progress)
        log, told = without_events(log, entry.effects)
        return replace(log, warnings=(*log.warnings, *told))
    from surveyapp.diagnosis.rate_stops import LOG_COLUMNS

    wanted = (GYRO, *FOG_COLUMNS) if entry.kind == "fog-station" else LOG_COLUMNS
    log = file.read(replace(_beside(need, wanted), biased=True), progress=progress)
    return without_adopted(log, entry)


def _beside(need: Need, columns: Sequence[str]) -> Need:
    return replace(need, optional=tuple(dict.fromkeys((*(need.optional or ()), *columns))))


def without_adopted(
    log: SensorLog, entry: SensorLogEntry | None, *, estimated: Collection[str] = ()
) -> SensorLog:
    """The log of a rate sensor without its adopted effects; what was done is in its warnings.

    Parameters
    ----------
    log : SensorLog
    entry : SensorLogEntry or None
    estimated : collection of str
        Effects that the command estimates itself: left to it, and told.
    """
    if entry is None or not entry.effects:
        return log
    left = [e for e in entry.effects if e.id in estimated]
    used = [e for e in entry.effects if e.id not in estimated]
    told = [
        ResultWarning(
            "adopted_not_applied",
            said("{id} belongs to the sensor and is left to its calibration", id=effect.id),
        )
        for effect in left
    ]
    try:
        log, more = _taken_out(log, entry, used)
    except SurveyError as error:
        text = said(
            "adopted effects are not taken out, the stops of the diagnosis are not found again: "
            "{what}",
            what=error.problems[0].what,
        )
        more = (ResultWarning("adopted_not_applied", text),)
    return replace(log, warnings=(*log.warnings, *told, *more))


def _taken_out(
    log: SensorLog, entry: SensorLogEntry, effects: Sequence[AdoptedEffect]
) -> tuple[SensorLog, tuple[ResultWarning, ...]]:
    if not any(effect.id in AT_STOPS for effect in effects):
        return without_effects(log, effects, NO_STOPS)
    datum = fog_datum(log) if entry.kind == "fog-station" else _rate_datum(log, entry)
    return without_effects(log, effects, datum)


def _rate_datum(log: SensorLog, entry: SensorLogEntry) -> StopDatum:
    """Stops and turns as the diagnosis of this log had them."""
    from surveyapp.diagnosis.rate_stops import stops_of
    from surveyapp.diagnosis.subjects.rate import rate_case

    latitude = None if entry.latitude_deg is None else math.radians(entry.latitude_deg)
    stops, turns, _ = stops_of(log, latitude=latitude)
    return stop_datum(stops, rate_case(stops, turns, identity=entry.id).columns)


def stop_datum(stops: Sequence[RateStop], columns: Columns) -> StopDatum:
    """Where the stops of a case lie, and the state at which its effects are zero.

    Parameters
    ----------
    stops : sequence of RateStop
    columns : mapping
        Of the case that they make.
    """
    warmth = columns.get("temperature_c")
    return StopDatum(
        rows=tuple(stop.rows for stop in stops if stop.rows is not None),
        middle_s=stops[0].elapsed_s + float(np.mean(columns["elapsed_s"])),
        temperature_c=None if warmth is None else float(np.mean(warmth)),
        table=any(stop.known is not None for stop in stops),
    )


def fog_datum(log: SensorLog) -> StopDatum:
    """Turns of a total station's gyro in the order of the diagnosis, and their middle."""
    sets, _ = turned_sets(log, [])
    spans = [(item.stretch.start, item.stretch.stop) for turned in sets.values() for item in turned]
    time = log.columns["time_s"]
    spans.sort(key=lambda span: float(np.mean(time[slice(*span)])))
    warmth = log.columns.get("temperature_c")
    return StopDatum(
        rows=tuple(spans),
        middle_s=float(np.mean([np.mean(time[slice(*s)]) for s in spans])),
        temperature_c=None
        if warmth is None
        else float(np.mean([np.mean(warmth[slice(*s)]) for s in spans])),
        table=True,
    )
