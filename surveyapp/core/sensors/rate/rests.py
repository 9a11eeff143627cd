"""Which rows of a record are at rest: the bounds of each rest, however many rows there are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Self

import numpy as np

from surveyapp.core.sensors.rate.still import Mask, runs_of

Run = tuple[int, int]
"""First and last (exclusive) row."""


@dataclass(frozen=True, slots=True)
class Rests:
    """Rests of a record.

    Parameters
    ----------
    runs : tuple of Run
        In order; no two touch.
    size : int
        Rows of the record.
    """

    runs: tuple[Run, ...]
    size: int

    @classmethod
    def of(cls, mask: Mask) -> Self:
        """Those of a mask, shape (n,)."""
        return cls(tuple(runs_of(mask)), mask.size)

    @classmethod
    def joined(cls, runs: Sequence[Run], size: int) -> Self:
        """Runs in order, those that touch made one."""
        found: list[Run] = []
        for first, last in runs:
            if found and found[-1][1] == first:
                found[-1] = (found[-1][0], last)
            else:
                found.append((first, last))
        return cls(tuple(found), size)

    @property
    def count(self) -> int:
        """Rows at rest."""
        return sum(last - first for first, last in self.runs)

    @property
    def moving(self) -> list[Run]:
        """The runs between them."""
        edges = [0, *(edge for run in self.runs for edge in run), self.size]
        return [(a, b) for a, b in list(pairwise(edges))[::2] if a < b]

    def mask(self, first: int = 0, last: int | None = None) -> Mask:
        """Whether each of the rows first to last (exclusive) is at rest, shape (last - first,)."""
        last = self.size if last is None else min(last, self.size)
        found = np.zeros(max(last - first, 0), dtype=bool)
        for begin, end in self.runs:
            if end > first and begin < last:
                found[max(begin - first, 0) : end - first] = True
        return found

    def behind(self, row: int) -> Rests:
        """Those of the record that begins with a row."""
        cut = ((max(a - row, 0), b - row) for a, b in self.runs if b > row)
        return Rests(tuple(cut), self.size - row)
