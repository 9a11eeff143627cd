"""Half-width of an interval whose sigma has several sources, one of them from few residuals.

With the effective degrees of freedom of Welch and Satterthwaite an interval is too narrow where one
estimate with one to five degrees of freedom stands among sources that are known: where that
estimate is small by chance, it also claims the many degrees of freedom of the others. With one
degree of freedom .87 to .93 hold the truth instead of .95. Banerjee's interval, the root of the sum
of (t u)^2, never holds less than .95 but up to .99. The interval here lies between the two, nearer
to Banerjee's the more that one estimate rules and the fewer its degrees of freedom: at one .942 to
.977, from two on .947 to .964 (``tests/core/test_few_degrees.py``). Several estimates of few
degrees of freedom do not make it too narrow, so a second one takes the correction away.

Source: JCGM 100:2008 (GUM), G.4.1 (Welch, Satterthwaite); Banerjee, S. K. (1960), Approximate
confidence interval for linear functions of means of k populations when the population variances are
not equal, Sankhya 22, 357-358. The interpolation is our own, calibrated by simulation.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from surveyapp.core.statistics.distributions import student_quantile

PROBABILITY = 0.975
FEW = 2.0
"""Degrees of freedom up to which the whole correction applies; beyond, Welch and Satterthwaite need
less and less of it (.936 at three, .945 at five)."""

Part = tuple[float, float]
"""A variance and the degrees of freedom of its estimate."""


def effective_dof(parts: Sequence[Part]) -> float:
    """Degrees of freedom of a sum of variances (Welch, Satterthwaite).

    Infinite where all of them are known.

    Parameters
    ----------
    parts : sequence of (variance, degrees of freedom)
        Independent estimates; variances in one unit.
    """
    total = math.fsum(variance for variance, _ in parts)
    if total == math.inf:
        return math.inf
    denominator = math.fsum(variance**2 / dof for variance, dof in parts if dof < math.inf)
    return total**2 / denominator if denominator > 0.0 else math.inf


def half_width95(parts: Sequence[Part]) -> float:
    """Half-width of the 95 % interval of a value with these independent estimates of variance.

    Parameters
    ----------
    parts : sequence of (variance, degrees of freedom)
        [unit^2] and [-]; degrees of freedom below 1 count as 1.

    Returns
    -------
    float
        [unit].
    """
    total = math.fsum(variance for variance, _ in parts)
    welch = _quantile(effective_dof(parts)) ** 2 * total
    by_weight = sorted(
        ((variance**2 / dof, variance, dof) for variance, dof in parts if dof < math.inf),
        reverse=True,
    )
    if not by_weight or not 0.0 < total < math.inf:
        return math.sqrt(welch)
    first, variance, dof = by_weight[0]
    second = by_weight[1][0] if len(by_weight) > 1 else 0.0
    if first <= 0.0:
        return math.sqrt(welch)
    rest = [(own, its) for weight, own, its in by_weight[1:]]
    beside = total - variance
    rest.append((max(beside - math.fsum(own for own, _ in rest), 0.0), math.inf))
    banerjee = _quantile(dof) ** 2 * variance + _quantile(effective_dof(rest)) ** 2 * beside
    share = math.sqrt(variance / total) * (1.0 - math.sqrt(second / first)) * min(1.0, FEW / dof)
    return math.sqrt(welch + share * max(banerjee - welch, 0.0))


def _quantile(dof: float) -> float:
    return student_quantile(PROBABILITY, max(dof, 1.0))
