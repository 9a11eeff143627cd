"""What if: a mine with further sides, other sigmas or another survey, beside the mine as it is.

Every change gives a new value; the mine itself is never changed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from surveyapp.core.penetration.mine import Mine
from surveyapp.core.penetration.placement import Candidate, outlook
from surveyapp.core.penetration.planning import (
    BETTER_ANGLES,
    BETTER_GYRO,
    candidates_of,
    reciprocal,
    scaled,
    with_candidates,
)
from surveyapp.core.penetration.rows import RowKind


@dataclass(frozen=True, slots=True)
class WhatIf:
    """A mine and what is tried on it.

    Parameters
    ----------
    mine : Mine
        As it is.
    defaults : mapping of heading name to (instrument, sigma)
        For a heading without a gyro.
    added : tuple of Candidate
        Further gyro sides, in the order in which they were added.
    both_ends : bool
        Every gyro side from both ends.
    better_angles, better_gyro : bool
        With 5/7 and 2/3 of the sigma.
    more_surveys : int
    """

    mine: Mine
    defaults: Mapping[str, tuple[str, float]]
    added: tuple[Candidate, ...] = ()
    both_ends: bool = False
    better_angles: bool = False
    better_gyro: bool = False
    more_surveys: int = 0

    def changed(self) -> Mine:
        """The mine with everything that is tried."""
        mine = with_candidates(self.mine, self.added)
        if self.better_angles:
            mine = scaled(mine, RowKind.ANGLE, BETTER_ANGLES)
        if self.better_gyro:
            mine = scaled(mine, RowKind.GYRO, BETTER_GYRO)
        if self.both_ends:
            mine = reciprocal(mine)[0]
        surveys = mine.plan.independent_surveys + self.more_surveys
        return replace(mine, plan=replace(mine.plan, independent_surveys=surveys))

    def with_best_side(self) -> WhatIf:
        """One more gyro side, where it gains most; the same where no side is free."""
        now = self.changed()
        free = candidates_of(now, self.defaults)
        if not free:
            return self
        best = int(np.argmin(outlook(now, free).each()))
        base = {c.heading: c for c in candidates_of(self.mine, self.defaults)}
        # the sigma as declared: what is tried on it is applied to all sides alike
        chosen = replace(free[best], sigma=base[free[best].heading].sigma)
        return replace(self, added=(*self.added, chosen))

    def without_last_side(self) -> WhatIf:
        """Without the side that was added last."""
        return replace(self, added=self.added[:-1])

    @property
    def sides(self) -> tuple[tuple[str, str], ...]:
        """Added sides by their stations."""
        return tuple(self.mine.plan.headings[item.heading].sides[item.side] for item in self.added)
