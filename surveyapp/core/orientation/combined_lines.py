"""Lines of one side combined: by several instruments, forward and back.

The weights are those of least squares with the whole covariance of the lines: what they share (a
deflection, the rotation of the grid, a known azimuth behind every constant, the constant of one
instrument) does not average down, and does not count in the test of their agreement.

Source: Koch, K.-R. (1999), Parameter Estimation and Hypothesis Testing in Linear Models, 3.2.3
(best linear unbiased estimate) and 4.2 (quadratic form of the residuals). Fai, A. H.-T. &
Cornelius, P. L. (1996), Approximate F-tests of multiple degree of freedom hypotheses in generalized
least squares analyses, J. Statist. Comput. Simul. 54, 363-378 (degrees of freedom of the test).
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from surveyapp.core.orientation.deflection_field import DeflectionField
from surveyapp.core.orientation.lines import OrientedLine, angle_result
from surveyapp.core.statistics.distributions import f_tail
from surveyapp.core.statistics.levels import CONSISTENT
from surveyapp.core.statistics.repeated import weights_of
from surveyapp.core.uncertain import Source, Uncertain, aligned, combine
from surveyapp.domain.combined_result import CombinedPart, CombinedResult
from surveyapp_models.arrays import Floats

SINGULAR = 1e-12
"""Share of the largest own variance below which a difference of lines has no error of its own."""
LEAST_DOF = 2.0
"""Degrees of freedom up to which a squared t has no mean."""


def combined_lines(
    lines: Sequence[OrientedLine], deflections: DeflectionField
) -> tuple[CombinedResult, ...]:
    """Combine every side that has two lines or more with a grid azimuth and a sigma.

    Parameters
    ----------
    lines : sequence of OrientedLine
        Of any sides; A-B and B-A are one side.
    deflections : DeflectionField
        Of the project: what two stations share of them.
    """
    found = (_combined(side, deflections) for side in sides_of(lines).values() if len(side) > 1)
    return tuple(item for item in found if item is not None)


def sides_of(lines: Sequence[OrientedLine]) -> dict[frozenset[str], list[OrientedLine]]:
    """Lines with a grid azimuth by the two stations of their side."""
    sides: dict[frozenset[str], list[OrientedLine]] = {}
    for line in lines:
        if line.grid is not None:
            name = frozenset((line.result.station, line.result.target))
            sides.setdefault(name, []).append(line)
    return sides


def _combined(side: Sequence[OrientedLine], deflections: DeflectionField) -> CombinedResult | None:
    first = side[0].result
    usable = [line for line in side if line.grid is not None and _told(line.grid)]
    if len(usable) < 2:
        return None
    one_way = [_one_way(line, first.station) for line in usable]
    items = aligned(deflections.jointly(one_way))
    covariance = _covariance(items)
    inverse = _inverse(covariance)
    if inverse is None:
        return None
    weights = _weights(items, inverse)
    mean = combine(zip(weights, items, strict=True))
    chi_square, probability = _agreement(items, inverse)
    agree = probability >= CONSISTENT
    by_line = {id(line): weight for line, weight in zip(usable, weights, strict=True)}
    return CombinedResult(
        station=first.station,
        target=first.target,
        lines=tuple(
            CombinedPart(
                line.result.station,
                line.result.target,
                line.result.instrument,
                by_line.get(id(line)),
            )
            for line in side
        ),
        grid_azimuth=angle_result(mean) if agree else None,
        chi_square=chi_square,
        dof=len(items) - 1,
        probability=probability,
        agree=agree,
    )


def _told(item: Uncertain) -> bool:
    return 0.0 < item.variance < math.inf


def _one_way(line: OrientedLine, station: str) -> Uncertain:
    assert line.grid is not None
    return line.grid if line.result.station == station else line.grid.shifted(math.pi)


def _covariance(items: Sequence[Uncertain]) -> Floats:
    """Covariance [rad^2] as weights are made of it."""
    sources: dict[Source, int] = {}
    for item in items:
        for source in item.parts:
            sources.setdefault(source, len(sources))
    parts = np.zeros((len(items), len(sources)))
    for row, item in enumerate(items):
        for source, part in item.parts.items():
            parts[row, sources[source]] = part * source.weight_ratio
    return parts @ parts.T


def _inverse(covariance: Floats) -> Floats | None:
    """Inverse of the covariance, None where two lines differ by nothing that has a sigma."""
    scale = np.sqrt(np.diag(covariance))
    correlation = covariance / np.outer(scale, scale)
    if np.linalg.eigvalsh(correlation)[0] < SINGULAR:
        return None
    return np.asarray(np.linalg.inv(correlation) / np.outer(scale, scale))


def _weights(items: Sequence[Uncertain], inverse: Floats) -> list[float]:
    """Weights (sum 1) of least squares; none below zero.

    A negative weight means that the estimate lies outside of its own observations, on the strength
    of a correlation that is known no better than its sigmas: there, inverse variances of what
    belongs to each line alone.
    """
    raw = inverse.sum(axis=0)
    if (raw < 0.0).any():
        return weights_of(items)
    return [float(weight) for weight in raw / raw.sum()]


def _agreement(items: Sequence[Uncertain], inverse: Floats) -> tuple[float, float]:
    """Quadratic form of the residuals and its probability if the lines agree.

    Compared with F. The residuals of one mean are not independent: the degrees of freedom of the
    denominator come from differences of the lines that are.
    """
    raw = inverse.sum(axis=0)
    values = np.array([item.value for item in items])
    vector = values - float(raw @ values) / float(raw.sum())
    statistic = float(vector @ inverse @ vector)
    dof = len(items) - 1
    tail = f_tail(statistic / dof, dof_numerator=dof, dof_denominator=_denominator(items))
    return statistic, tail


def _denominator(items: Sequence[Uncertain]) -> float:
    """Degrees of freedom behind the test that the lines agree (Fai and Cornelius).

    The differences to the first line are turned into independent ones; each has the degrees of
    freedom of Welch and Satterthwaite, and together they have those with which F has the mean of
    the sum of their squared t. With two lines: those of their difference.
    """
    differences = [item - items[0] for item in items[1:]]
    _, axes = np.linalg.eigh(_covariance(differences))
    independent = [combine(zip(axis.tolist(), differences, strict=True)) for axis in axes.T]
    own = [max(item.dof, 1.0) for item in independent]
    if len(own) == 1 or min(own) <= LEAST_DOF:
        return min(own)
    if min(own) == math.inf:
        return math.inf
    expected = math.fsum(dof / (dof - 2.0) if dof < math.inf else 1.0 for dof in own)
    return 2.0 * expected / (expected - len(own))
