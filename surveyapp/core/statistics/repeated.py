"""Repeated determinations: weighted means, their consistency, and what scatters between them.

A run tells its own reading error; what changes from run to run (the set-up, the tape, the spin)
shows only between runs. It is estimated from all groups of repeated determinations of one
instrument, and added to every one of them.

Source: Mandel, J. & Paule, R. C. (1970), Interlaboratory evaluation of a material with unequal
numbers of replicates, Anal. Chem. 42, 1194-1197; the median in place of the mean of chi-square:
Viechtbauer, W. (2021), Median-unbiased estimators for the amount of heterogeneity in meta-analysis;
physics.md 3.2.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from operator import mul

from surveyapp.core.statistics.distributions import chi_square_quantile, f_tail
from surveyapp.core.uncertain import Source, Uncertain, combine

SHARED = frozenset(
    {
        "centring",
        "deflection",
        "known azimuth",
        "torsion ratio",
        "known constant",
        "adopted effect",
        "lateral refraction",
        "observer",
        "temperature of the constant",
        "latitude of the constant",
        "printed convergence",
        "rotation of the mine grid",
    }
)
"""Sources that repeated determinations of one line share: they do not average down."""

SCATTER_GATE = 0.05
"""Of a scatter that a single difference tells: as an estimate it would have a t factor of 12.7."""
LEAST_REPETITIONS = 2
"""Degrees of freedom from which the scatter is estimated, and not only tested."""


def own_variance(item: Uncertain) -> float:
    """Variance [rad^2] of what belongs to one determination alone, as weights are made of it."""
    return math.fsum(
        (part * source.weight_ratio) ** 2
        for source, part in item.parts.items()
        if source.name not in SHARED
    )


def weights_of(items: Sequence[Uncertain]) -> list[float]:
    """Weights (sum 1) by the inverse variance of what is independent in each.

    Determinations whose sigma nothing tells get no weight, unless that is so for all of them.
    """
    variances = [own_variance(item) for item in items]
    if not any(math.isfinite(variance) for variance in variances):
        return [1.0 / len(items)] * len(items)
    if any(variance == 0.0 for variance in variances):
        raw = [1.0 if variance == 0.0 else 0.0 for variance in variances]
    else:
        raw = [1.0 / variance for variance in variances]
    total = math.fsum(raw)
    return [value / total for value in raw]


def weighted_mean(items: Sequence[Uncertain]) -> Uncertain:
    """Mean by inverse variance of the independent parts; shared parts stay whole."""
    weights = weights_of(items)
    return combine(
        (weight, item) for weight, item in zip(weights, items, strict=True) if weight > 0.0
    )


@dataclass(frozen=True, slots=True)
class Consistency:
    """Whether groups of repeated determinations agree within their own sigmas.

    Parameters
    ----------
    statistic : float
        Weighted sum of squares divided by its degrees of freedom (1 where they agree).
    dof : int
    probability : float
        Of a statistic this large if they agree.
    """

    statistic: float
    dof: int
    probability: float


def consistency(groups: Sequence[Sequence[Uncertain]]) -> Consistency | None:
    """Test all groups together, each about its own mean; None without a repetition.

    The statistic is compared with F, its denominator the pooled effective degrees of freedom of
    the determinations.
    """
    squares, dof = 0.0, 0
    sources: dict[Source, float] = {}
    for group in groups:
        usable = [item for item in group if 0.0 < own_variance(item) < math.inf]
        if len(usable) < 2:
            continue
        mean = weighted_mean(usable).value
        squares += math.fsum((item.value - mean) ** 2 / own_variance(item) for item in usable)
        dof += len(usable) - 1
        for item in usable:
            for source, part in item.without(*SHARED).parts.items():
                sources[source] = math.hypot(sources.get(source, 0.0), part)
    if dof == 0:
        return None
    denominator = Uncertain(0.0, sources).dof  # a pooled estimate counts once for all of them
    probability = f_tail(squares / dof, dof_numerator=dof, dof_denominator=denominator)
    return Consistency(squares / dof, dof, probability)


def between_variance(groups: Sequence[Sequence[Uncertain]], *, probability: float) -> float:
    """Variance between runs [rad^2] that makes the groups consistent (Mandel-Paule), >= 0.

    Consistent is a sum of squares at its mean, the degrees of freedom, where the runs clearly
    disagree: then it is [vv] / (n - 1) of the trade. The less they do, the nearer to the median of
    its distribution: at the mean the estimate is too small in more than half of all cases, and a
    scatter of the size of a run's own sigma would not be seen in most.

    Parameters
    ----------
    groups : sequence of sequence of Uncertain
    probability : float
        Of a scatter this large if there is none.
    """
    own = [[own_variance(item) for item in group] for group in groups]
    usable = [
        (variances, [item.value for item in group])
        for variances, group in zip(own, groups, strict=True)
        if len(group) >= 2 and all(0.0 < v < math.inf for v in variances)
    ]

    def statistic(extra: float) -> tuple[float, float]:
        """Sum of squares beside a further variance, and its derivative."""
        total = slope = 0.0
        for variances, values in usable:
            weights = [1.0 / (v + extra) for v in variances]
            mean = math.fsum(map(mul, weights, values)) / math.fsum(weights)
            squares = [w * (value - mean) ** 2 for w, value in zip(weights, values, strict=True)]
            total += math.fsum(squares)
            slope -= math.fsum(map(mul, weights, squares))
        return total, slope

    dof = sum(len(values) - 1 for _, values in usable)
    if dof == 0:
        return 0.0
    middle = float(dof)
    if dof >= LEAST_REPETITIONS:
        middle -= (dof - chi_square_quantile(0.5, dof)) * min(1.0, 2.0 * probability)
    # the sum is convex and falls: from below every step of Newton stays below
    extra = 0.0
    for _ in range(200):
        total, slope = statistic(extra)
        if total <= middle:
            break
        step = (middle - total) / slope
        extra += step
        if step <= 1e-13 * extra:
            break
    return extra


@dataclass(frozen=True, slots=True)
class RunScatter:
    """What scatters between runs of one instrument.

    Parameters
    ----------
    sigma : float
        [rad], 0 where the runs agree within their own sigmas.
    dof : int
    test : Consistency or None
    """

    sigma: float
    dof: int
    test: Consistency | None

    def applied(self, item: Uncertain, session: str) -> Uncertain:
        """Add the scatter to one determination."""
        if self.sigma == 0.0:
            return item
        return item.with_part(
            Source("run-to-run scatter", session, float(self.dof), pool="runs"), self.sigma
        )


def run_scatter(groups: Sequence[Sequence[Uncertain]]) -> RunScatter:
    """Estimate the scatter between runs from groups of repeated determinations.

    It is taken into account wherever the determinations differ by more than their own sigmas make
    in half of all cases, with the degrees of freedom of the repetitions, and not only where a test
    tells it: a test of six runs does not see a scatter as large as a run's own sigma in four cases
    of five, and the intervals would hold .90 instead of .95. A single difference is tested.
    """
    test = consistency(groups)
    if test is None:
        return RunScatter(0.0, 0, test)
    if test.dof < LEAST_REPETITIONS and test.probability >= SCATTER_GATE:
        return RunScatter(0.0, test.dof, test)
    return RunScatter(
        math.sqrt(between_variance(groups, probability=test.probability)), test.dof, test
    )
