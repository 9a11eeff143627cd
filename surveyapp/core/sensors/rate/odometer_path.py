"""Dead reckoning with an odometer: path in half-metre steps and its covariance.

The rows of a drive are walked through piece by piece; only the points of the path are held.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from surveyapp.core.sensors.rate.motion_pieces import PIECE_ROWS
from surveyapp.core.sensors.rate.rests import Rests
from surveyapp.domain.columns import let_go
from surveyapp_models.arrays import Floats

STEP_M = 0.5
ODOMETER_SIGMA = 0.002
"""Relative scale error of a wheel: 2 mm in a metre, a tyre's wear; told with the result."""
POINTS_AT_ONCE = 1 << 14
ROWS_AT_ONCE = 100
"""Rows far apart that are looked at together: a mapped column comes into memory around each."""


@dataclass(frozen=True, slots=True)
class Driven:
    """A drive; its columns may be mapped.

    Parameters
    ----------
    distance : ndarray, shape (n,)
        Of the odometer, never falling [m].
    heading : ndarray, shape (n,)
        Integrated, clockwise [rad].
    known : mapping of int to float
        Row to the heading that was found there, at a stop [rad].
    cycle : ndarray, shape (n,), or None
        Number of the power cycle, NaN for 0; None where the power stayed.
    rests : Rests
    """

    distance: Floats
    heading: Floats
    known: Mapping[int, float]
    cycle: Floats | None
    rests: Rests

    @property
    def size(self) -> int:
        """Rows."""
        return int(self.distance.size)

    def cycles(self, first: int, last: int) -> Floats:
        """Power cycles of the rows first to last (exclusive)."""
        if self.cycle is None:
            return np.zeros(last - first)
        return np.asarray(np.nan_to_num(self.cycle[first:last]))

    def cycle_at(self, row: int) -> float:
        """Power cycle of a row."""
        return float(self.cycles(row, row + 1)[0])

    def distances(self, rows: Sequence[int]) -> Floats:
        """Of rows here and there, shape (k,)."""
        found = np.empty(len(rows))
        for first in range(0, len(rows), ROWS_AT_ONCE):
            few = np.array(rows[first : first + ROWS_AT_ONCE], dtype=np.intp)
            found[first : first + few.size] = self.distance[few]
            let_go(self.distance)
        return found

    def let_go(self) -> None:
        """Give back the memory of what was walked through."""
        for column in (self.distance, self.heading, self.cycle):
            if column is not None:
                let_go(column)


@dataclass(frozen=True, slots=True)
class Reckoned:
    """Points each half metre.

    Parameters
    ----------
    distance : ndarray, shape (m,)
    place : ndarray, shape (m, 2)
        East, north [m].
    covariance : ndarray, shape (m, 2, 2)
    """

    distance: Floats
    place: Floats
    covariance: Floats


def reckon(
    driven: Driven, *, start: tuple[float, float], heading_walk: float, heading_sigma: float
) -> Reckoned:
    """Path of a drive.

    Parameters
    ----------
    driven : Driven
    start : tuple of float
        East, north [m].
    heading_walk : float
        Standard deviation of the heading's drift per square root of a metre [rad].
    heading_sigma : float
        Of the heading at the beginning [rad].
    """
    length = float(driven.distance[-1] - driven.distance[0])
    count = max(math.ceil(length / STEP_M - 1e-9), 1)
    grid = driven.distance[0] + np.minimum(np.arange(count + 1) * STEP_M, length)
    heading = _headings_at(driven, 0.5 * (grid[1:] + grid[:-1]))
    steps = np.diff(grid)[:, None] * np.column_stack([np.sin(heading), np.cos(heading)])
    place = np.vstack([np.zeros(2), np.cumsum(steps, axis=0)]) + np.array(start)
    covariance = _covariance(steps, heading_walk, heading_sigma)
    return Reckoned(grid - driven.distance[0], place, covariance)


def _headings_at(driven: Driven, places: Floats) -> Floats:
    """Heading at rising places along the way, between the rows where the odometer moved, (k,)."""
    found, done = np.empty(places.size), 0
    along, angle = np.array(driven.distance[:1]), np.array(driven.heading[:1])
    before = unwrapped = float(angle[0])
    for begin in range(1, driven.size, PIECE_ROWS):
        part = slice(begin, begin + PIECE_ROWS)
        distance = np.concatenate([along[-1:], driven.distance[part]])
        raw = np.concatenate([[before], driven.heading[part]])
        turned = np.unwrap(raw)[1:] + (unwrapped - before)
        before, unwrapped = float(raw[-1]), float(turned[-1])
        moved = np.diff(distance) > 0.0
        along = np.append(along[-1:], distance[1:][moved])
        angle = np.append(angle[-1:], turned[moved])
        ends = begin + PIECE_ROWS >= driven.size
        stop = places.size if ends else int(np.searchsorted(places, along[-1]))
        found[done:stop] = np.interp(places[done:stop], along, angle)
        done = stop
        driven.let_go()
    return found


def _covariance(steps: Floats, walk: float, begin: float) -> Floats:
    """Of each point: common heading, its random walk, and the odometer's scale, shape (m, 2, 2)."""
    whole = np.vstack([np.zeros(2), np.cumsum(steps, axis=0)])
    found = np.empty((whole.shape[0], 2, 2))
    squares, places = np.zeros((2, 2)), np.zeros(2)
    for first in range(0, whole.shape[0], POINTS_AT_ONCE):
        part = whole[first : first + POINTS_AT_ONCE]
        across = np.column_stack([part[:, 1], -part[:, 0]])
        here = begin**2 * across[:, :, None] * across[:, None, :]
        here += ODOMETER_SIGMA**2 * part[:, :, None] * part[:, None, :]
        if walk > 0.0:
            # a kick before step j turns everything after it: sum over j of (P - P_j)(P - P_j)'
            square = np.einsum("ki,kj->kij", part, part)
            total = np.cumsum(np.concatenate([squares[None], square]), axis=0)
            gone = np.cumsum(np.concatenate([places[None], part]), axis=0)
            count = np.arange(first, first + part.shape[0])[:, None, None]
            cross = part[:, :, None] * gone[:-1, None, :]
            lever = count * square - cross - np.swapaxes(cross, 1, 2) + total[:-1]
            turned = np.array([[0.0, 1.0], [-1.0, 0.0]])
            here += walk**2 * STEP_M * np.einsum("ab,kbc,dc->kad", turned, lever, turned)
            squares, places = total[-1], gone[-1]
        found[first : first + POINTS_AT_ONCE] = here
    return found
