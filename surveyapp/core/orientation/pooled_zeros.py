"""Tape zeros of few readings: their sigma from what all tape zeros of an instrument tell together.

Five readings of an unspun swing leave two degrees of freedom. Such a sigma is honest with its t
quantile alone; among others it steers weights and effective degrees of freedom by chance. The
readings are the same everywhere: their variance is pooled, unless one zero differs from the others
by more than chance, and the degrees of freedom are those of all.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from surveyapp.core.statistics.distributions import f_tail
from surveyapp.core.statistics.levels import LOUD
from surveyapp.core.swing.session import ReducedSession
from surveyapp.core.swing.tape_zero import MIN_POINTS_FOR_RESIDUALS
from surveyapp.core.uncertain import Source, Uncertain

NAME = "tape zero"


@dataclass(frozen=True, slots=True)
class _Scatter:
    """What one tape zero tells of its readings [div^2]."""

    session: str
    place: str
    variance: float
    dof: int


def with_pooled_tape_zeros(reduced: Sequence[ReducedSession]) -> tuple[ReducedSession, ...]:
    """Every tape zero with the pooled variance of its instrument, and its degrees of freedom."""
    groups: dict[str, list[_Scatter]] = {}
    for item in reduced:
        groups.setdefault(item.session.instrument, []).extend(_scatters(item))
    found: dict[tuple[str, str], tuple[float, float]] = {}
    for group in groups.values():
        for own in group:
            ratio = _pooled(own, group)
            if ratio is not None:
                found[own.session, own.place] = ratio
    return tuple(_replaced(item, found) for item in reduced)


def _scatters(item: ReducedSession) -> list[_Scatter]:
    zero = item.reduction.tape_zero
    if zero is None:
        return []
    return [
        _Scatter(item.session.id, place, rest.scale_variance, rest.dof)
        for place, rest in (("before", zero.before), ("after", zero.after))
        if rest is not None
        and rest.scale_variance is not None
        and rest.dof > 0
        and rest.points >= MIN_POINTS_FOR_RESIDUALS
    ]


def _pooled(own: _Scatter, group: Sequence[_Scatter]) -> tuple[float, float] | None:
    """Factor of the sigma and degrees of freedom; None where nothing is to be pooled."""
    others = [item for item in group if item is not own]
    dof = sum(item.dof for item in others)
    if dof == 0 or own.variance <= 0.0:
        return None
    rest = math.fsum(item.dof * item.variance for item in others) / dof
    if rest <= 0.0:
        return None
    larger = own.variance > rest
    tail = f_tail(
        own.variance / rest if larger else rest / own.variance,
        dof_numerator=own.dof if larger else dof,
        dof_denominator=dof if larger else own.dof,
    )
    if tail < 0.5 * LOUD:
        return None
    together = (rest * dof + own.variance * own.dof) / (dof + own.dof)
    return math.sqrt(together / own.variance), float(dof + own.dof)


def _replaced(
    item: ReducedSession, found: Mapping[tuple[str, str], tuple[float, float]]
) -> ReducedSession:
    name = item.session.id
    if not any(session == name for session, _ in found):
        return item

    def changed(value: Uncertain | None) -> Uncertain | None:
        if value is None:
            return None
        parts: dict[Source, float] = {}
        for source, part in value.parts.items():
            pooled = found.get((name, source.detail))
            mine = source.name == NAME and source.entity == name and math.isfinite(source.dof)
            if pooled is not None and mine:
                pool = item.session.instrument
                parts[replace(source, dof=pooled[1], pool=pool)] = part * pooled[0]
            else:
                parts[source] = part
        return replace(value, parts=parts)

    north = changed(item.reduction.north)
    targets = tuple(replace(t, gyro_azimuth=changed(t.gyro_azimuth)) for t in item.targets)
    return replace(item, reduction=replace(item.reduction, north=north), targets=targets)
