"""Means of blocks, and the window in which something was switched on, refined on them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from surveyapp.diagnosis.sensors.loop import Candidate
from surveyapp_models.arrays import Floats

Blocks = NDArray[np.int64]

MOST_BLOCKS: Final = 160
COARSE: Final = 24
"""Windows of a switch begin and end at so many places in the first scan."""

SWITCH_SEARCHED: Final = 3
"""Two times among some ten thousand windows: more than two parameters of a BIC pay for."""


def block_means(values: Floats, block: Blocks) -> Floats:
    """Means of the rows of each block, shape (n, ...)."""
    count = np.bincount(block)
    flat = values.reshape(len(values), -1)
    sums = np.stack([np.bincount(block, weights=column) for column in flat.T], axis=1)
    return np.asarray((sums / count[:, None]).reshape(count.size, *values.shape[1:]))


def blocks_of(rows: int, most: int = MOST_BLOCKS) -> Blocks:
    """Numbers of contiguous blocks of equal size."""
    return np.arange(rows) * min(most, rows) // rows


def switched(time: Floats, on: float, off: float) -> Floats:
    """1 while on, from ``on`` up to ``off`` [s], else 0."""
    return ((time >= on) & (time < off)).astype(np.float64)


def switch(
    time: Floats, block: Blocks, step: Floats, names: tuple[str, ...], *, base_rows: Floats
) -> Candidate:
    """Something that is switched on and off: every window of a coarse scan, then finer ones.

    It is switched on inside the record: on from the start and off later is a constant iron and
    the opposite switch.
    """
    base = block_means(base_rows, block)
    n, d = base.shape[:2]
    # a constant iron is projected out of the scan, so that it cannot hide a switched one
    both = np.concatenate([base, block_means(step, block)], axis=2).reshape(n * d, -1)
    u, singular, _ = np.linalg.svd(both, full_matrices=False)
    q = u[:, singular > 1e-9 * singular[0]]
    edges = np.concatenate([time[np.searchsorted(block, np.arange(n))], [np.inf]])

    def window(on: float, off: float) -> Floats:
        return block_means(step * switched(time, on, off)[:, None, None], block)

    def gain(residual: Floats, i: int, j: int) -> float:
        z = window(float(edges[i]), float(edges[j])).reshape(n * d, -1)
        z = z - q @ (q.T @ z)
        y = residual.ravel()
        solution, rest, rank, _ = np.linalg.lstsq(z, y, rcond=1e-9)
        del solution
        return float(y @ y - rest[0]) if rest.size and rank == z.shape[1] else 0.0

    def designs(residual: Floats) -> Sequence[tuple[dict[str, float], Floats]]:
        places = np.unique(np.linspace(0, n, COARSE + 1).astype(int))
        scored = [
            (gain(residual, int(i), int(j)), int(i), int(j))
            for a, i in enumerate(places[:-1])
            for j in places[a + 1 :]
            if i > 0 and j - i >= 3
        ]
        best = max(scored, default=(0.0, n // 4, n // 2))
        width = max(n // COARSE // 2, 1)
        while True:
            _, i, j = best
            around = [
                (gain(residual, a, b), a, b)
                for a in {max(i - width, 1), i, i + width}
                for b in {j - width, j, min(j + width, n)}
                if b - a >= 3
            ]
            better = max(around, default=best)
            if better[0] <= best[0]:
                if width == 1:
                    break
                width = max(width // 2, 1)
            else:
                best = better
        on, off = float(edges[best[1]]), float(edges[best[2]])
        return [({"on_s": on, "off_s": off}, window(on, off))]

    return Candidate("interference_step", designs, names, "uT", SWITCH_SEARCHED)
