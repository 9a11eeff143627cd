"""Weights of runs from what all runs of an instrument tell of its readings together.

The sigma of a run comes from its own residuals, of which there are few. As a sigma it is honest
with its degrees of freedom; as a weight it is not: runs whose residuals are small by chance would
draw the mean to themselves, and the sigma of the mean would be too small. Weights are therefore
made with the pooled sigma of the readings, unless a run differs from the others by more than
chance. No sigma and no interval is changed here.

Source: Meier, P. (1953), Variance of a weighted mean, Biometrics 9, 59-73 (the loss that estimated
weights cause).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from surveyapp.core.statistics.distributions import f_tail
from surveyapp.core.statistics.levels import LOUD
from surveyapp.core.swing.session import ReducedSession
from surveyapp.core.uncertain import Source, Uncertain


@dataclass(frozen=True, slots=True)
class _Scatter:
    """What the residuals of one run tell of one reading."""

    session: str
    variance: float
    dof: float


def with_pooled_weights(reduced: Sequence[ReducedSession]) -> tuple[ReducedSession, ...]:
    """Give the error source of every run's readings the ratio that its weight is made with."""
    groups: dict[tuple[str, str], list[_Scatter]] = {}
    for item in reduced:
        unit = item.reduction.unit
        if unit is not None and unit.sigma > 0.0 and math.isfinite(unit.dof):
            found = _Scatter(item.session.id, unit.sigma**2, unit.dof)
            groups.setdefault((item.session.instrument, unit.source), []).append(found)
    ratios = {
        (scatter.session, source): _ratio(scatter, *rest)
        for (_, source), group in groups.items()
        for scatter, rest in zip(group, _of_the_others(group), strict=True)
        if len(group) > 1
    }
    return tuple(_weighted(item, ratios) for item in reduced)


def _of_the_others(group: Sequence[_Scatter]) -> list[tuple[float, float]]:
    """Degrees of freedom and their sum of squares of all runs but each one, in one pass.

    Sums from the front and from the back, so that nothing is subtracted.
    """
    found = [(0.0, 0.0)] * len(group)
    for order in (range(len(group)), range(len(group) - 1, -1, -1)):
        dof = squares = 0.0
        for place in order:
            found[place] = (found[place][0] + dof, found[place][1] + squares)
            dof += group[place].dof
            squares += group[place].dof * group[place].variance
    return found


def _ratio(own: _Scatter, dof: float, squares: float) -> float:
    """Pooled sigma divided by one's own; 1 where the run differs from the others significantly."""
    rest = squares / dof
    larger = own.variance > rest
    numerator, denominator = (own.dof, dof) if larger else (dof, own.dof)
    quotient = own.variance / rest if larger else rest / own.variance
    tail = f_tail(quotient, dof_numerator=numerator, dof_denominator=denominator)
    if tail < 0.5 * LOUD:
        return 1.0
    pooled = (rest * dof + own.variance * own.dof) / (dof + own.dof)
    return math.sqrt(pooled / own.variance)


def _weighted(item: ReducedSession, ratios: Mapping[tuple[str, str], float]) -> ReducedSession:
    unit = item.reduction.unit
    ratio = 1.0 if unit is None else ratios.get((item.session.id, unit.source), 1.0)
    if unit is None or ratio == 1.0:
        return item
    targets = tuple(
        target
        if target.gyro_azimuth is None
        else replace(
            target, gyro_azimuth=_marked(target.gyro_azimuth, unit.source, item.session.id, ratio)
        )
        for target in item.targets
    )
    return replace(item, targets=targets)


def _marked(value: Uncertain, name: str, session: str, ratio: float) -> Uncertain:
    parts: dict[Source, float] = {}
    for source, part in value.parts.items():
        own = source.name == name and source.entity == session
        parts[replace(source, weight_ratio=ratio) if own else source] = part
    return Uncertain(value.value, parts)
