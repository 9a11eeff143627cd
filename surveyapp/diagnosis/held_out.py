"""The proof: how a model predicts what did not choose it.

Leave-one-out with every grid weighed anew in each fold, the last quarter of the record from the
first three, and a second, independent set of observations.
"""

from __future__ import annotations

import dataclasses
import math

import numpy as np
from numpy.typing import NDArray

from surveyapp.diagnosis.candidates import Candidate, swing_columns
from surveyapp.diagnosis.case import Case, unit_variance
from surveyapp.diagnosis.fits import Fit, Member, fit_members, independent
from surveyapp.diagnosis.swing import fit_swing, starting_values
from surveyapp_models.arrays import Floats

FOLD_POSITIONS = 8
"""Grid points of each member, next to its own on the grid, among which a fold may choose."""
LEAST_CONTROL = 0.1
"""Redundancy below which an observation determines an effect by itself: the others foretell it to
worse than three times their own scatter, which is no prediction."""
FORECAST_SHARE = 0.75
"""Share of the record from which the rest is predicted."""


def flagged(fit: Fit) -> Floats:
    """Observations that the fit takes for gross errors, as a mask (n,) of 0 and 1."""
    mask = np.zeros(fit.residual.size)
    for member in fit.members:
        effect = member.candidate.effect
        if (effect is not None and effect.acts_on == "observation") or (
            member.candidate.id == "outlier"
        ):
            mask = np.maximum(mask, (np.abs(member.columns).max(axis=1) > 0.0).astype(float))
    return mask


def uncontrolled(problem: Case) -> Floats:
    """Observations that no other one controls, as a mask (n,): the result's own of a traverse."""
    q, _ = np.linalg.qr(problem.base * problem.root_weights[:, None])
    return np.asarray(1.0 - np.einsum("np,np->n", q, q) < 1e-6, dtype=np.float64)


def _alternatives(problem: Case, fit: Fit) -> list[Fit]:
    found = [fit]
    for member in fit.members:
        points = len(member.candidate.points)
        if points < 2 or member.candidate.count > 1:
            continue
        distance = [abs(g - member.g) for g in range(points)]
        near = np.argsort(distance, kind="stable")[1 : FOLD_POSITIONS + 1]
        for g in near:
            swapped = [Member(m.candidate, int(g)) if m is member else m for m in fit.members]
            if not independent(problem, swapped):
                continue
            found.append(fit_members(problem, swapped, fit.theta))
    return found


def leave_one_out(problem: Case, fit: Fit, skip: Floats | None = None) -> float | None:
    """Root mean square error [SI] of predicting each observation from the others.

    Parameters
    ----------
    problem : Case
    fit : Fit
    skip : ndarray, shape (n,), optional
        1 where an observation is not predicted (gross errors), in addition to the fit's own.

    Returns
    -------
    float or None
        None where no observation can be left out. Gross errors and observations that alone
        determine an effect are not predicted; see ``unforetold``.
    """
    errors, left = [], []
    for trial in _alternatives(problem, fit):
        if problem.groups is not None:
            error, rest = _without_groups(trial, problem.groups)
            errors.append(error)
            left.append(rest)
            continue
        q, _ = np.linalg.qr(trial.design)
        free = 1.0 - np.einsum("np,np->n", q, q)
        usable = free > LEAST_CONTROL
        error = trial.residual / np.where(usable, free, 1.0)
        errors.append(np.where(usable, error, np.inf))
        left.append(trial.sum_of_squares - np.where(usable, error * trial.residual, 0.0))
    found = np.array(errors)
    error = _foretold(problem, found, np.array(left)) / problem.root_weights
    mask = flagged(fit) if skip is None else np.maximum(flagged(fit), skip)
    mask = np.maximum(mask, uncontrolled(problem))
    error = error[(mask < 0.5) & np.isfinite(found).any(axis=0)]
    if error.size == 0:
        return None
    return float(np.sqrt(np.mean(error**2)))


def _without_groups(trial: Fit, groups: Floats) -> tuple[Floats, Floats]:
    """Errors of each group predicted from the others, and the sum of squares of its fold.

    With the rows b left out the prediction errs by (I - Q_b Q_b')^-1 r_b (the block form of the
    leave-one-out identity); infinite where the others hardly determine it.
    """
    q, _ = np.linalg.qr(trial.design)
    error, left = np.full(q.shape[0], np.inf), np.full(q.shape[0], np.inf)
    for group in np.unique(groups):
        rows = np.flatnonzero(groups == group)
        free = np.eye(rows.size) - q[rows] @ q[rows].T
        if float(np.linalg.eigvalsh(free)[0]) <= LEAST_CONTROL:
            continue
        error[rows] = np.linalg.solve(free, trial.residual[rows])
        left[rows] = trial.sum_of_squares - float(trial.residual[rows] @ error[rows])
    return error, left


def unforetold(fit: Fit) -> Floats:
    """Observations that a fit does not predict, as a mask (n,): flagged, or alone."""
    q, _ = np.linalg.qr(fit.design)
    alone = 1.0 - np.einsum("np,np->n", q, q) <= LEAST_CONTROL
    return np.asarray(np.maximum(flagged(fit), alone.astype(np.float64)))


def _foretold(problem: Case, errors: Floats, left: Floats) -> Floats:
    """Error of each observation, foretold by the grid points that its own fold makes likely.

    Parameters
    ----------
    problem : Case
    errors : ndarray, shape (g, n)
        Of each grid point; infinite where it is not determined without the observation.
    left : ndarray, shape (g, n)
        Sum of squares of the fold.

    Returns
    -------
    ndarray, shape (n,)
    """
    size = problem.size - 1
    floor = max(problem.noise_floor**2, (1e-6 * problem.scale) ** 2)
    known = unit_variance(problem)
    minus = left / known if known is not None else size * np.log(np.maximum(left / size, floor))
    minus = np.where(np.isfinite(errors), minus, np.inf)
    least = minus.min(axis=0)
    weights = np.exp(-0.5 * (minus - np.where(np.isfinite(least), least, 0.0)))
    total = weights.sum(axis=0)
    mean = np.sum(weights * np.where(np.isfinite(errors), errors, 0.0), axis=0)
    return np.where(total > 0.0, mean / np.where(total > 0.0, total, 1.0), np.inf)


def _subset(problem: Case, rows: NDArray[np.intp]) -> Case:
    def cut(values: Floats | None) -> Floats | None:
        return None if values is None else values[rows]

    return dataclasses.replace(
        problem,
        observations=problem.observations[rows],
        base=problem.base[rows],
        value_weights=problem.value_weights[rows],
        position=problem.position[rows],
        columns={k: v[rows] for k, v in problem.columns.items()},
        side=cut(problem.side),
        half_swing=cut(problem.half_swing),
        sigma=cut(problem.sigma),
        series=cut(problem.series),
        reported=cut(problem.reported),
        own_scales=(),
    )


def forecast(problem: Case, fit: Fit) -> float | None:
    """Root mean square error [SI] of predicting the last quarter from the first three.

    None where an effect of the fit cannot be determined from the first three quarters.
    """
    if not problem.ordered:
        return None
    n = problem.size
    first = math.floor(FORECAST_SHARE * n)
    order = np.argsort(problem.position, kind="stable")
    rows = np.sort(order[:first])
    if first <= fit.design.shape[1] + 1:
        return None
    part = _subset(problem, rows)
    members = []
    for m in fit.members:
        columns = m.candidate.columns[m.g : m.g + 1][:, rows]
        if (
            np.linalg.matrix_rank(np.hstack([part.base, columns[0]]))
            < part.base.shape[1] + columns.shape[2]
        ):
            return None
        members.append(Member(_single(m, columns), 0))
    if not independent(part, members):
        return None
    trained = fit_members(part, members, fit.theta)
    predicted = _predict(problem, fit.members, trained)
    rest = np.setdiff1d(np.arange(n), rows)
    return float(np.sqrt(np.mean((problem.observations - predicted)[rest] ** 2)))


def _single(member: Member, columns: Floats) -> Candidate:
    c = member.candidate
    return dataclasses.replace(
        c, points=(c.points[member.g],), columns=columns, charge=c.charge[member.g : member.g + 1]
    )


def _predict(problem: Case, members: tuple[Member, ...], trained: Fit) -> Floats:
    """Unweighted prediction of all observations of a problem from a fit to some of them."""
    root = problem.root_weights
    order = sorted(members, key=lambda m: m.candidate.is_law)
    additive = [m.columns / root[:, None] for m in order if not m.candidate.is_law]
    X = np.hstack([problem.base, *additive])
    predicted = X @ trained.linear
    if problem.side is None or problem.half_swing is None or trained.theta is None:
        return np.asarray(predicted)
    law = next((m for m in order if m.candidate.is_law), None)
    return np.asarray(
        predicted + problem.side * amplitude_of(problem.half_swing, trained.theta, law)
    )


def amplitude_of(half_swing: Floats, theta: Floats, law: Member | None) -> Floats:
    """Amplitude at each turning point under a law."""
    if law is None or law.candidate.effect is None or law.candidate.effect.law is None:
        return np.asarray(theta[0] * np.exp(-theta[1] * half_swing))
    first, decay, c = (theta[i : i + 1] for i in range(3))
    return law.candidate.effect.law(half_swing, first, decay, c, **law.point)


def confirm_rms(second: Case, fit: Fit | None) -> float | None:
    """Root mean square [SI] on a second set: effects as found on the first, base fitted anew.

    Parameters
    ----------
    second : Case
        Did not choose anything.
    fit : Fit or None
        Of the first set; None = the base model alone.

    Returns
    -------
    float or None
        None where the second set lacks what an effect needs.
    """
    start = None
    if second.side is not None and second.half_swing is not None:
        start = starting_values(second.observations, second.side, second.half_swing)
    if fit is None or fit.noise is not None:
        residual = fit_members(second, (), start).residual
        return float(np.sqrt(np.mean((residual / second.root_weights) ** 2)))
    named = swing_columns(second, start)
    shift, at = np.zeros(second.size), _base_size(fit)
    for member in fit.members:
        if member.candidate.is_law:
            continue
        size = member.candidate.size
        columns = _columns_on(second, member, named)
        if columns is None:
            return None
        shift = shift + columns @ fit.linear[at : at + size]
        at += size
    rest = second.observations - shift
    law = fit.law
    if law is None or fit.theta is None or second.side is None or second.half_swing is None:
        residual = fit_members(dataclasses.replace(second, observations=rest), (), start).residual
        return float(np.sqrt(np.mean((residual / second.root_weights) ** 2)))
    begin = starting_values(rest, second.side, second.half_swing)
    begin[2] = fit.theta[2]
    begin[1] = max(begin[1], -fit.theta[2])
    found = fit_swing(
        rest,
        second.base,
        side=second.side,
        half_swing=second.half_swing,
        start=begin,
        effect=law.candidate.effect,
        grid={k: np.array([[v]]) for k, v in law.point.items()},
        fixed=True,
    )
    return float(np.sqrt(found.sum_of_squares[0] / second.size))


def _base_size(fit: Fit) -> int:
    additive = sum(m.candidate.size for m in fit.members if not m.candidate.is_law)
    return fit.linear.size - additive


def _columns_on(second: Case, member: Member, named: dict[str, Floats]) -> Floats | None:
    """Columns of a member on another set, unweighted; None where they cannot be formed."""
    candidate, effect = member.candidate, member.candidate.effect
    if effect is None:
        if second.size != member.columns.shape[0]:
            return None
        return np.asarray(member.columns / second.root_weights[:, None])
    if any(need.name not in named for need in effect.needs):
        return None
    if any(not np.isfinite(named[need.name]).all() for need in effect.needs):
        return None
    if candidate.count == 1:
        return effect.basis(named, **member.point)
    parts = []
    for i in range(candidate.count):
        point = {
            k[: -len(f"_{i + 1}")]: v for k, v in member.point.items() if k.endswith(f"_{i + 1}")
        }
        parts.append(effect.basis(named, **point))
    return np.hstack(parts)
