"""Dead reckoning with an odometer: path in half-metre steps, its covariance, and snapping.

Between stops the heading drifts; where it is known again (a heading found at a stop, or the point
at which the path ends), the drift is laid back linearly over what was driven since the stop before.
After a power cycle the heading is off by a constant, and so is the correction.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from surveyapp.domain.motion import Snapped
from surveyapp_models.angles import wrap_pi
from surveyapp_models.arrays import Floats

STEP_M = 0.5
ODOMETER_SIGMA = 0.002
"""Relative scale error of a wheel: 2 mm in a metre, a tyre's wear; told with the result."""


@dataclass(frozen=True, slots=True)
class Driven:
    """A drive.

    Parameters
    ----------
    distance : ndarray, shape (n,)
        Of the odometer [m].
    heading : ndarray, shape (n,)
        Integrated, clockwise [rad].
    known : ndarray, shape (n,)
        Heading found at a stop [rad], NaN elsewhere.
    cycle : ndarray, shape (n,)
        Number of the power cycle.
    still : ndarray of bool, shape (n,)
    """

    distance: Floats
    heading: Floats
    known: Floats
    cycle: Floats
    still: np.ndarray


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
    unique = np.concatenate([[True], np.diff(driven.distance) > 0.0])
    heading = np.interp(
        0.5 * (grid[1:] + grid[:-1]), driven.distance[unique], np.unwrap(driven.heading)[unique]
    )
    steps = np.diff(grid)[:, None] * np.column_stack([np.sin(heading), np.cos(heading)])
    place = np.vstack([np.zeros(2), np.cumsum(steps, axis=0)]) + np.array(start)
    covariance = _covariance(steps, heading_walk, heading_sigma)
    return Reckoned(grid - driven.distance[0], place, covariance)


def _covariance(steps: Floats, walk: float, begin: float) -> Floats:
    """Of each point: common heading, its random walk, and the odometer's scale, shape (m, 2, 2)."""
    whole = np.vstack([np.zeros(2), np.cumsum(steps, axis=0)])
    found = np.zeros((whole.shape[0], 2, 2))
    across = np.column_stack([whole[:, 1], -whole[:, 0]])
    found += begin**2 * across[:, :, None] * across[:, None, :]
    found += ODOMETER_SIGMA**2 * whole[:, :, None] * whole[:, None, :]
    if walk > 0.0 and steps.shape[0]:
        # a heading kick before step j turns everything after it: sum over j of (P - P_j)(P - P_j)'
        squares = np.einsum("ki,kj->kij", whole, whole)
        count = np.arange(whole.shape[0])[:, None, None]
        total = np.cumsum(squares, axis=0) - squares
        first = np.cumsum(whole, axis=0) - whole
        cross = whole[:, :, None] * first[:, None, :]
        lever = count * squares - cross - np.swapaxes(cross, 1, 2) + total
        turned = np.array([[0.0, 1.0], [-1.0, 0.0]])
        found += walk**2 * STEP_M * np.einsum("ab,kbc,dc->kad", turned, lever, turned)
    return found


def snap(
    driven: Driven, *, power_cycle: str, end: tuple[float, float] | None, start: tuple[float, float]
) -> tuple[Driven, list[Snapped], Floats]:
    """Correct the headings from those found at stops, or from the known end.

    Parameters
    ----------
    driven : Driven
    power_cycle : str
        ``current``: the constant correction goes to what was driven since the power came back;
        ``previous``: to what was driven since the stop before, under the power before.
    end, start : tuple of float
        East, north [m].

    Returns
    -------
    driven : Driven
        With corrected headings.
    snapped : list of Snapped
    """
    heading = driven.heading.copy()
    found: list[Snapped] = []
    bounds = _stop_rows(driven)
    has_known = bool(np.any(np.isfinite(driven.known)))
    before = 0
    for row in bounds:
        if not math.isfinite(float(driven.known[row])):
            continue
        miss = wrap_pi(float(driven.known[row]) - float(heading[row]))
        if row > 0:
            found += _laid_back(driven, heading, before, row, miss=miss, power_cycle=power_cycle)
        heading[row + 1 :] += miss
        if row == 0:
            heading[0] += miss
        before = row
    if not has_known and end is not None:
        before = _last_stop(driven, bounds)
        miss = _miss_to_end(driven, heading, before, end, start=start, power_cycle=power_cycle)
        found += _laid_back(
            driven, heading, before, heading.size - 1, miss=miss, power_cycle=power_cycle
        )
    changed = Driven(driven.distance, heading, driven.known, driven.cycle, driven.still)
    return changed, found, heading - driven.heading


def _stop_rows(driven: Driven) -> list[int]:
    """Last row of each rest, and the last row of all."""
    ends = np.flatnonzero(driven.still[:-1] & ~driven.still[1:]).tolist()
    return sorted({*ends, driven.still.size - 1})


def _last_stop(driven: Driven, bounds: list[int]) -> int:
    """Row of the last stop from which something was driven.

    Where the power was switched during that stop, the one before: the constant correction parts
    what lies before the switch from what lies behind it.
    """
    final = float(driven.distance[-1])
    rows = [r for r in bounds if float(driven.distance[r]) < final - 1e-6]
    if not rows:
        return 0
    moving = np.flatnonzero(~driven.still[: rows[-1] + 1])
    arrived = int(moving[-1]) + 1 if moving.size else 0
    if float(driven.cycle[min(arrived, rows[-1])]) == float(driven.cycle[rows[-1]]):
        return rows[-1]
    return rows[-2] if len(rows) > 1 else 0


def _weights(driven: Driven, first: int, last: int, power_cycle: str) -> tuple[Floats, str]:
    """Share of the correction that each row from first to last takes, and its kind."""
    rows = np.arange(first, last + 1)
    cycles = driven.cycle[rows]
    if float(cycles[0]) != float(cycles[-1]):
        current = cycles == cycles[-1]
        return np.where(current if power_cycle == "current" else ~current, 1.0, 0.0), "constant"
    if first > 0 and float(driven.cycle[first - 1]) != float(cycles[0]):
        return np.ones(rows.size), "constant"
    length = float(driven.distance[last] - driven.distance[first])
    if length <= 0.0:
        return np.ones(rows.size), "linear"
    return (driven.distance[rows] - driven.distance[first]) / length, "linear"


def _laid_back(
    driven: Driven, heading: Floats, first: int, last: int, *, miss: float, power_cycle: str
) -> list[Snapped]:
    share, kind = _weights(driven, first, last, power_cycle)
    heading[first : last + 1] += miss * share
    rows = np.flatnonzero(share > 0.0)
    begin = first + int(rows[0]) if rows.size else first
    finish = first + int(rows[-1]) if rows.size else last
    zero = float(driven.distance[0])
    if kind == "linear":
        begin = first
        if float(driven.distance[finish]) <= float(driven.distance[begin]):
            return []
    return [
        Snapped(
            float(driven.distance[begin]) - zero,
            float(driven.distance[finish]) - zero,
            "constant" if kind == "constant" else "linear",
            math.degrees(miss),
        )
    ]


def _miss_to_end(
    driven: Driven,
    heading: Floats,
    first: int,
    end: tuple[float, float],
    *,
    start: tuple[float, float],
    power_cycle: str,
) -> float:
    """Heading correction at the end that brings the path to the known point, across it."""
    share, _ = _weights(driven, first, heading.size - 1, power_cycle)
    steps = np.diff(driven.distance)
    miss = 0.0
    for _ in range(8):
        turned = heading.copy()
        turned[first:] += miss * share
        middle = turned[:-1]
        place = np.array([float(steps @ np.sin(middle)), float(steps @ np.cos(middle))])
        off = np.array(end) - np.array(start) - place
        weight = steps[first:] * share[:-1]
        slope = np.array(
            [float(weight @ np.cos(middle[first:])), -float(weight @ np.sin(middle[first:]))]
        )
        size = float(slope @ slope)
        if size == 0.0:
            break
        step = float(slope @ off) / size
        miss += step
        if abs(step) < 1e-12:
            break
    return miss
