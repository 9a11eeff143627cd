"""What a growing log holds of a programme: stretches with their turns, stops, phases."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from typing import Final

import numpy as np

from surveyapp.core.sensors.programmes.catalogue import NODES_C
from surveyapp.core.sensors.rate.multi_position_log import held_stops
from surveyapp.core.sensors.rate.position_log import ACCELEROMETERS, GYROS, place_problems
from surveyapp.core.sensors.rate.rotation import PHASES
from surveyapp.core.sensors.rate.table_log import label, motion_of, stretches_of
from surveyapp.core.sensors.rate.temperature_log import CHAMBER
from surveyapp.core.sensors.rate.turning import Steady
from surveyapp.domain.programme import Row
from surveyapp.domain.sensor_log import SensorLog
from surveyapp.errors import Problem, SurveyError

NODE_WITHIN_C: Final = 2.5
"""A chamber temperature belongs to the nearest node of the programme up to this distance."""

NEEDED: Final[Mapping[str, tuple[tuple[str, ...], tuple[str, ...]]]] = {
    "fog-station": (
        ("gyr_x_rad_s",),
        ("table_rate_deg_s", "table_angle_deg", "pass", "set", "vertical_circle_deg"),
    ),
    "six-position": ((*GYROS, "position"), ("table_rate_deg_s", "table_angle_deg", "round")),
    "temperature": (
        (*GYROS, "position", CHAMBER),
        ("table_rate_deg_s", "table_angle_deg", "round"),
    ),
    "multi-position": ((*GYROS, *ACCELEROMETERS), ()),
    "rotation": ((*GYROS, *ACCELEROMETERS, "phase"), ()),
}
"""Programme to the columns that its log must have, and those that are used where they are there."""


def rows_of_log(programme: str, log: SensorLog) -> list[Row]:
    """Rows of a programme that a log holds so far.

    Parameters
    ----------
    programme : str
        Id.
    log : SensorLog

    Raises
    ------
    SurveyError
        If the log does not say how the table turned, or names positions that are none.
    """
    return SEEN[programme](log)


def _stretches(log: SensorLog, labels: Sequence[str]) -> list[Steady]:
    motion = motion_of(log)
    if isinstance(motion, Problem):
        raise SurveyError(motion)
    return [s for s in stretches_of(log, motion, labels) if s.rate != 0.0]


def _turn(stretch: Steady) -> dict[str, float | str]:
    return {"sense": math.copysign(1.0, stretch.rate), "turns": stretch.turns}


def _fog_station(log: SensorLog) -> list[Row]:
    circle = log.columns.get("vertical_circle_deg")
    read = circle is not None and bool(np.isfinite(circle).any())
    return [
        {**_turn(s), "pass": float(label(log, "pass", s.start, 1)), "circle": float(read)}
        for s in _stretches(log, ("set", "pass"))
    ]


def _positions(log: SensorLog) -> list[Row]:
    problems = place_problems(log)
    if problems:
        raise SurveyError(problems)
    words = log.texts["position"]
    return [
        {**_turn(s), "position": words[s.start]}
        for s in _stretches(log, ("position", "round"))
        if words[s.start]
    ]


def _temperature(log: SensorLog) -> list[Row]:
    problems = place_problems(log)
    if problems:
        raise SurveyError(problems)
    words, chamber = log.texts["position"], log.columns[CHAMBER]
    found: list[Row] = []
    for stretch in _stretches(log, ("position", CHAMBER)):
        at = float(chamber[stretch.start])
        node = min(NODES_C, key=lambda known: abs(known - at))
        word = words[stretch.start]
        if word and abs(node - at) <= NODE_WITHIN_C:
            found.append({**_turn(stretch), "position": f"{word[0]}+", "temperature_c": node})
    return found


def _stops(log: SensorLog) -> list[Row]:
    stops = held_stops(log)
    rate = np.column_stack([log.columns[c] for c in GYROS])
    bias = np.mean([s.rate for s in stops], axis=0) if stops else np.zeros(3)
    interval = 1.0 / (log.rate_hz or 100.0)
    found: list[Row] = []
    for index, stop in enumerate(stops):
        up = stop.force / float(np.linalg.norm(stop.force))
        row: dict[str, float | str] = {"stop": float(index + 1), "at_s": stop.time_s}
        row |= {axis: float(up[i]) for i, axis in enumerate("xyz")}
        found.append(row)
    for index, (one, other) in enumerate(pairwise(stops), start=1):
        turn = (rate[one.stop : other.start] - bias).sum(axis=0) * interval
        found[index] = found[index] | {
            f"turn_{axis}": float(turn[i]) for i, axis in enumerate("xyz")
        }  # type: ignore[operator]
    return found


def _phases(log: SensorLog) -> list[Row]:
    words = np.array([word.strip() for word in log.texts["phase"]])
    interval = 1.0 / (log.rate_hz or 100.0)
    return [
        {"phase": phase, "seconds": float(np.count_nonzero(words == phase)) * interval}
        for phase in PHASES
        if np.any(words == phase)
    ]


SEEN: Final[Mapping[str, Callable[[SensorLog], list[Row]]]] = {
    "fog-station": _fog_station,
    "six-position": _positions,
    "temperature": _temperature,
    "multi-position": _stops,
    "rotation": _phases,
}
"""Programme to what is looked for in its log."""
