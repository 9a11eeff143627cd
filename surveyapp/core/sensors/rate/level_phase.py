"""A phase in which a unit is levelled: where it stands still before it is turned, and after.

Its mean would be the tilt of neither, and the rates of the turns no rates of rest.
"""

from __future__ import annotations

import math

import numpy as np

from surveyapp_models.arrays import Floats

BLOCKS = 20
"""Of a phase that is looked at for turns."""
TURNED_SIGMAS = 5.0
"""Of the difference of two block means. By simulation (bench level_phase): of 2000 phases at rest
none of 600 rows and more is called turned, .0015 of 100 rows, whose blocks tell their noise ill."""
TURNED_LEAST = 0.01
"""[m/s2], .06 degrees: a turn of .07 is told nine times of ten where the noise allows it (the same
bench); .5 degrees with 600 rows of .03 m/s2."""


def still_ends(forces: Floats) -> tuple[slice, slice]:
    """Rows at the beginning and at the end of a phase in which the unit does not turn.

    Parameters
    ----------
    forces : ndarray, shape (n, 3)
        Specific force [m/s2].

    Returns
    -------
    before, after : slice
        The same one, of all rows, where it turns nowhere.
    """
    whole = slice(0, forces.shape[0])
    blocks = np.array_split(forces, min(BLOCKS, max(forces.shape[0] // 5, 1)))
    if len(blocks) < 3:
        return whole, whole
    means = np.array([block.mean(axis=0) for block in blocks])
    noise = np.median([b.std(axis=0, ddof=1) / math.sqrt(b.shape[0]) for b in blocks], axis=0)
    limit = np.maximum(TURNED_SIGMAS * math.sqrt(2.0) * noise, TURNED_LEAST)

    def run_of(order: Floats) -> int:
        moved = np.any(np.abs(order - order[0]) > limit, axis=1)
        return int(np.argmax(moved)) if moved.any() else order.shape[0]

    first, last = run_of(means), run_of(means[::-1])
    if first == len(blocks):
        return whole, whole
    sizes = [block.shape[0] for block in blocks]
    return slice(0, sum(sizes[:first])), slice(sum(sizes[: len(sizes) - last]), forces.shape[0])
