"""The gate: whether anything is left in the residuals that pure noise would rarely show."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from surveyapp.diagnosis.candidates import Candidate
from surveyapp.diagnosis.case import Case, unit_variance
from surveyapp.diagnosis.compare import may_join, most_parameters, orthonormal_design, slip_bends
from surveyapp.diagnosis.fits import Fit, scan_exact, scan_law
from surveyapp.diagnosis.nulls import Noise, null_of, ratio, reductions
from surveyapp.diagnosis.projection import Projected, project
from surveyapp_models.arrays import Floats

FINE = 0.3
"""Rounding below this share of the noise's standard deviation changes nothing."""


@dataclass(frozen=True, slots=True)
class Tested:
    """The test of one effect beside a model.

    Parameters
    ----------
    id : str
    p, p_family : float or None
        None where it is not separable from the model.
    left : float
        Share of its columns that the model leaves.
    """

    id: str
    p: float | None
    p_family: float | None
    left: float


@dataclass(frozen=True, slots=True)
class Gate:
    """All tests beside one model.

    Parameters
    ----------
    effects : tuple of str
        What the model contains already.
    tests : tuple of Tested
    p_family : float
        Smallest of the family.
    level : float
        At which it opens.
    """

    effects: tuple[str, ...]
    tests: tuple[Tested, ...]
    p_family: float
    level: float

    @property
    def fired(self) -> bool:
        """Whether the search goes on."""
        return self.p_family <= self.level


def rounding_of(problem: Case, fit: Fit) -> float:
    """Reading resolution in units of the noise, in coarse steps so that nulls are kept."""
    if problem.resolution <= 0.0:
        return 0.0
    known = unit_variance(problem)
    dof = max(problem.size - fit.design.shape[1], 1)
    variance = fit.sum_of_squares / dof if known is None else known
    white = max(variance - problem.noise_floor**2, (0.1 * problem.resolution) ** 2)
    share = problem.resolution / float(np.sqrt(white))
    return 0.0 if share < FINE else float(2.0 ** (np.round(2.0 * np.log2(share)) / 2.0))


def statistic(problem: Case, fit: Fit, item: Projected, q: Floats) -> float:
    """Largest reduction of the sum of squares over the grid, relative to what is left."""
    reduction = float(reductions(item, fit.residual).max(initial=0.0))
    candidate = item.candidate
    if candidate.is_law and fit.theta is not None and fit.law is None:
        rss = scan_law(problem, candidate, fit.members, fit.theta)[item.index]
        reduction = max(reduction, fit.sum_of_squares - float(rss.min()))
    elif fit.theta is not None and not fit.members and slip_bends(candidate, fit):
        rss = scan_exact(problem, candidate, fit.members, fit.theta)[item.index]
        reduction = max(reduction, fit.sum_of_squares - float(rss.min()))
    known = unit_variance(problem)
    if known is not None:
        return reduction / known
    floor = (problem.size - q.shape[1]) * problem.noise_floor**2
    left = fit.sum_of_squares
    if fit.hidden is not None:
        left = float(np.sum((fit.residual - q @ (q.T @ fit.residual)) ** 2))
    return float(ratio(np.array(reduction), np.array(left), floor))


def open_gate(problem: Case, fit: Fit, pool: Iterable[Candidate], draws: int) -> Gate:
    """Test every candidate beside a model.

    Parameters
    ----------
    problem : Case
    fit : Fit
    pool : iterable of Candidate
    draws : int
        Monte Carlo draws.

    Returns
    -------
    Gate
    """
    level = problem.levels.further if fit.effects else problem.levels.first
    q = orthonormal_design(fit)
    most = most_parameters(problem)
    joining = [c for c in pool if may_join(c, fit, most=most)]
    every = [project(c, q) for c in joining]
    family = tuple(item for item in every if item.index.size)
    if not family:
        return Gate(fit.effects, (), 1.0, level)
    known = unit_variance(problem)
    rounding = rounding_of(problem, fit)
    noise = Noise(
        draws,
        rounding,
        problem.root_weights,
        known is not None,
        own_scales=problem.own_scales,
    )
    null = null_of(family, q, noise)
    observed = [statistic(problem, fit, item, q) for item in family]
    p = null.p_values(np.array(observed))
    adjusted = null.family(p)
    best: dict[str, Tested] = {}
    for item, one, whole in zip(family, p, adjusted, strict=True):
        test = Tested(item.candidate.id, float(one), float(whole), item.left)
        if test.id not in best or one < (best[test.id].p or 0.0):
            best[test.id] = test
    for item in every:
        if item.candidate.id not in best:
            best[item.candidate.id] = Tested(item.candidate.id, None, None, item.left)
    return Gate(fit.effects, tuple(best.values()), float(adjusted.min()), level)
