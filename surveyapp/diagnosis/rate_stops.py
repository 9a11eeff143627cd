"""The stops of a rate sensor's log as the engine takes them: a rest, or whole turns of a table."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from surveyapp.core.sensors.rate.hand_forces import ForceModel
from surveyapp.core.sensors.rate.hand_held import HeldStop, fit_rates, turn_rows
from surveyapp.core.sensors.rate.hand_parameters import LEAST_TURNS
from surveyapp.core.sensors.rate.held_turns import ACCELEROMETERS, rest_rates, turns_between
from surveyapp.core.sensors.rate.multi_position_log import (
    LEAST_STOPS,
    MultiPositionOptions,
    force_model,
    held_stops,
)
from surveyapp.core.sensors.rate.position_log import (
    GYROS,
    Placed,
    means_of,
    place_problems,
    placed_stretches,
    sense_of,
)
from surveyapp.core.sensors.rate.table_axis import axis_rate
from surveyapp.core.sensors.rate.table_log import Turned, label, motion_of
from surveyapp.core.sensors.rate.temperature_log import CHAMBER, node_numbers
from surveyapp.core.sensors.rate.turn_axes import axes_problems
from surveyapp.diagnosis.subjects.rate import RateStop, RateTurn
from surveyapp.domain.sensor_log import STANDARD_GRAVITY_M_S2, SensorLog
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said
from surveyapp_models.arrays import Floats
from surveyapp_models.rate.turntable import POSITIONS

FIELDS = ("mag_x_uT", "mag_y_uT", "mag_z_uT")
LOG_COLUMNS = (
    *GYROS,
    *ACCELEROMETERS,
    *FIELDS,
    "position",
    "table_rate_deg_s",
    "table_angle_deg",
    "round",
    "temperature_c",
    CHAMBER,
)
"""Columns of a log from which its stops are made, as far as it has them."""
TESLA = 1e-6
AT_REST = 0.9
"""Share of a record above which one rest is all of it."""
MOVED = math.radians(1.0)
"""Between means of parts: without accelerometers more is motion [rad/s]."""
BLOCKS = 40
"""Parts of a record at rest: as many as a drift and a walk need to be told apart, and quickly."""
LEAST_BLOCKS = 12
LEAST_BLOCK_ROWS = 10


def stops_of(
    log: SensorLog, *, latitude: float | None
) -> tuple[list[RateStop], list[RateTurn], tuple[ResultWarning, ...]]:
    """Stops of a log, the turns between them, and what is to be said of them.

    A record that never moves has no stops: its blocks take their place.

    Parameters
    ----------
    log : SensorLog
    latitude : float or None
        [rad]

    Raises
    ------
    SurveyError
    """
    if "position" in log.texts:
        on_table = _table_stops(log, latitude)
        return on_table, [], _axis_unknown(on_table, latitude)
    told: tuple[ResultWarning, ...] = ()
    if latitude is None:
        text = (
            "the latitude is not known: the vertical earth rate stays in the stops and looks like "
            "a sensitivity to gravity"
        )
        told = (ResultWarning("latitude_unknown", text),)
    rests = held_stops(log) if log.has(*ACCELEROMETERS) else []
    if len(rests) < LEAST_STOPS:
        spans = [(s.start, s.stop) for s in rests] if rests else _unmoved(log)
        quiet = sum(last - first for first, last in spans) > AT_REST * log.size
        if quiet and not _moves(log):
            blocks = _rest_blocks(log, spans)
            return blocks, [], (_one_rest(blocks),)
    return *_held_stops(log, latitude, rests), told


def _rest_blocks(log: SensorLog, spans: Sequence[tuple[int, int]]) -> list[RateStop]:
    """Means of equal parts of a record at rest, each as a stop.

    Raises
    ------
    SurveyError
        If there are too few samples.
    """
    rows = sum(last - first for first, last in spans)
    length = max(rows // BLOCKS, LEAST_BLOCK_ROWS)
    parts = [
        (k, k + length) for first, last in spans for k in range(first, last - length + 1, length)
    ]
    if len(parts) < LEAST_BLOCKS:
        expected = said("{rows} or more", rows=LEAST_BLOCKS * LEAST_BLOCK_ROWS)
        raise SurveyError(
            Problem("the record at rest is too short to diagnose", log.path, str(rows), expected)
        )
    columns = np.column_stack([log.columns[c] for c in GYROS])
    return [
        RateStop(
            output=columns[first:last].mean(axis=0),
            elapsed_s=float(np.mean(log.columns["time_s"][first:last])),
            temperature_c=_mean(log, "temperature_c", first, last),
            field=_field(log, first, last),
            label=f"block {k + 1}",
            rows=(first, last),
        )
        for k, (first, last) in enumerate(parts)
    ]


def _one_rest(blocks: Sequence[RateStop]) -> ResultWarning:
    """That the record is one rest, and what takes the place of stops."""
    text = said(
        "the record is one rest: the means of {count} blocks of {seconds:.3g} s take the place of "
        "stops, and the earth rate stays in the biases",
        count=len(blocks),
        seconds=blocks[1].elapsed_s - blocks[0].elapsed_s,
    )
    return ResultWarning("one_rest", text)


def _unmoved(log: SensorLog) -> list[tuple[int, int]]:
    """The whole record where there is no accelerometer to tell rest from motion."""
    return [] if log.has(*ACCELEROMETERS) else [(0, log.size)]


def _moves(log: SensorLog) -> bool:
    """Whether a gyro shows motion: a smooth drive is as quiet to accelerometers as a rest."""
    count = max(log.size // BLOCKS, 1)
    wholes = [log.columns[name][: log.size - log.size % count] for name in GYROS]
    return any(float(np.ptp(w.reshape(-1, count).mean(axis=1))) > MOVED for w in wholes)


def _held_stops(
    log: SensorLog, latitude: float | None, stops: Sequence[HeldStop]
) -> tuple[list[RateStop], list[RateTurn]]:
    if len(stops) < LEAST_STOPS:
        raise SurveyError(
            Problem(
                "too few stops at rest to diagnose",
                log.path,
                said("{size} stops as quiet as the record can be", size=len(stops)),
                said("{least_stops} or more", least_stops=LEAST_STOPS),
            )
        )
    forces = np.array([s.force for s in stops])
    model = force_model(forces, MultiPositionOptions(latitude))
    true = model.corrected(forces)
    ups = true / np.linalg.norm(true, axis=1)[:, None]
    rates = rest_rates(stops, ups, latitude)
    found = [
        RateStop(
            output=rates[k],
            elapsed_s=stop.time_s,
            force=true[k],
            temperature_c=_mean(log, "temperature_c", stop.start, stop.stop),
            field=_field(log, stop.start, stop.stop),
            label=f"stop {k + 1}",
            rows=(stop.start, stop.stop),
        )
        for k, stop in enumerate(stops)
    ]
    return found, _turned(log, stops, model, latitude)


def _turned(
    log: SensorLog, stops: Sequence[HeldStop], model: ForceModel, latitude: float | None
) -> list[RateTurn]:
    """The turns between the stops, where there are enough for the gyros' own elements."""
    turns = turns_between(log, stops, model, latitude)
    problems = axes_problems(turns, log.path)
    if problems:
        raise SurveyError(problems)
    if len(turns) < LEAST_TURNS:
        return []
    inverse = fit_rates(turns).matrix
    force = np.column_stack([log.columns[c] for c in ACCELEROMETERS])
    rests = model.corrected(np.array([s.force for s in stops]))
    found = []
    for turn in turns:
        k = turn.leaves
        first, last = stops[k].stop, stops[k + 1].start
        rows = turn_rows(
            turn,
            inverse,
            forces=model.corrected(force[first:last]),
            rest=0.5 * (rests[k] + rests[k + 1]),
        )
        middle = float(log.columns["time_s"][(first + last) // 2])
        warmth = _mean(log, "temperature_c", first, last)
        lasts = turn.rates.shape[0] * turn.interval_s
        found.append(RateTurn(rows, middle, lasts, warmth, f"turn {k + 1}"))
    return found


def _table_stops(log: SensorLog, latitude: float | None) -> list[RateStop]:
    problems = place_problems(log)
    motion = motion_of(log)
    if isinstance(motion, Problem):
        raise SurveyError([*problems, motion])
    groups, labels = [label(log, "round", k, 1) for k in range(log.size)], ("position", "round")
    chamber = CHAMBER in log.columns and node_numbers(log.columns[CHAMBER])[0].size > 1
    if chamber:
        numbers = node_numbers(log.columns[CHAMBER])[1]
        groups, labels = [number + 1 for number in numbers], ("position", CHAMBER)
    placed, more = placed_stretches(log, motion, groups, labels)
    problems += more
    if problems:
        raise SurveyError(problems)
    _, warnings, wrong = sense_of(means_of(log, placed), where=log.path)
    if wrong:
        raise SurveyError(wrong)
    sense = -1.0 if warnings else 1.0
    columns = [log.columns[c] for c in GYROS]
    found = []
    for place in placed:
        axis = "xyz".index(place.position[0])
        along = np.zeros(3)
        along[axis] = 1.0 if place.position[1] == "+" else -1.0
        earth, measured = 0.0, False
        if latitude is not None:
            earth, measured = axis_rate(log, place.turned, axis, latitude=latitude)
        for item in place.turned:
            first, last = item.stretch.start, item.stretch.stop
            found.append(
                RateStop(
                    output=np.array([item.mean(c).mean for c in columns]),
                    elapsed_s=float(np.mean(log.columns["time_s"][first:last])),
                    force=along * STANDARD_GRAVITY_M_S2,
                    known=along * (earth - sense * item.rate),
                    lean=None if measured else along,
                    place=POSITIONS.index(place.position) + 1 + 6 * (place.group - 1),
                    temperature_c=_mean(log, "temperature_c", first, last),
                    field=_field(log, first, last),
                    label=_table_label(place, item),
                    rows=(first, last),
                    node=place.group if chamber else None,
                )
            )
    return sorted(found, key=lambda stop: stop.elapsed_s)


def _axis_unknown(stops: Sequence[RateStop], latitude: float | None) -> tuple[ResultWarning, ...]:
    """That the earth's rate along the table's axis is not known, and what that costs."""
    if all(stop.lean is None for stop in stops):
        return ()
    text = (
        "without accelerometers over whole turns the lean of the table is not known: the earth "
        "rate along its axis is left free, and a sensitivity to gravity cannot be told from it"
    )
    if latitude is not None:
        return (ResultWarning("table_lean_unknown", text),)
    text = (
        "the latitude is not known: the earth rate along the table's axis is left free, and a "
        "sensitivity to gravity cannot be told from it"
    )
    return (ResultWarning("latitude_unknown", text),)


def _table_label(place: Placed, item: Turned) -> str:
    """Position, round or node where there are several, and the way."""
    group = f" {place.group}" if place.group > 1 else ""
    return f"{place.position}{group} {'clockwise' if item.rate > 0 else 'back'}"


def _mean(log: SensorLog, name: str, first: int, last: int) -> float | None:
    if name not in log.columns:
        return None
    value = float(np.mean(log.columns[name][first:last]))
    return value if math.isfinite(value) else None


def _field(log: SensorLog, first: int, last: int) -> Floats | None:
    if not log.has(*FIELDS):
        return None
    return np.array([float(np.mean(log.columns[c][first:last])) for c in FIELDS]) * TESLA
