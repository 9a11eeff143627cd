"""Snapping: a heading known again is laid back over what was driven.

Between stops the heading drifts; where it is known again (a heading found at a stop, or the point
at which the path ends), the drift is laid back linearly over what was driven since the stop before.
After a power cycle the heading is off by a constant, and so is the correction.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from surveyapp.core.sensors.rate.motion_pieces import PIECE_ROWS
from surveyapp.core.sensors.rate.odometer_path import Driven
from surveyapp.domain.columns import Room, in_memory, let_go, pieces
from surveyapp.domain.motion import Snapped
from surveyapp_models.angles import wrap_pi
from surveyapp_models.arrays import Floats

STEPS = 50
"""At most, of Newton's method for the heading that meets the known end."""
MET = 1e-9
"""A step of it that ends the search [rad]."""
MOVED_M = 1e-6


@dataclass(frozen=True, slots=True)
class _Share:
    """What part of a correction each row from first to last (inclusive) takes.

    ``of(a, b)`` gives that of the rows a to b (exclusive), ``begin`` and ``finish`` are the rows
    between which it is corrected.
    """

    kind: str
    first: int
    last: int
    of: Callable[[int, int], Floats]

    def pieces(self) -> Iterator[tuple[int, int, Floats]]:
        """Its rows in parts: from, to (exclusive), share."""
        for begin in range(self.first, self.last + 1, PIECE_ROWS):
            end = min(begin + PIECE_ROWS, self.last + 1)
            yield begin, end, self.of(begin, end)

    def ends(self) -> tuple[int, int]:
        """First and last row that takes a part."""
        begin, finish = self.first, self.last
        found = [(a, rows) for a, _, w in self.pieces() if (rows := np.flatnonzero(w > 0.0)).size]
        if found:
            begin, finish = found[0][0] + int(found[0][1][0]), found[-1][0] + int(found[-1][1][-1])
        return (self.first if self.kind == "linear" else begin), finish


def snap(
    driven: Driven,
    *,
    power_cycle: str,
    end: tuple[float, float] | None,
    start: tuple[float, float],
    room: Room = in_memory,
) -> tuple[Driven, list[Snapped]]:
    """Correct the headings from those found at stops, or from the known end.

    Parameters
    ----------
    driven : Driven
    power_cycle : str
        ``current``: the constant correction goes to what was driven since the power came back;
        ``previous``: to what was driven since the stop before, under the power before.
    end, start : tuple of float
        East, north [m].
    room : callable
        Where the corrected headings lie.

    Returns
    -------
    driven : Driven
        With corrected headings.
    snapped : list of Snapped
    """
    heading = room(driven.size)
    for begin in range(0, driven.size, PIECE_ROWS):
        heading[begin : begin + PIECE_ROWS] = driven.heading[begin : begin + PIECE_ROWS]
        driven.let_go()
        let_go(heading)
    found: list[Snapped] = []
    before, shift, done = 0, 0.0, 0
    for row in sorted(driven.known):
        miss = wrap_pi(driven.known[row] - float(heading[row]) - shift)
        _add(heading[done : row + 1], shift)
        if row > 0:
            share = _share(driven, before, row, power_cycle)
            found += _laid_back(driven, heading, share, miss)
        else:
            heading[0] += miss
        before, shift, done = row, shift + miss, row + 1
    _add(heading[done:], shift)
    changed = replace(driven, heading=heading)
    if not driven.known and end is not None:
        first = _last_stop(driven)
        share = _share(driven, first, driven.size - 1, power_cycle)
        drift = _miss_to_end(changed, share, (end[0] - start[0], end[1] - start[1]))
        if drift is not None:
            found += _laid_back(changed, heading, share, drift)
    return changed, found


def _add(values: Floats, constant: float) -> None:
    """Add a constant in place."""
    for piece in pieces(values):
        piece += constant


def _last_stop(driven: Driven) -> int:
    """Row of the last stop from which something was driven.

    Where the power was switched during that stop, the one before: the constant correction parts
    what lies before the switch from what lies behind it.
    """
    final = float(driven.distance[-1])
    runs = driven.rests.runs
    along = driven.distances([last - 1 for _, last in runs])
    rests = runs[: int(np.count_nonzero(along < final - MOVED_M))]
    if not rests:
        return 0
    arrived, left = rests[-1]
    if driven.cycle_at(arrived) == driven.cycle_at(left - 1):
        return left - 1
    return rests[-2][1] - 1 if len(rests) > 1 else 0


def _share(driven: Driven, first: int, last: int, power_cycle: str) -> _Share:
    now = driven.cycle_at(last)
    if driven.cycle_at(first) != now:

        def switched(a: int, b: int) -> Floats:
            current = driven.cycles(a, b) == now
            return np.where(current if power_cycle == "current" else ~current, 1.0, 0.0)

        return _Share("constant", first, last, switched)
    if first > 0 and driven.cycle_at(first - 1) != now:
        return _Share("constant", first, last, lambda a, b: np.ones(b - a))
    length = float(driven.distance[last] - driven.distance[first])
    if length <= 0.0:
        return _Share("linear", first, last, lambda a, b: np.ones(b - a))
    begin = float(driven.distance[first])
    return _Share("linear", first, last, lambda a, b: (driven.distance[a:b] - begin) / length)


def _laid_back(driven: Driven, heading: Floats, share: _Share, miss: float) -> list[Snapped]:
    for a, b, part in share.pieces():
        heading[a:b] += miss * part
        driven.let_go()
        let_go(heading)
    begin, finish = share.ends()
    zero = float(driven.distance[0])
    low, high = float(driven.distance[begin]), float(driven.distance[finish])
    if share.kind == "linear" and high <= low:
        return []
    kind = "constant" if share.kind == "constant" else "linear"
    return [Snapped(low - zero, high - zero, kind, math.degrees(miss))]  # type: ignore[arg-type]


def _miss_to_end(driven: Driven, share: _Share, wanted: tuple[float, float]) -> float | None:
    """Heading correction at the end that brings the path to the known point, across it.

    None where none of less than half a turn does. ``wanted``: east, north of the beginning [m].
    """
    fixed = np.zeros(2)
    for begin in range(0, share.first, PIECE_ROWS):
        part = slice(begin, min(begin + PIECE_ROWS, share.first) + 1)
        steps, middle = np.diff(driven.distance[part]), driven.heading[part][:-1]
        fixed += np.array([float(steps @ np.sin(middle)), float(steps @ np.cos(middle))])
        driven.let_go()
    miss = 0.0
    for _ in range(STEPS):
        place, slope = fixed.copy(), np.zeros(2)
        for a, b, taken in share.pieces():
            steps = np.diff(driven.distance[a : b + 1])
            turned = (driven.heading[a:b] + miss * taken)[: steps.size]
            east, north = np.sin(turned), np.cos(turned)
            place += np.array([float(steps @ east), float(steps @ north)])
            weight = steps * taken[: steps.size]
            slope += np.array([float(weight @ north), -float(weight @ east)])
            driven.let_go()
        size = float(slope @ slope)
        if size == 0.0:
            break
        step = float(slope @ (np.array(wanted) - place)) / size
        miss += step
        if abs(miss) > math.pi:
            break
        if abs(step) < MET:
            return miss
    return None
