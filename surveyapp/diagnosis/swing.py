"""Least squares of a swing: exponential or other amplitude law, with linear columns beside it.

The amplitude, its damping and the coefficient of an amplitude law are non-linear; everything else
is linear. Fits run for all grid points of a law at once. Damping is a loss: it is never negative.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Effect

Law = Callable[[Floats, Floats, Floats, Floats], Floats]
Mask = NDArray[np.bool_]

LARGEST_DECAY = 2.0
"""A swing that loses more than 86 % in a half swing is none."""
SINGULAR = 1e-12
"""Relative diagonal below which a triangle is singular."""
ITERATIONS = 40
CONVERGED = 1e-12
"""Relative change of the sum of squares at which the iteration ends."""


@dataclass(frozen=True, slots=True)
class SwingFit:
    """Result of a batch of g fits.

    Parameters
    ----------
    theta : ndarray, shape (g, 3)
        First amplitude, damping, coefficient of the law.
    linear : ndarray, shape (g, p)
    sum_of_squares : ndarray, shape (g,)
    """

    theta: Floats
    linear: Floats
    sum_of_squares: Floats


def exponential(half_swing: Floats, first: Floats, decay: Floats, coefficient: Floats) -> Floats:
    """A exp(-k t); the coefficient is not used."""
    return np.asarray(first * np.exp(-decay * half_swing) + 0.0 * coefficient)


def law_of(effect: Effect | None, grid: Mapping[str, Floats]) -> Law:
    """Amplitude law with its grid bound, or the exponential one."""
    if effect is None or effect.law is None:
        return exponential
    law = effect.law

    def bound(half_swing: Floats, first: Floats, decay: Floats, coefficient: Floats) -> Floats:
        return law(half_swing, first, decay, coefficient, **grid)

    return bound


def derivatives(law: Law, half_swing: Floats, theta: Floats, step: float) -> tuple[Floats, Floats]:
    """Amplitude (g, n) and its derivatives (g, n, 3) by central differences."""
    first, decay, c = (theta[:, i : i + 1] for i in range(3))
    value = law(half_swing, first, decay, c)
    h_first, h_decay = 1e-5 * np.maximum(np.abs(first), 1e-9), 1e-6
    d_first = (
        law(half_swing, first + h_first, decay, c) - law(half_swing, first - h_first, decay, c)
    ) / (2.0 * h_first)
    d_decay = (
        law(half_swing, first, decay + h_decay, c) - law(half_swing, first, decay - h_decay, c)
    ) / (2.0 * h_decay)
    d_c = (law(half_swing, first, decay, c + step) - law(half_swing, first, decay, c - step)) / (
        2.0 * step
    )
    return value, np.stack([d_first, d_decay, d_c], axis=-1)


def _bounded(theta: Floats, *, one_sided: bool, total: bool) -> Floats:
    theta = theta.copy()
    theta[:, 1] = np.clip(theta[:, 1], 0.0, LARGEST_DECAY)
    if one_sided:
        theta[:, 2] = np.maximum(theta[:, 2], 0.0)
    if total:  # damping before plus its change is a loss too
        theta[:, 2] = np.maximum(theta[:, 2], -theta[:, 1])
    return theta


def triangular(r: Floats, b: Floats) -> Floats:
    """Solve r x = b; where r is singular, the shortest solution."""
    diagonal = np.abs(np.diag(r))
    if diagonal.size and diagonal.min() <= SINGULAR * diagonal.max():
        return np.asarray(np.linalg.lstsq(r, b, rcond=SINGULAR)[0])
    return np.asarray(np.linalg.solve(r, b))


def _linear_part(y: Floats, X: Floats, swing: Floats) -> tuple[Floats, Floats]:
    """Best linear coefficients (g, p) and sums of squares (g,) beside a given swing."""
    rest = y - swing
    if X.shape[-1] == 0:
        return np.zeros((rest.shape[0], 0)), np.einsum("gn,gn->g", rest, rest)
    q, r = np.linalg.qr(X)
    projected = rest @ q
    left = rest - projected @ q.T
    return triangular(r, projected.T).T, np.einsum("gn,gn->g", left, left)


def _steps(residual: Floats, D: Floats, frozen: Mask) -> Floats:
    """Gauss-Newton steps (g, 3) from projected derivatives, frozen parameters kept."""
    D = np.where(frozen[:, None, :], 0.0, D)
    norms = np.sqrt(np.einsum("gnj,gnj->gj", D, D))
    norms = np.where(norms > 0.0, norms, 1.0)
    D = D / norms[:, None, :]
    normal = np.einsum("gni,gnj->gij", D, D)
    gradient = np.einsum("gni,gn->gi", D, residual)
    normal += np.eye(3) * np.where(frozen, 1.0, 1e-11)[:, None, :]
    return np.where(frozen, 0.0, np.linalg.solve(normal, gradient[..., None])[..., 0] / norms)


def fit_swing(
    y: Floats,
    X: Floats,
    *,
    side: Floats,
    half_swing: Floats,
    start: Floats,
    effect: Effect | None = None,
    grid: Mapping[str, Floats] | None = None,
    fixed: bool = False,
) -> SwingFit:
    """Fit y = X b + s a(t) for each grid point of an amplitude law.

    Parameters
    ----------
    y : ndarray, shape (n,)
    X : ndarray, shape (n, p)
        Linear columns shared by all grid points.
    side, half_swing : ndarray, shape (n,)
    start : ndarray, shape (3,)
        First amplitude, damping, coefficient.
    effect : Effect, optional
        With an amplitude law; without one the law is exponential and the coefficient stays 0.
    grid : mapping of ndarray, shape (g, 1)
    fixed : bool
        Keep the coefficient at its start.

    Returns
    -------
    SwingFit
    """
    grid = grid or {}
    count = next(iter(grid.values())).shape[0] if grid else 1
    law = law_of(effect, grid)
    one_sided = effect is not None and effect.one_sided
    total = effect is not None and not effect.one_sided
    step = 1e-6 if effect is None else 1e-6 * _range(effect)
    theta = _bounded(np.tile(start, (count, 1)).astype(float), one_sided=one_sided, total=total)
    q = np.linalg.qr(X)[0] if X.shape[1] else X
    value, D = derivatives(law, half_swing, theta, step)
    linear, best = _linear_part(y, X, side * value)
    for _ in range(ITERATIONS):
        residual = y - side * value
        residual = residual - (residual @ q) @ q.T
        D = D * side[:, None]
        D = D - np.einsum("np,gpj->gnj", q, np.einsum("np,gnj->gpj", q, D))
        slope = np.einsum("gnj,gn->gj", D, residual)
        frozen = np.zeros_like(theta, dtype=bool)
        frozen[:, 1] = (theta[:, 1] <= 0.0) & (slope[:, 1] <= 0.0)
        if effect is None or fixed:
            frozen[:, 2] = True
        elif one_sided:
            frozen[:, 2] = (theta[:, 2] <= 0.0) & (slope[:, 2] <= 0.0)
        move = _steps(residual, D, frozen)
        factor = np.ones(count)
        new, rss = theta, best
        for _ in range(6):
            trial = _bounded(theta + factor[:, None] * move, one_sided=one_sided, total=total)
            swing = side * law(half_swing, trial[:, 0:1], trial[:, 1:2], trial[:, 2:3])
            beta, rss = _linear_part(y, X, swing)
            worse = rss > best * (1.0 + 1e-14)
            if not worse.any():
                break
            factor = np.where(worse, 0.25 * factor, factor)
        better = rss <= best
        new = np.where(better[:, None], trial, theta)
        linear = np.where(better[:, None], beta, linear)
        gain = float(np.max((best - np.where(better, rss, best)) / np.maximum(best, 1e-300)))
        theta, best = new, np.where(better, rss, best)
        value, D = derivatives(law, half_swing, theta, step)
        if gain < CONVERGED:
            break
    return SwingFit(theta, linear, best)


def _range(effect: Effect) -> float:
    coefficient = effect.coefficients[0]
    return (coefficient.high - coefficient.low) * coefficient.scale


def tangent(
    *,
    side: Floats,
    half_swing: Floats,
    theta: Floats,
    effect: Effect | None,
    grid: Mapping[str, float],
) -> Floats:
    """Derivatives of the reading by A, k and (with a law) its coefficient, shape (n, 2 or 3)."""
    law = law_of(effect, {name: np.array([[value]]) for name, value in grid.items()})
    step = 1e-6 if effect is None else 1e-6 * _range(effect)
    D = derivatives(law, half_swing, theta[None, :], step)[1][0]
    return np.asarray(side[:, None] * D[:, : 2 if effect is None else 3])


def starting_values(y: Floats, side: Floats, half_swing: Floats) -> Floats:
    """First amplitude, damping and 0, from a coarse scan of the damping."""
    decays = np.concatenate([[0.0], np.geomspace(1e-4, 0.5, 24)])
    columns = side * np.exp(-decays[:, None] * half_swing)
    apart = columns - columns.mean(axis=1, keepdims=True)
    along = apart @ y
    squares = np.maximum(np.einsum("dn,dn->d", apart, apart), 1e-300)
    best = int(np.argmax(along**2 / squares))  # what the swing explains beside a mean
    return np.array([along[best] / squares[best], decays[best], 0.0])
