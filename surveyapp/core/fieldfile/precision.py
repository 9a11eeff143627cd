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
from surveyapp_models.angles import wrap_pi

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
    """Scatter of a distance (mean of its faces) [m] and its degrees of freedom.

    Pooled over the whole file from the differences of the faces and of the sets of a set-up.
    Neither the zero nor the scale of the instrument is in it, for all of them share both.
    """
    found: dict[tuple[str, str, str], list[float]] = {}
    total, dof = 0.0, 0
    for item in sets:
        total += sum(gap**2 for gap in item.length_gaps)
        dof += len(item.length_gaps)
        for sight in item.sights:
            length = sight.slope_distance if sight.slope_distance is not None else sight.distance
            if length is not None:
                key = (item.name.rpartition("/")[0], item.at, sight.to)
                found.setdefault(key, []).append(length)
    between, more = _within(list(found.values()))
    total, dof = total + between, dof + more
    return None if dof < LEAST_DOF or total <= 0.0 else (math.sqrt(total / dof), dof)


def zenith_precision(sets: Sequence[ReducedSet]) -> tuple[float, int] | None:
    """Scatter of a zenith angle (mean of both faces) [rad] and its degrees of freedom.

    The index i = (L + R - 2 pi) / 2 is one quantity within a set, and its scatter over the targets
    that of the mean of the faces; so are the zenith angles of a target in the sets of a set-up.
    Refraction and the heights of instrument and target are not in it.
    """
    total, dof = _zenith_squares(sets)
    return None if dof < LEAST_DOF or total <= 0.0 else (math.sqrt(total / dof), dof)


def circle_precision(sets: Sequence[ReducedSet]) -> FacePrecision | None:
    """Scatter of directions and zenith angles together, where each alone says too little.

    Data sheets give both circles of an instrument one standard deviation. None with fewer than
    ``LEAST_DOF`` degrees of freedom in both.
    """
    total, dof = (sum(x) for x in zip(_direction_squares(sets), _zenith_squares(sets), strict=True))
    if dof < LEAST_DOF or total <= 0.0:
        return None
    return FacePrecision(math.sqrt(total / dof), int(dof))


def _zenith_squares(sets: Sequence[ReducedSet]) -> tuple[float, int]:
    found: dict[tuple[str, str, str], list[float]] = {}
    total, dof = _within([item.index_spread for item in sets])
    for item in sets:
        for sight in item.sights:
            if sight.zenith is not None and sight.faces == 2 and sight.to not in item.unlike:
                key = (item.name.rpartition("/")[0], item.at, sight.to)
                found.setdefault(key, []).append(sight.zenith)
    between, more = _within(list(found.values()))
    return total + between, dof + more


def _within(groups: Sequence[Sequence[float]]) -> tuple[float, int]:
    """Sum of squares about the mean of each group, and its degrees of freedom."""
    total, dof = 0.0, 0
    for values in groups:
        if len(values) < 2:
            continue
        mean = sum(values) / len(values)
        total += sum((value - mean) ** 2 for value in values)
        dof += len(values) - 1
    return total, dof


def face_precision(sets: Sequence[ReducedSet]) -> FacePrecision | None:
    """Pooled scatter of directions over the whole file; None with fewer than ``LEAST_DOF``.

    Two sources with the same variance, independent of each other as difference and mean of the
    faces are: the collimation within sets, and the directions of a set-up between its sets.
    """
    total, dof = _direction_squares(sets)
    if dof < LEAST_DOF or total <= 0.0:
        return None
    return FacePrecision(math.sqrt(total / dof), dof)


def _direction_squares(sets: Sequence[ReducedSet]) -> tuple[float, int]:
    total, dof = _within([item.spread for item in sets])
    between, more = _between_sets(sets)
    return total + between, dof + more


def _between_sets(sets: Sequence[ReducedSet]) -> tuple[float, int]:
    """Sum of squares and degrees of freedom of directions between the sets of one set-up.

    The residuals of set + target (two-way table): (targets - 1) (sets - 1) for sets that hold the
    same targets in both faces.
    """
    tables: dict[tuple[str, str, tuple[str, ...]], list[list[float]]] = {}
    for item in sets:
        rays = {s.to: s.direction for s in item.sights if s.faces == 2 and s.direction is not None}
        if len(rays) < 2 or len(rays) < len(item.sights) or item.unlike:
            continue
        names = tuple(sorted(rays))
        first = rays[names[0]]
        turned = [wrap_pi(rays[name] - first) for name in names]
        tables.setdefault((item.name.rpartition("/")[0], item.at, names), []).append(turned)
    total, dof = 0.0, 0
    for (_, _, names), rows in tables.items():
        if len(rows) < 2:
            continue
        gaps = [[wrap_pi(x - y) for x, y in zip(row, rows[0], strict=True)] for row in rows]
        by_set = [sum(row) / len(row) for row in gaps]
        by_target = [sum(column) / len(gaps) for column in zip(*gaps, strict=True)]
        mean = sum(by_set) / len(by_set)
        total += sum(
            (x - own - target + mean) ** 2
            for row, own in zip(gaps, by_set, strict=True)
            for x, target in zip(row, by_target, strict=True)
        )
        dof += (len(rows) - 1) * (len(names) - 1)
    return total, dof
