"""The best placement of K gyro sides: all of them where they are few, exchanges elsewhere.

Greedy followed by single exchanges until none gains found the optimum in all 32 combinations that
were enumerated (penetration.md section 2); it is no proof, so the result says how it was found.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from surveyapp.core.penetration.placement import Outlook

ENUMERATED = 20_000
"""Placements up to which every one is looked at."""
SHOWN = 5
"""Placements that are told."""
BATCH = 20_000
GAIN = 1e-12
"""Smallest gain of an exchange that counts [m]."""


@dataclass(frozen=True, slots=True)
class Found:
    """Placements, best first.

    Parameters
    ----------
    sets : tuple of tuple of int
        Numbers of candidates, ascending.
    lateral : tuple of float
        1 sigma of each [m].
    exact : bool
    """

    sets: tuple[tuple[int, ...], ...]
    lateral: tuple[float, ...]
    exact: bool


def best_placements(start: Outlook, sides: int, *, exact: bool | None = None) -> Found:
    """Best placements of a number of sides.

    Parameters
    ----------
    start : Outlook
    sides : int
        1 to the number of candidates.
    exact : bool or None
        Whether to enumerate; None: where there are at most ``ENUMERATED`` placements.
    """
    count = len(start.pull)
    if exact is None:
        exact = math.comb(count, sides) <= ENUMERATED
    if exact:
        return enumerated(start, sides)
    return exchanged(start, greedy(start, sides))


def enumerated(start: Outlook, sides: int) -> Found:
    """Look at every placement."""
    best: list[tuple[float, tuple[int, ...]]] = []
    combinations = itertools.combinations(range(len(start.pull)), sides)
    while block := list(itertools.islice(combinations, BATCH)):
        sets = np.array(block, dtype=np.int64)
        lateral = start.batch(sets)
        first = np.argsort(lateral, kind="stable")[:SHOWN]
        best = sorted([*best, *((float(lateral[i]), block[int(i)]) for i in first)])[:SHOWN]
    return Found(tuple(s for _, s in best), tuple(v for v, _ in best), True)


def greedy(start: Outlook, sides: int) -> list[int]:
    """Add the side that gains most, again and again."""
    chosen: list[int] = []
    now = start
    for _ in range(sides):
        after = now.each()
        after[chosen] = np.inf
        chosen.append(int(np.argmin(after)))
        now = now.with_row(chosen[-1])
    return chosen


def exchanged(start: Outlook, chosen: Sequence[int]) -> Found:
    """Exchange single sides until none gains."""
    now = start
    for side in chosen:
        now = now.with_row(side)
    current, value = list(chosen), now.lateral
    neighbours: dict[tuple[int, ...], float] = {}
    improved = True
    while improved:
        improved, neighbours = False, {}
        for place in range(len(current)):
            without = now.with_row(current[place], removed=True)
            after = without.each()
            kept = current[:place] + current[place + 1 :]
            after[kept] = np.inf
            for other in np.argsort(after, kind="stable")[:SHOWN]:
                if np.isfinite(after[other]):
                    neighbours[tuple(sorted([*kept, int(other)]))] = float(after[other])
            best = int(np.argmin(after))
            if after[best] < value - GAIN:
                current[place], value = best, float(after[best])
                now, improved = without.with_row(best), True
    # numbers that are told come from the whole equations, not from a chain of updates
    sets = sorted({*neighbours, tuple(sorted(current))}, key=lambda s: neighbours.get(s, value))
    told = np.array(sets[: 2 * SHOWN], dtype=np.int64)
    lateral = start.batch(told)
    order = np.argsort(lateral, kind="stable")[:SHOWN]
    return Found(
        tuple(tuple(told[i].tolist()) for i in order),
        tuple(float(lateral[i]) for i in order),
        False,
    )


def least_sides(start: Outlook, allowed: float) -> tuple[tuple[int, ...], float] | None:
    """Fewest sides whose lateral 1 sigma is allowed, None where no number of sides is enough.

    Parameters
    ----------
    start : Outlook
    allowed : float
        Lateral 1 sigma [m].
    """
    if start.lateral <= allowed:
        return (), start.lateral
    chosen: list[int] = []
    now = start
    while now.lateral > allowed:
        if len(chosen) == len(start.pull):
            return None
        after = now.each()
        after[chosen] = np.inf
        chosen.append(int(np.argmin(after)))
        now = now.with_row(chosen[-1])
    best = best_placements(start, len(chosen))
    while len(chosen) > 1:
        fewer = best_placements(start, len(chosen) - 1)
        if fewer.lateral[0] > allowed:
            break
        chosen, best = list(fewer.sets[0]), fewer
    return best.sets[0], best.lateral[0]
