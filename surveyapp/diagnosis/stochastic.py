"""The stochastic rivals: noise that wanders can look like any effect.

Random walk of north, random walk of the amplitude, and an autoregressive process, each with white
noise beside it. The white part is never smaller than the rounding of the readings and the first
point has a variance of its own, else the likelihood runs away. Averaged over grids of variance
ratios and correlations; every covariance is factorised once per set of positions.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.wander_shapes import decay_of, walk_of
from surveyapp_models.arrays import Floats

NoiseKind = Literal["random_walk", "amplitude_walk", "ar1"]

RATIOS = tuple(float(r) for r in np.geomspace(0.01, 30.0, 12))
"""Variance of one step of the walk relative to the white noise."""
CORRELATIONS: tuple[float, ...] = (-0.8, -0.5, 0.3, 0.5, 0.7, 0.85, 0.95)
"""Correlation of neighbours of the autoregressive process."""
SHARES = (0.5, 2.0, 8.0, 1e4)
"""Variance of the autoregressive process relative to the white noise; the last is pure AR(1)."""
SIGNALS = np.geomspace(0.05, 30.0, 12)
"""Mean square that a column of an effect adds to an observation relative to the white noise: where
an effect can be seen at all, to where it cannot be missed."""
MANY = 3
"""Effects at once from which the grid of their sizes is thinned to every second value."""
LARGE = 100
"""From this size on the grids are thinned to every second value."""
NEGLIGIBLE = 0.005
"""Probability below which a point of the grid is left out of what is predicted."""
EXTRA_PARAMETERS = {"random_walk": 1.0, "amplitude_walk": 1.0, "ar1": 2.0}


@dataclass(frozen=True, slots=True)
class NoiseModel:
    """One covariance on the grid, whitened: W C W' = 1.

    Parameters
    ----------
    kind : str
    point : tuple of float
        Ratio, or correlation and share.
    process : ndarray, shape (n, n)
        Covariance of the process in units of the white variance.
    whitener : ndarray, shape (n, n)
    log_determinant : float
        Of the whole covariance in units of the white variance.
    """

    kind: NoiseKind
    point: tuple[float, ...]
    process: Floats
    whitener: Floats
    log_determinant: float


_CACHE: dict[bytes, tuple[NoiseModel, ...]] = {}


def noise_models(problem: Case) -> tuple[NoiseModel, ...]:
    """All covariances of the stochastic rivals for the positions of a problem."""
    key = hashlib.sha256()
    for part in (problem.position, problem.root_weights):
        key.update(np.ascontiguousarray(part).tobytes())
    key.update(b"swing" if problem.side is None else problem.side.tobytes())
    key.update(b"one" if problem.series is None else problem.series.tobytes())
    found = _CACHE.get(key.digest())
    if found is None:
        found = _build(problem)
        if len(_CACHE) >= 16:
            _CACHE.pop(next(iter(_CACHE)))
        _CACHE[key.digest()] = found
    return found


def _build(problem: Case) -> tuple[NoiseModel, ...]:
    n, root = problem.size, problem.root_weights
    rank = _scaled_position(problem.position)
    series = np.zeros(n) if problem.series is None else problem.series
    own = (series[:, None] == series[None, :]).astype(np.float64)
    walk = own * walk_of(rank)
    lag = np.abs(np.subtract.outer(rank, rank))
    order = _order_within(rank, series)
    step = np.abs(np.subtract.outer(order, order))
    channels = [rank[series == one] for one in np.unique(series[np.isfinite(series)])]
    if any(np.unique(places).size < places.size for places in channels):
        lag = step  # equal moments are no knowledge of equal noise
    thin = slice(None, None, 2) if n >= LARGE else slice(None)
    models: list[tuple[NoiseKind, tuple[float, ...], Floats]] = []
    for ratio in RATIOS[thin]:
        models.append(("random_walk", (float(ratio),), ratio * walk))
        if problem.side is not None:
            sides = np.outer(problem.side, problem.side)
            # A north that moves at any phase f of the swing kicks the amplitude by cos(pi f):
            # averaged over f that is half the variance, alternating.
            models.append(("random_walk", (float(ratio),), ratio * walk * (1.0 + 0.5 * sides)))
            models.append(("amplitude_walk", (float(ratio),), ratio * walk * sides))
    for correlation in CORRELATIONS[thin]:
        # a negative correlation alternates from one observation to the next: it knows no time
        # between them, and only so is it a covariance where the positions are uneven
        decay = decay_of(lag if correlation > 0.0 else step, abs(correlation))
        if correlation < 0.0:
            decay = decay * np.where(step % 2.0 == 0.0, 1.0, -1.0)
        decay = decay * own
        models += [("ar1", (correlation, share), share * decay) for share in SHARES]
    whiteners, logs = _whitened([process for _, _, process in models], root, series)
    return tuple(
        NoiseModel(kind, point, process, w, float(log))
        for (kind, point, process), w, log in zip(models, whiteners, logs, strict=True)
    )


def _whitened(processes: list[Floats], root: Floats, series: Floats) -> tuple[Floats, Floats]:
    """Whiteners (g, n, n) of white noise and each process, and log determinants (g,).

    Channels know nothing of each other: each is factorised by itself.
    """
    n = root.size
    whiteners = np.zeros((len(processes), n, n))
    logs = np.zeros(len(processes))
    alone = np.flatnonzero(~np.isfinite(series))
    whiteners[:, alone, alone] = 1.0
    for one in np.unique(series[np.isfinite(series)]):
        rows = np.flatnonzero(series == one)
        block = np.ix_(rows, rows)
        outer = np.outer(root[rows], root[rows])
        stack = np.stack([np.eye(rows.size) + process[block] * outer for process in processes])
        lower = np.linalg.cholesky(stack)
        eye = np.broadcast_to(np.eye(rows.size), stack.shape)
        whiteners[np.ix_(np.arange(len(processes)), rows, rows)] = np.linalg.solve(lower, eye)
        logs += 2.0 * np.log(np.einsum("gii->gi", lower)).sum(axis=1)
    return whiteners, logs


def _order_within(rank: Floats, series: Floats) -> Floats:
    """Number of each observation within its own channel, by its position."""
    order = np.zeros(rank.size)
    for one in np.unique(series[np.isfinite(series)]):
        rows = np.flatnonzero(series == one)
        order[rows[np.argsort(rank[rows], kind="stable")]] = np.arange(rows.size)
    return order


def _scaled_position(position: Floats) -> Floats:
    """Positions with a median spacing of 1, so that the grids fit every record."""
    gaps = np.diff(np.sort(position))
    gaps = gaps[gaps > 0.0]
    spacing = float(np.median(gaps)) if gaps.size else 1.0
    return np.asarray((position - position.min()) / spacing)


@dataclass(frozen=True, slots=True)
class NoisePoint:
    """One covariance of the grid beside a design.

    Parameters
    ----------
    model : NoiseModel
    share : float
        Probability of this point within its kind, 1 in all.
    step : ndarray, shape (p,)
        Change of the parameters against least squares.
    white : float
        Variance of the white part [SI^2].
    cofactor : ndarray, shape (p, p)
        Covariance of the parameters in units of ``white``.
    """

    model: NoiseModel
    share: float
    step: Floats
    white: float
    cofactor: Floats


@dataclass(frozen=True, slots=True)
class NoiseFit:
    """One kind of noise beside a design, its whole grid in it.

    Parameters
    ----------
    kind : str
    gain : float
        Decrease of -2 log marginal likelihood against white noise, averaged over the grid.
    points : tuple of NoisePoint
        Those that carry the probability, likeliest first.
    """

    kind: NoiseKind
    gain: float
    points: tuple[NoisePoint, ...]


def best_noises(
    problem: Case,
    J: Floats,
    residual: Floats,
    *,
    scale: float,
    floor: float,
    rows: np.ndarray | None = None,
) -> tuple[NoiseFit, ...]:
    """Every kind of noise for the residuals of a design, by its marginal likelihood.

    The restricted likelihood (the parameters of the design integrated out) is averaged over the
    grid. The ordinary likelihood is no substitute: it underrates a noise that hides the very
    parameters that the design spends, and charges it for them in full.

    Source: Harville 1974, Biometrika 61, eq. 2: -2 log L = (n - p) log s^2 + log |C|
    + log |J' C^-1 J| + v' C^-1 v / s^2.

    Parameters
    ----------
    problem : Case
    J : ndarray, shape (n, p)
        Design (weighted, derivatives of the non-linear part).
    residual : ndarray, shape (n,)
    scale : float
        Unit in which the likelihood is counted [SI].
    floor : float
        Smallest white variance [SI^2].
    rows : ndarray of int, shape (n,), optional
        Observations that the design and the residuals are of, whole channels; all of them.

    Returns
    -------
    tuple of NoiseFit
    """
    models = noise_models(problem)
    basis, triangle, norms = _independent(J)
    part = slice(None) if rows is None else np.ix_(rows, rows)
    whiteners = np.stack([m.whitener[part] for m in models])
    seen = whiteners @ residual
    q, r = np.linalg.qr(whiteners @ basis)
    along = np.einsum("gnp,gn->gp", q, seen)
    left = np.einsum("gn,gn->g", seen, seen) - np.einsum("gp,gp->g", along, along)
    dof = residual.size - basis.shape[1]
    floor = max(floor, 1e-12 * scale**2)
    logs = np.array([m.log_determinant for m in models])
    logs += 2.0 * np.log(np.abs(np.einsum("gpp->gp", r))).sum(axis=1)
    white = np.maximum(left / dof, floor)
    minus = dof * np.log(white / scale**2) + logs + left / white - dof
    total = float(residual @ residual)
    mean = max(total / dof, floor)
    plain = dof * float(np.log(mean / scale**2)) + total / mean - dof
    back = np.linalg.pinv(triangle) @ np.linalg.inv(r) / norms[None, :, None]
    result = []
    for kind in dict.fromkeys(m.kind for m in models):
        own = np.array([g for g, m in enumerate(models) if m.kind == kind])
        weights = np.exp(-0.5 * (minus[own] - minus[own].min()))
        gain = plain - float(minus[own].min()) + 2.0 * float(np.log(weights.mean()))
        weights /= weights.sum()
        order = np.argsort(-weights, kind="stable")
        points = tuple(
            NoisePoint(
                models[own[i]],
                float(weights[i]),
                back[own[i]] @ along[own[i]],
                float(white[own[i]]),
                back[own[i]] @ back[own[i]].T,
            )
            for i in order
            if weights[i] >= NEGLIGIBLE
        )
        result.append(NoiseFit(kind, gain, points))
    return tuple(result)


def effect_gain(J: Floats, effect: Floats, residual: Floats, *, each: int, floor: float) -> float:
    """``effects_gain`` of one effect, ``effect`` of shape (n, k)."""
    return effects_gain(J, [effect], residual, each=each, floor=floor)


def effects_gain(
    J: Floats, effects: Sequence[Floats], residual: Floats, *, each: int, floor: float
) -> float:
    """What ``best_noises`` finds of effects whose coefficients are drawn, in place of noise.

    An effect of unknown size and a noise of unknown size are compared alike: the coefficients are
    normal, independent and for each effect of one variance, which is averaged over a grid.

    Parameters
    ----------
    J : ndarray, shape (n, p)
        Design beside which all stand (weighted).
    effects : sequence of ndarray, shape (n, k)
        Columns of each effect (weighted).
    residual : ndarray, shape (n,)
        Of the design alone.
    each : int
        Observations of a channel: the grid is of the mean square that a column adds to each.
    floor : float
        Smallest white variance [SI^2].

    Returns
    -------
    float
        Decrease of -2 log marginal likelihood against white noise.
    """
    basis, _, _ = _independent(J)
    parts = []
    for effect in effects:
        left = effect - basis @ (basis.T @ effect)
        sizes = np.sum(left**2, axis=0)
        seen = sizes > 1e-12 * np.sum(effect**2, axis=0)
        if seen.any():
            parts.append(left[:, seen] * np.sqrt(each / float(np.mean(sizes[seen]))))
    if not parts:
        return 0.0
    q, r = np.linalg.qr(np.hstack(parts))
    member = np.repeat(np.arange(len(parts)), [part.shape[1] for part in parts])
    sizes = SIGNALS if len(parts) < MANY else SIGNALS[::2]
    grid = np.stack(np.meshgrid(*[sizes] * len(parts), indexing="ij"), axis=-1)
    variances = grid.reshape(-1, len(parts))[:, member]
    covariance = np.eye(r.shape[0]) + (r * variances[:, None, :]) @ r.T
    along = q.T @ residual
    dof = residual.size - basis.shape[1]
    total = float(residual @ residual)
    explained = np.einsum(
        "i,gi->g", along, np.linalg.solve(covariance, along[None, :, None])[..., 0]
    )
    squares = np.append(total, total - float(along @ along) + explained)
    white = np.maximum(squares / dof, floor)
    minus = dof * np.log(white) + squares / white
    minus[1:] += np.linalg.slogdet(covariance)[1]
    least = float(minus[1:].min())
    return float(minus[0] - least + 2.0 * np.log(np.exp(-0.5 * (minus[1:] - least)).mean()))


def _independent(J: Floats) -> tuple[Floats, Floats, Floats]:
    """Orthonormal basis (n, r), triangle (r, p) and column norms (p,) of a design."""
    norms = np.sqrt((J**2).sum(axis=0))
    norms = np.where(norms > 0.0, norms, 1.0)
    u, s, vt = np.linalg.svd(J / norms, full_matrices=False)
    use = s > 1e-9 * s[0]
    return u[:, use], s[use, None] * vt[use], norms
