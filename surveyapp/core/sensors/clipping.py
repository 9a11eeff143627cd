"""Readings at the end of a sensor's range: found, and left out where a model is fitted.

At the end of its range a sensor says "at least so much". Fitted as if it were a reading, a tenth of
such rows on one axis moves a hard iron by microteslas at a sigma of hundredths.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from surveyapp.domain.columns import pieces
from surveyapp.domain.sensor_log import Array, SensorLog
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import counted, said

CLIPPED_ROWS: Final = 5
CLIPPED_RATIO: Final = 3.0
"""At the end of its range a sensor stays: that often, and that much more than at the next value."""


def ends_of_range(values: Array) -> dict[float, int]:
    """Values at which a column stays, the largest or the smallest of it, and in how many rows."""
    found = {}
    for sign in (1.0, -1.0):
        end = max(float(np.max(sign * piece)) for piece in pieces(values))
        at_end = sum(int(np.count_nonzero(sign * piece == end)) for piece in pieces(values))
        if at_end < CLIPPED_ROWS or at_end == values.size:
            continue
        below = -np.inf
        for piece in pieces(values):
            less = sign * piece
            less = less[less < end]
            below = max(below, float(less.max()) if less.size else -np.inf)
        next_to = sum(int(np.count_nonzero(sign * piece == below)) for piece in pieces(values))
        if at_end > CLIPPED_RATIO * next_to and _readings(values, sign * end) >= CLIPPED_ROWS:
            found[sign * end] = at_end
    return found


def _readings(values: Array, end: float) -> int:
    """Readings at an end: a logger that is faster than its sensor writes each several times.

    A run at the end is as many readings as it is longer than the longest run of another value.
    """
    lengths, held = list[NDArray[np.int64]](), 1
    for piece in pieces(values):
        starts = np.flatnonzero(np.concatenate([[True], piece[1:] != piece[:-1]]))
        runs = np.diff(np.concatenate([starts, [piece.size]]))
        ends = piece[starts] == end
        lengths.append(runs[ends])
        held = max(held, int(np.max(runs[~ends], initial=1)))
    return int(np.sum(-(-np.concatenate(lengths) // held)))


def unclipped_rows(log: SensorLog, names: Sequence[str]) -> np.ndarray | None:
    """Mask of the rows in which none of these columns stands at an end; None where all do not.

    Parameters
    ----------
    log : SensorLog
        ``clipped`` names the columns that were found so while reading.
    names : sequence of str
        Columns that the model needs.
    """
    kept = None
    for name in names:
        if name not in log.clipped:
            continue
        kept = np.ones(log.size, dtype=bool) if kept is None else kept
        for end in ends_of_range(log.columns[name]):
            start = 0
            for piece in pieces(log.columns[name]):
                kept[start : start + piece.size] &= piece != end
                start += piece.size
    return kept


def without_clipped(log: SensorLog, names: Sequence[str], *, most: int | None = None) -> SensorLog:
    """The log without the rows in which one of these columns stands at an end of its range.

    Parameters
    ----------
    log : SensorLog
    names : sequence of str
    most : int, optional
        Thinned to so many rows, as ``SensorLog.thinned`` does.

    Raises
    ------
    SurveyError
        If no row is left.
    """
    kept = unclipped_rows(log, names)
    if kept is None:
        return log if most is None else log.thinned(most)
    count = log.size - int(np.count_nonzero(kept))
    if count == log.size:
        found = ", ".join(name for name in names if name in log.clipped)
        raise SurveyError(
            Problem("every row stands at an end of the range", log.path, found, "readings within")
        )
    text = counted(
        "{count} row at the end of a range is left out",
        "{count} rows at the end of a range are left out",
        count=count,
    )
    warnings = (*log.warnings, ResultWarning("clipped_left_out", text))
    return replace(log, warnings=warnings).chosen(kept, most=most)


def at_an_end(values: Array, rows: np.ndarray | slice) -> tuple[int, float]:
    """How many of these rows stand at an end of the whole column, and at which.

    None does where there is one alone: a sample has to be the largest of the record.
    """
    part = values[rows]
    ends = (float(values.max()), float(values.min()))
    count, end = max((int(np.count_nonzero(part == value)), value) for value in ends)
    return (count, end) if count > 1 else (0, end)


def clipped_problems(
    log: SensorLog, columns: Sequence[str], rows: np.ndarray | slice
) -> list[Problem]:
    """Gyros that stood at the end of their range while they were integrated.

    Parameters
    ----------
    log : SensorLog
    columns : sequence of str
        Of the gyros.
    rows : ndarray of int, or slice
        That are integrated.
    """
    problems = []
    for name in columns:
        if name not in log.clipped:
            continue
        count, end = at_an_end(log.columns[name], rows)
        if count:
            problems.append(
                Problem(
                    said("{name} is saturated", name=name),
                    log.path,
                    said("{rows} rows stand at {end:.6g}", rows=count, end=end),
                    "rates within the range of the gyro",
                    "what it turned beyond is lost: turn more slowly, or choose another range",
                )
            )
    return problems
