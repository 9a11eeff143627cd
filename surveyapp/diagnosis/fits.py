"""Models as values: a base model with a set of candidates in it, fitted by least squares.

A fit knows its design (with the derivatives of the non-linear part), its residuals, what was paid
for and the likelihood. It does not choose anything.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from surveyapp.diagnosis.candidates import Candidate
from surveyapp.diagnosis.case import Case, unit_variance
from surveyapp.diagnosis.course_error import beside, information_beside, larger_than_noise
from surveyapp.diagnosis.drawn import drawn_gain, is_drawn
from surveyapp.diagnosis.stochastic import EXTRA_PARAMETERS, NoiseFit, best_noises
from surveyapp.diagnosis.swing import fit_swing, starting_values, tangent, triangular
from surveyapp_models.arrays import Floats
from surveyapp_models.effects.recurrent import course_errors

DEPENDENT = 1e-6
"""Relative singular value below which columns are one and the same."""
SPOILT = 0.02
"""Share of the amplitude from which a residual may have bent the swing that was fitted."""


@dataclass(frozen=True, slots=True)
class Member:
    """A candidate at one of its grid points."""

    candidate: Candidate
    g: int

    @property
    def point(self) -> dict[str, float]:
        """Grid point."""
        return dict(self.candidate.points[self.g])

    @property
    def columns(self) -> Floats:
        """Weighted columns (n, q)."""
        return np.asarray(self.candidate.columns[self.g])

    @property
    def charge(self) -> float:
        """Parameters paid for."""
        return float(self.candidate.charge[self.g])


def odds_against(members: Iterable[Member]) -> float:
    """BIC that members are charged beforehand, one that occurs several times once."""
    return sum({m.candidate.id: m.candidate.odds for m in members}.values())


@dataclass(frozen=True, slots=True)
class Fit:
    """A fitted model.

    Parameters
    ----------
    members : tuple of Member
        Linear ones first, an amplitude law last.
    linear : ndarray
        Coefficients of the base and then of the linear members [SI].
    theta : ndarray, shape (3,), or None
        First amplitude, damping, coefficient of the law.
    design : ndarray, shape (n, p)
        Weighted: base, linear members, A, k, coefficient of the law.
    residual : ndarray, shape (n,)
        Weighted [SI].
    parameters : float
        Everything paid for.
    bic : float
        In units of the problem; each searched position counts one parameter.
    score : float
        The same with the scan paid for as the share of the grid that explains the record; what
        names are decided by. Equal to ``bic`` until it is worked out.
    noise : NoiseFit or None
        A stochastic rival beside the members.
    hidden : ndarray, shape (n, q), or None
        Orthonormal columns along which the fit errs by itself, by more than the noise: the error of
        a course that was saved from another run.
    """

    members: tuple[Member, ...]
    linear: Floats
    theta: Floats | None
    design: Floats
    residual: Floats
    parameters: float
    bic: float
    score: float
    noise: NoiseFit | None = None
    hidden: Floats | None = None

    @property
    def key(self) -> frozenset[str]:
        """Ids in the model, the noise's among them."""
        ids = {member.candidate.id for member in self.members}
        return frozenset(ids | ({self.noise.kind} if self.noise is not None else set()))

    @property
    def effects(self) -> tuple[str, ...]:
        """Ids in the order in which they are told."""
        ids = [member.candidate.id for member in self.members]
        unique = list(dict.fromkeys(ids))
        return (*unique, *((self.noise.kind,) if self.noise is not None else ()))

    @property
    def is_generic(self) -> bool:
        """Whether a shape or noise without a name takes part."""
        return self.noise is not None or any(m.candidate.kind == "shape" for m in self.members)

    @property
    def sum_of_squares(self) -> float:
        """V'Pv [SI^2], the weights having mean square 1."""
        return float(self.residual @ self.residual)

    @property
    def law(self) -> Member | None:
        """The member that changes the amplitude law."""
        return next((m for m in self.members if m.candidate.is_law), None)


def information(problem: Case, residual: Floats, parameters: float) -> float:
    """BIC = n log(v'Pv / n) + p log n, not below what rounding leaves; with known sigmas chi^2."""
    return float(bic_of(problem, np.array(residual @ residual), parameters))


def bic_of(problem: Case, rss: Floats, parameters: float | Floats) -> Floats:
    """BIC of sums of squares [SI^2]."""
    n = problem.size
    known = unit_variance(problem)
    if known is not None:
        return np.asarray(rss / known + parameters * np.log(n))
    floor = max(problem.noise_floor**2, (1e-6 * problem.scale) ** 2)
    mean = np.maximum(rss / n, floor)
    return np.asarray(n * np.log(mean / problem.scale**2) + parameters * np.log(n))


def fit_members(problem: Case, members: Iterable[Member], start: Floats | None = None) -> Fit:
    """Least squares of the base model with the given members at their grid points.

    Parameters
    ----------
    problem : Case
    members : iterable of Member
        At most one amplitude law.
    start : ndarray, shape (3,), optional
        First amplitude, damping, coefficient.

    Returns
    -------
    Fit
    """
    every = tuple(sorted(members, key=lambda m: m.candidate.is_law))
    additive = [m for m in every if not m.candidate.is_law]
    law = next((m for m in every if m.candidate.is_law), None)
    root = problem.root_weights
    y = problem.observations * root
    X = np.hstack([problem.base * root[:, None], *[m.columns for m in additive]])
    parameters = problem.base_parameters + sum(m.charge for m in every)
    if problem.side is None or problem.half_swing is None:
        q, r = np.linalg.qr(X)
        linear = triangular(r, q.T @ y) if X.shape[0] >= X.shape[1] else np.zeros(X.shape[1])
        residual = y - X @ linear
        bic = information(problem, residual, parameters) + odds_against(every)
        bic += drawn_charge(problem, every, X, linear=linear, residual=residual)
        return Fit(every, linear, None, X, residual, parameters, bic, bic)
    effect = None if law is None else law.candidate.effect
    point = {} if law is None else law.point
    if start is None:
        start = starting_values(problem.observations, problem.side, problem.half_swing)
    grid = {name: np.array([[value]]) for name, value in point.items()}
    side, half_swing = problem.side, problem.half_swing
    found = fit_swing(y, X, side=side, half_swing=half_swing, start=start, effect=effect, grid=grid)
    theta, linear = found.theta[0], found.linear[0]
    D = tangent(side=side, half_swing=half_swing, theta=theta, effect=effect, grid=point)
    amplitude = _amplitude(problem, theta, law)
    residual = y - X @ linear - problem.side * amplitude
    bic = information(problem, residual, parameters) + odds_against(every)
    fit = Fit(every, linear, theta, np.hstack([X, D]), residual, parameters, bic, bic)
    return _beside_courses(problem, fit)


def drawn_charge(
    problem: Case, members: Iterable[Member], X: Floats, *, linear: Floats, residual: Floats
) -> float:
    """What members whose coefficients are drawn cost beyond a parameter for each of these [BIC].

    All of them together: the order in which they came in decides nothing.
    """
    own, at = [], problem.base.shape[1]
    for member in members:
        if is_drawn(problem, member.candidate):
            own.append(np.arange(at, at + member.candidate.size))
        at += member.candidate.size
    if not own:
        return 0.0
    drawn = np.concatenate(own)
    others = np.delete(X, drawn, axis=1)
    q, _ = np.linalg.qr(others)
    without = residual + X[:, drawn] @ linear[drawn]
    without = without - q @ (q.T @ without)
    rss = np.array([without @ without, residual @ residual])
    worse, least = bic_of(problem, rss, 0.0).tolist()
    gain = drawn_gain(problem, others, [X[:, columns] for columns in own], without)
    return float(worse - least - gain - drawn.size * math.log(problem.size))


def _beside_courses(problem: Case, fit: Fit) -> Fit:
    """The fit with the errors of the saved courses in it counted, where there are any."""
    errors, at = [], problem.base.shape[1]
    for member in fit.members:
        effect, size = member.candidate.effect, member.candidate.size
        if effect is not None and effect.course and problem.half_swing is not None:
            errors.append(fit.linear[at] * course_errors(effect, problem.half_swing))
        at += size
    if not errors or unit_variance(problem) is not None:
        return fit
    hidden = beside(np.hstack(errors) * problem.root_weights[:, None], fit.design)
    bic = information_beside(
        fit.residual,
        hidden,
        parameters=fit.parameters,
        floor=problem.noise_floor**2,
        scale=problem.scale,
    )
    variance = fit.sum_of_squares / max(problem.size - fit.design.shape[1], 1)
    larger = larger_than_noise(hidden, variance)
    return dataclasses.replace(fit, bic=bic, score=bic, hidden=larger if larger.size else None)


def independent(problem: Case, members: Iterable[Member]) -> bool:
    """Whether the columns of the base and of all members beside it can be told apart."""
    root = problem.root_weights
    additive = [m.columns for m in members if not m.candidate.is_law]
    columns = np.hstack([problem.base * root[:, None], *additive])
    norms = np.sqrt((columns**2).sum(axis=0))
    if not (norms > 0.0).all() or columns.shape[0] < columns.shape[1]:
        return False
    s = np.linalg.svd(columns / norms, compute_uv=False)
    return bool(s[-1] > DEPENDENT * s[0])


def _amplitude(problem: Case, theta: Floats, law: Member | None) -> Floats:
    if problem.half_swing is None:
        return np.zeros(problem.size)
    if law is None or law.candidate.effect is None or law.candidate.effect.law is None:
        return np.asarray(theta[0] * np.exp(-theta[1] * problem.half_swing))
    first, decay, c = (theta[i : i + 1] for i in range(3))
    return law.candidate.effect.law(problem.half_swing, first, decay, c, **law.point)


def scan_law(
    problem: Case, candidate: Candidate, others: tuple[Member, ...], start: Floats
) -> Floats:
    """Sum of squares at each grid point of an amplitude law beside other members, shape (g,)."""
    if problem.side is None or problem.half_swing is None or candidate.effect is None:
        return np.zeros(0)
    root = problem.root_weights
    X = np.hstack([problem.base * root[:, None], *[m.columns for m in others]])
    names = tuple(candidate.points[0])
    grid = {k: np.array([[p[k]] for p in candidate.points]) for k in names}
    return fit_swing(
        problem.observations * root,
        X,
        side=problem.side,
        half_swing=problem.half_swing,
        start=start,
        effect=candidate.effect,
        grid=grid,
    ).sum_of_squares


def is_spoilt(fit: Fit) -> bool:
    """Whether residuals are so large that the swing itself may be fitted beside the truth.

    A slip of whole minutes bends amplitude and damping; what it takes away must then be fitted, not
    projected.
    """
    if fit.theta is None:
        return False
    return float(np.abs(fit.residual).max(initial=0.0)) > SPOILT * abs(float(fit.theta[0]))


def scan_exact(
    problem: Case, candidate: Candidate, others: tuple[Member, ...], start: Floats
) -> Floats:
    """Sum of squares at each grid point with the whole model fitted anew, shape (g,).

    Each fit begins at the best swing of the others, and at the one without what the point explains.
    """
    found = np.empty(len(candidate.points))
    for g in range(found.size):
        members = (*others, Member(candidate, g))
        hidden = np.abs(candidate.columns[g]).max(axis=1) > 0.0
        fits = [fit_members(problem, members, start)]
        if problem.side is not None and problem.half_swing is not None and (~hidden).sum() > 3:
            seen = (problem.observations[~hidden], problem.side[~hidden])
            clean = starting_values(*seen, problem.half_swing[~hidden])
            fits.append(fit_members(problem, members, clean))
        found[g] = min(fit.sum_of_squares for fit in fits)
    return found


def with_noise(problem: Case, fit: Fit) -> tuple[Fit, ...]:
    """The same model with each stochastic rival beside its members; none without any order."""
    if not problem.ordered:
        return ()
    if problem.sigma_known or problem.size <= fit.design.shape[1] + 2:
        return ()
    found = best_noises(
        problem,
        fit.design,
        fit.residual,
        scale=problem.scale,
        floor=problem.noise_floor**2,
    )
    # The grid of the noise is paid for by the average over it.
    return tuple(
        dataclasses.replace(
            fit,
            parameters=fit.parameters + EXTRA_PARAMETERS[noise.kind],
            bic=fit.bic - noise.gain,
            score=fit.score - noise.gain,
            noise=noise,
        )
        for noise in found
    )
