"""Columns of a log of any length: walked through piece by piece, sampled, let go of again.

The columns of a large log lie in a file without a name that is mapped into memory. What was looked
at stays there until the system wants it back, which it never does on an idle machine: whoever
walks through a column lets go of what lies behind, so that a log of any length takes the memory of
a piece.
"""

from __future__ import annotations

import mmap
from collections.abc import Callable, Iterator
from typing import Final

import numpy as np
from numpy.typing import NDArray

from surveyapp_models.arrays import Floats

PIECE: Final = 1 << 20
"""Rows of a piece."""

Room = Callable[[int], Floats]
"""Makes room for so many numbers: in memory, or mapped to disk where they are many."""


def in_memory(size: int) -> Floats:
    """Room in memory, shape (size,)."""
    return np.empty(size)


def let_go(values: NDArray[np.float64]) -> None:
    """Give the memory of a mapped column back; nothing is lost, the file keeps it.

    Does nothing for columns in memory and on systems that have no such call.
    """
    mapped = _mapping(values)
    if mapped is not None and hasattr(mmap, "MADV_DONTNEED"):
        mapped.madvise(mmap.MADV_DONTNEED)


def _mapping(values: object) -> mmap.mmap | None:
    """The shared mapping behind an array or a view of one; a private one would lose its changes."""
    while values is not None:
        if isinstance(values, np.memmap):
            found: mmap.mmap | None = values._mmap  # type: ignore[attr-defined]
            return found if values.mode in ("r", "r+", "w+") else None
        values = getattr(values, "base", None)
    return None


def pieces(values: Floats, size: int = PIECE, *, overlap: int = 0) -> Iterator[Floats]:
    """A column piece by piece, in order; nothing of its length is made beside it.

    Parameters
    ----------
    values : ndarray, shape (n,)
    size : int
        Rows of a piece.
    overlap : int
        Rows of the next piece that end each one.
    """
    plain = np.asarray(values)
    for start in range(0, plain.size - overlap, size):
        yield plain[start : start + size + overlap]
        let_go(plain)


def span(values: Floats) -> float:
    """Highest value less the lowest, shape (n,); NaN where one is."""
    ends = [(float(piece.min()), float(piece.max())) for piece in pieces(values)]
    return float(np.max([high for _, high in ends]) - np.min([low for low, _ in ends]))


def sampled(values: Floats, most: int) -> Floats:
    """Every k-th value, at most about so many: a copy where the column is mapped."""
    every = max(values.size // most, 1)
    return every_kth(values, every)


def every_kth(values: Floats, every: int) -> Floats:
    """Every k-th value from the first on: a copy where the column is mapped."""
    if _mapping(values) is None:
        return values[::every]
    size = max(PIECE // every, 1) * every
    return np.concatenate([piece[::every].copy() for piece in pieces(values, size)])
