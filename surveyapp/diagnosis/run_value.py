"""The result under a model: the mean over the record, its sigma, and the average over models.

The value of a run is north averaged over the run; nothing ever moves it silently. Covariances
include the non-linear parameters, searched positions and what a stochastic model says.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from surveyapp.diagnosis.candidates import swing_columns
from surveyapp.diagnosis.case import Case, unit_variance
from surveyapp.diagnosis.fits import Fit, Member, fit_members, independent
from surveyapp.diagnosis.stochastic import NoiseKind, NoisePoint
from surveyapp_models.arrays import Floats

NEAR_POSITIONS = 6.0
"""BIC within which other positions of a searched effect contribute to its uncertainty."""
MOST_POSITIONS = 8
SHAPE_OBSERVATIONS = frozenset({"outlier"})


@dataclass(frozen=True, slots=True)
class Value:
    """A result with its uncertainty [SI].

    Parameters
    ----------
    value, sigma : float
    dof : float
        Degrees of freedom behind sigma; infinite where stated sigmas serve.
    """

    value: float
    sigma: float
    dof: float

    @property
    def interval95(self) -> float:
        """Half-width of the 95 % interval."""
        return self.sigma * t_quantile(0.975, self.dof)


def t_quantile(probability: float, dof: float) -> float:
    """Quantile of Student's t; normal for infinite degrees of freedom."""
    from scipy.special import ndtri, stdtrit

    if math.isinf(dof):
        return float(ndtri(probability))
    return float(stdtrit(dof, probability))


def effect_rows(problem: Case, member: Member, columns: Floats) -> Floats:
    """What the value takes of a member's columns, shape (q,)."""
    candidate = member.candidate
    effect = candidate.effect
    if candidate.describes_amplitude or candidate.id in SHAPE_OBSERVATIONS:
        return np.zeros(candidate.size)
    if effect is not None and effect.acts_on == "observation":
        return np.zeros(candidate.size)
    return np.asarray(problem.value_weights @ columns)


def _midpoint_columns(problem: Case, fit: Fit, member: Member) -> Floats:
    effect = member.candidate.effect
    if effect is not None and effect.midpoint is not None:
        return effect.midpoint(swing_columns(problem, fit.theta), **member.point)
    if member.candidate.midpoint is not None:
        return np.asarray(member.candidate.midpoint[member.g])
    return np.asarray(member.columns / problem.root_weights[:, None])


def midpoint_part(problem: Case, fit: Fit, member: Member) -> Floats:
    """What the value takes of a member that a fit does not hold, shape (q,)."""
    if member.candidate.is_law:
        return np.zeros(member.candidate.size)
    return effect_rows(problem, member, _midpoint_columns(problem, fit, member))


def functional(problem: Case, fit: Fit) -> Floats:
    """Row that makes the value of the parameters of a fit, shape (p,)."""
    parts = [problem.value_base]
    parts += [
        effect_rows(problem, m, _midpoint_columns(problem, fit, m))
        for m in fit.members
        if not m.candidate.is_law
    ]
    row = np.concatenate(parts)
    return np.concatenate([row, np.zeros(fit.design.shape[1] - row.size)])


def _grid_derivatives(problem: Case, fit: Fit) -> tuple[Floats, Floats]:
    """Columns of the continuous grid parameters (n, r), and what the value takes of them (r,)."""
    columns, rows = [], []
    at = problem.base.shape[1]
    named = swing_columns(problem, fit.theta)
    for member in fit.members:
        effect = member.candidate.effect
        if member.candidate.is_law:
            continue
        size = member.candidate.size
        coefficients = fit.linear[at : at + size]
        at += size
        if effect is None or member.candidate.count > 1:
            continue
        for parameter in effect.grid:
            if not parameter.continuous:
                continue
            point = member.point
            h = 1e-4 * max(abs(point[parameter.name]), 1e-6)
            up = effect.basis(named, **point | {parameter.name: point[parameter.name] + h})
            down = effect.basis(named, **point | {parameter.name: point[parameter.name] - h})
            column = (up - down) @ coefficients / (2.0 * h)
            columns.append(column * problem.root_weights)
            rows.append(float(problem.value_weights @ column))
    n = problem.size
    return (np.column_stack(columns) if columns else np.zeros((n, 0))), np.array(rows)


def _variance_factor(problem: Case, fit: Fit) -> tuple[float, float]:
    known = unit_variance(problem)
    if known is not None:
        return known, math.inf
    dof = max(problem.size - fit.parameters, 1.0)
    return max(fit.sum_of_squares / dof, problem.noise_floor**2), dof


def plain_value(problem: Case, fit: Fit, row: Floats | None = None) -> Value:
    """Value of a deterministic fit at its own grid point.

    ``row`` in place of the mean over the record: a state that the scanned parameters move by what
    they do to the coefficients alone (an asymptote is where the effect is gone).
    """
    extra, extra_row = _grid_derivatives(problem, fit)
    if row is None:
        row = functional(problem, fit)
    else:
        extra_row = np.zeros_like(extra_row)
    J = np.hstack([fit.design, extra])
    h = np.concatenate([row, extra_row])
    norms = np.sqrt((J**2).sum(axis=0))
    norms = np.where(norms > 0.0, norms, 1.0)
    _, s, vt = np.linalg.svd(J / norms, full_matrices=False)
    use = s > 1e-7 * s[0]
    along = (vt[use] @ (h / norms)) / s[use]
    factor, dof = _variance_factor(problem, fit)
    parameters = np.zeros(fit.design.shape[1])
    parameters[: fit.linear.size] = fit.linear
    return Value(float(row @ parameters), math.sqrt(factor * float(along @ along)), dof)


def _noise_value(problem: Case, fit: Fit) -> Value:
    """Value beside a stochastic rival, averaged over what is likely of its grid."""
    noise = fit.noise
    if noise is None:
        return plain_value(problem, fit)
    found = [_point_value(problem, fit, point, noise.kind) for point in noise.points]
    share = np.array([point.share for point in noise.points])
    share /= share.sum()
    values, variances = (np.array(part) for part in zip(*found, strict=True))
    mean = float(share @ values)
    variance = float(share @ (variances + (values - mean) ** 2))
    return Value(mean, math.sqrt(variance), _dof(problem, fit))


def _point_value(
    problem: Case, fit: Fit, point: NoisePoint, kind: NoiseKind
) -> tuple[float, float]:
    """Value and variance under one covariance: a walk of north is predicted, other is noise."""
    h = functional(problem, fit)
    parameters = np.zeros(fit.design.shape[1])
    parameters[: fit.linear.size] = fit.linear
    value = float(h @ (parameters + point.step))
    if kind != "random_walk":
        return value, point.white * float(h @ point.cofactor @ h)
    w = problem.value_weights
    whitener = point.model.whitener
    whitened = whitener @ (problem.root_weights * (point.model.process @ w))
    value += float(whitened @ (whitener @ (fit.residual - fit.design @ point.step)))
    gap = h - (whitener @ fit.design).T @ whitened
    spread = float(w @ point.model.process @ w) - float(whitened @ whitened)
    return value, point.white * (max(spread, 0.0) + float(gap @ point.cofactor @ gap))


def _dof(problem: Case, fit: Fit) -> float:
    return max(problem.size - fit.parameters, 1.0)


def value_of(problem: Case, fit: Fit) -> Value:
    """Value of a fit, the spread over other likely positions of searched effects included."""
    if fit.noise is not None:
        return _noise_value(problem, fit)
    central = plain_value(problem, fit)
    others = [
        (trial, plain_value(problem, trial))
        for member in fit.members
        for trial in neighbours(problem, fit, member)
    ]
    if not others:
        return central
    bics = np.array([fit.bic, *[trial.bic for trial, _ in others]])
    weights = np.exp(-0.5 * (bics - bics.min()))
    weights /= weights.sum()
    values = np.array([central.value, *[value.value for _, value in others]])
    spread = float(weights @ (values - central.value) ** 2)
    return Value(central.value, math.hypot(central.sigma, math.sqrt(spread)), central.dof)


def neighbours(problem: Case, fit: Fit, member: Member) -> tuple[Fit, ...]:
    """Fits with one member at the positions next to its best one that are about as likely."""
    candidate = member.candidate
    if len(candidate.points) < 2 or candidate.count > 1:
        return ()
    if candidate.effect is not None and all(g.continuous for g in candidate.effect.grid):
        return ()
    near = [g for g in range(len(candidate.points)) if 0 < abs(g - member.g) <= MOST_POSITIONS // 2]
    found = []
    for g in near:
        swapped = [Member(candidate, g) if m is member else m for m in fit.members]
        if not independent(problem, swapped):
            continue
        trial = fit_members(problem, swapped, fit.theta)
        if trial.bic < fit.bic + NEAR_POSITIONS:
            found.append(trial)
    return tuple(found)


def averaged_value(problem: Case, fits: Sequence[Fit]) -> Value:
    """Model average over sets of one depth, with the variance between the models.

    White, wandering and autocorrelated noise take part with equal odds, by their marginal
    likelihood: what is unattributed widens the result as far as the record speaks for it. The walk
    of a constant over a campaign is no knowledge of its mean and is left out there.
    """
    if not problem.has_swing:
        plain = [f for f in fits if f.noise is None or f.noise.kind != "random_walk"]
        fits = plain or fits
    bics = np.array([fit.score for fit in fits])
    weights = np.exp(-0.5 * (bics - bics.min()))
    weights /= weights.sum()
    keep = weights > 1e-3
    values = [value_of(problem, fit) for fit, k in zip(fits, keep, strict=True) if k]
    weights = weights[keep] / weights[keep].sum()
    middle = np.array([v.value for v in values])
    mean = float(weights @ middle)
    within = np.array([v.sigma**2 for v in values])
    variance = float(weights @ (within + (middle - mean) ** 2))
    finite = [v.dof for v in values]
    dof = math.inf if any(math.isinf(d) for d in finite) else float(weights @ np.array(finite))
    return Value(mean, math.sqrt(variance), dof)


def datum_values(problem: Case, fit: Fit) -> tuple[tuple[str, str, Value], ...]:
    """(effect, state, value) at the physical datum of the first effect that has one."""
    if fit.noise is not None:
        return ()
    named = swing_columns(problem, fit.theta)
    at = problem.base.shape[1]
    for member in fit.members:
        if member.candidate.is_law:
            continue
        effect, size = member.candidate.effect, member.candidate.size
        if effect is not None and effect.at_datum is not None and member.candidate.count == 1:
            states = effect.at_datum(named, problem.references, **member.point)
            rows = []
            for text, row in states:
                h = functional(problem, fit)
                h[at : at + size] = row
                rows.append((effect.id, text, plain_value(problem, fit, h)))
            return tuple(rows)
        at += size
    return ()


def rms(problem: Case, fit: Fit) -> float:
    """Root mean square of the unweighted residuals [SI]."""
    errors = fit.residual / problem.root_weights
    if problem.reported is not None:
        errors = errors[problem.reported > 0.0]
    return float(np.sqrt(np.mean(errors**2)))


def coefficients(problem: Case, fit: Fit) -> dict[str, tuple[Floats, Floats]]:
    """Coefficients of each member and their covariance [SI], by id (gross errors joined)."""
    factor, _ = _variance_factor(problem, fit)
    norms = np.sqrt((fit.design**2).sum(axis=0))
    unit = fit.design / np.where(norms > 0.0, norms, 1.0)
    cofactor = np.linalg.pinv(unit.T @ unit, rcond=1e-14, hermitian=True)
    covariance = factor * cofactor / np.outer(norms, norms)
    found: dict[str, list[int]] = {}
    at = problem.base.shape[1]
    for member in fit.members:
        size = member.candidate.size
        if member.candidate.is_law:
            index = [fit.design.shape[1] - 1]
        else:
            index = list(range(at, at + size))
            at += size
        found.setdefault(member.candidate.id, []).extend(index)
    every = np.concatenate([fit.linear, fit.theta if fit.theta is not None else np.zeros(0)])
    return {k: (every[i], covariance[np.ix_(i, i)]) for k, i in found.items()}


def plausible(problem: Case, fit: Fit) -> Iterable[str]:
    """Yield ids of members whose coefficients lie outside their physical range."""
    at = problem.base.shape[1]
    for member in fit.members:
        size = member.candidate.size
        if member.candidate.is_law:
            values = fit.theta[2:] if fit.theta is not None else np.zeros(0)
        else:
            values = fit.linear[at : at + size]
            at += size
        effect = member.candidate.effect
        if effect is None:
            continue
        for i, value in enumerate(values):
            c = effect.coefficients[i % len(effect.coefficients)]
            if not c.low - 1e-12 <= value / c.scale <= c.high + 1e-12:
                yield member.candidate.id
                break


def out_of_range(problem: Case, fit: Fit, name: str) -> bool:
    """Whether a coefficient is known to lie outside its physical range: by two of its sigmas.

    Where the record does not determine it that well, its value says nothing of the cause.
    """
    effect = next(m.candidate.effect for m in fit.members if m.candidate.id == name)
    found = coefficients(problem, fit).get(name)
    if effect is None or found is None:
        return True
    values, covariance = found
    sigmas = np.sqrt(np.maximum(np.diagonal(covariance), 0.0))
    for i, (value, sigma) in enumerate(zip(values, sigmas, strict=True)):
        c = effect.coefficients[i % len(effect.coefficients)]
        if value - 2.0 * sigma > c.high * c.scale or value + 2.0 * sigma < c.low * c.scale:
            return True
    return False
