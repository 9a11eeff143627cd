"""Standard deviations of angles and distances from a field file itself: faces and sets.

Within one set the collimation (L - R + pi) / 2 is one quantity: its scatter over the targets is
the scatter of a direction observed in both faces. Centring and refraction are not in it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from surveyapp.domain.fieldfile import ReducedSet

LEAST_DOF: Final = 6
"""Below this the estimate is worth less than the instrument's data sheet (30 % and worse)."""


@dataclass(frozen=True, slots=True)
class FacePrecision:
    """Standard deviation of a direction (mean of both faces) [rad] and its degrees of freedom."""

    direction: float
    dof: int

    @property
    def angle(self) -> float:
        """Standard deviation of an angle, the difference of two directions [rad]."""
        return math.sqrt(2.0) * self.direction


def distance_precision(sets: Sequence[ReducedSet]) -> tuple[float, int] | None:
    """Pooled scatter of the distances of one sight over the sets of its set-up [m], and its dof.

    Neither the zero nor the scale of the instrument is in it, for all of them share both.
    """
    found: dict[tuple[str, str, str], list[float]] = {}
    for item in sets:
        for sight in item.sights:
            length = sight.slope_distance if sight.slope_distance is not None else sight.distance
            if length is not None:
                key = (item.name.rpartition("/")[0], item.at, sight.to)
                found.setdefault(key, []).append(length)
    total, dof = 0.0, 0
    for lengths in found.values():
        mean = sum(lengths) / len(lengths)
        total += sum((length - mean) ** 2 for length in lengths)
        dof += len(lengths) - 1
    return None if dof < LEAST_DOF or total <= 0.0 else (math.sqrt(total / dof), dof)


def face_precision(sets: Sequence[ReducedSet]) -> FacePrecision | None:
    """Pooled scatter of the collimation within sets; None with fewer than ``LEAST_DOF``."""
    total, dof = 0.0, 0
    for item in sets:
        count = len(item.spread)
        if count < 2:
            continue
        mean = sum(item.spread) / count
        total += sum((value - mean) ** 2 for value in item.spread)
        dof += count - 1
    if dof < LEAST_DOF or total <= 0.0:
        return None
    return FacePrecision(math.sqrt(total / dof), dof)
