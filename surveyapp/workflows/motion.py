"""``motion``: what is read of a log, and the options checked."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Final

import numpy as np

from surveyapp.core.sensors.rate.motion_log import (
    NEEDED,
    OPTIONAL,
    MotionOptions,
    judge_motion,
)
from surveyapp.domain.advance import PartDone
from surveyapp.domain.columns import pieces, span
from surveyapp.domain.motion import Motion
from surveyapp.domain.sensor_entry import SensorLogEntry
from surveyapp.domain.sensor_log import SensorLog
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.sensor_logs.blocks import room_for
from surveyapp.io.sensor_logs.reading import LogFile, Need
from surveyapp.languages import listed, said
from surveyapp.workflows.adopted_effects import read_without_adopted

LONGEST_PATH_M: Final = 1e6
"""Of the odometer in one record."""

SMALLEST_ALARM: Final = 1e-9
"""Of a rest; quantiles nearer to 1 are not to be had in a float."""

PROGRAMME: Final = "motion"
"""``programme`` of a log whose motion the record tells."""

OF_ENTRY: Final = {
    "false_alarm": "false_alarm",
    "path": "path",
    "from": "begin",
    "to": "end",
    "snap": "snap",
    "snap_power_cycle": "snap_power_cycle",
    "still_gate_factor": "still_gate_factor",
}
"""Keys of a ``[[sensor_log]]``, and the options that they are."""


def options_of(entry: SensorLogEntry | None, given: Mapping[str, object]) -> dict[str, object]:
    """What the entry of a log states, and over it what is given."""
    stated = {} if entry is None else entry.options
    own = {option: stated[key] for key, option in OF_ENTRY.items() if key in stated}
    return own | {name: value for name, value in given.items() if value is not None}


def find_motion(
    file: LogFile,
    options: Mapping[str, object],
    *,
    entry: SensorLogEntry | None = None,
    progress: PartDone | None = None,
) -> Motion:
    """Read a record, without effects that were adopted for it, and judge its motion.

    Raises
    ------
    SurveyError
    """
    problems: list[Problem] = []
    asked = motion_options(options, problems)
    try:
        need = Need(columns=NEEDED, varying=NEEDED, optional=OPTIONAL)
        log = read_without_adopted(file, need, entry, progress=progress)
    except SurveyError as error:
        raise SurveyError([*problems, *error.problems]) from None
    if asked.path or asked.snap:
        problems += _odometer_problems(log)
    if problems:
        raise SurveyError(problems)
    found = judge_motion(log, asked, room=partial(room_for, beside=len(log.columns)))
    return replace(found, warnings=(*found.warnings, *_not_asked(asked, options)))


def _not_asked(asked: MotionOptions, options: Mapping[str, object]) -> list[ResultWarning]:
    """Options of a path that nobody asked for."""
    if asked.path or asked.snap:
        return []
    names = {"begin": "--from", "end": "--to", "snap_power_cycle": "--snap-power-cycle"}
    idle = [option for name, option in names.items() if options.get(name) is not None]
    if not idle:
        return []
    text = said(
        "without --path nothing asks for {options}: it was not looked at", options=listed(idle)
    )
    return [ResultWarning("option_not_used", text)]


def _odometer_problems(log: SensorLog) -> list[Problem]:
    """A path of half-metre steps needs a reading in each row, and a length that a drive has."""
    distance = log.columns.get("odometer_m")
    if distance is None or not distance.size:
        return []
    empty = sum(int(np.count_nonzero(~np.isfinite(piece))) for piece in pieces(distance))
    if empty:
        what, expected = "odometer_m has rows without a reading", "a number in each row"
        return [
            Problem(
                what,
                log.path,
                said("{rows} rows", rows=empty),
                expected,
            )
        ]
    length = span(distance)
    if length > LONGEST_PATH_M:
        found, expected = (
            f"{length:g} m",
            said("{longest_path_m:g} m or less", longest_path_m=LONGEST_PATH_M),
        )
        return [Problem("no vehicle drives as far in one record", log.path, found, expected)]
    return []


def motion_options(options: Mapping[str, object], problems: list[Problem]) -> MotionOptions:
    """Options of the command line; what is wrong goes to ``problems``."""
    alarm = _number(options, "false_alarm", 0.01, problems)
    if not SMALLEST_ALARM <= alarm < 0.5:
        expected = said("{smallest_alarm:g} to 0.5", smallest_alarm=SMALLEST_ALARM)
        problems.append(Problem("this is no probability", "false_alarm", f"{alarm:g}", expected))
    factor = _number(options, "still_gate_factor", 1.0, problems)
    if not factor > 0.0 or not math.isfinite(factor):
        where = "still_gate_factor"
        problems.append(Problem("this is no factor", where, f"{factor:g}", "above 0"))
    cycle = str(options.get("snap_power_cycle") or "current")
    if cycle not in ("previous", "current"):
        expected = "previous or current"
        problems.append(Problem("there is no such cycle", "snap_power_cycle", cycle, expected))
    begin = _numbers(options.get("begin"), "from", 3, problems)
    end = _numbers(options.get("end"), "to", 2, problems)
    return MotionOptions(
        false_alarm=alarm,
        still_gate_factor=factor,
        path=_flag(options, "path", problems),
        begin=None if begin is None else (begin[0], begin[1], math.radians(begin[2])),
        end=None if end is None else (end[0], end[1]),
        snap=_flag(options, "snap", problems),
        power_cycle="previous" if cycle == "previous" else "current",
    )


def _number(
    options: Mapping[str, object], name: str, default: float, problems: list[Problem]
) -> float:
    value = options.get(name)
    if value is None:
        return default
    if isinstance(value, bool) or not isinstance(value, int | float):
        problems.append(Problem("this is no number", name, str(value), "a number"))
        return default
    return float(value)


def _flag(options: Mapping[str, object], name: str, problems: list[Problem]) -> bool:
    value = options.get(name)
    if value is not None and not isinstance(value, bool):
        problems.append(Problem("this is neither true nor false", name, str(value), "true, false"))
    return value is True


def _numbers(
    value: object, where: str, count: int, problems: list[Problem]
) -> tuple[float, ...] | None:
    if value is None:
        return None
    parts = value if isinstance(value, list | tuple) else str(value).split(",")
    try:
        found = tuple(float(part) for part in parts)
    except (TypeError, ValueError):
        found = ()
    if len(found) != count or not all(math.isfinite(v) for v in found):
        expected = "E,N,AZIMUTH in metres and degrees" if count == 3 else "E,N in metres"
        problems.append(Problem("this is no place", where, str(value), expected))
        return None
    return found
