"""The loop on a sensor log: add the effect that the record asks for, prove it, go on.

A record is a table of block means (rows in time, channels); its base model and its effects are
linear in their coefficients. Each step compares every effect under every noise by BIC. An effect is
named where it beats the model without it, by ``MARGIN``, whatever the noise; where another effect
comes as near, neither is named.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from surveyapp.diagnosis.sensors.noise import Whitener, bic
from surveyapp.diagnosis.sensors.rule import MARGIN, MOST_EFFECTS, NEAR
from surveyapp_models.arrays import Floats


@dataclass(frozen=True, slots=True)
class Data:
    """What the loop fits.

    Parameters
    ----------
    observed : ndarray, shape (n, d)
    base : ndarray, shape (n, d, p)
    rivals : tuple of Whitener
        Noise under which every model is fitted; the first is white.
    """

    observed: Floats
    base: Floats
    rivals: tuple[Whitener, ...]


@dataclass(frozen=True, slots=True)
class Candidate:
    """An effect of a sensor record.

    Parameters
    ----------
    id : str
    designs : callable
        From the residual of the current model, shape (n, d), to what is to be tried: each a grid
        point and a design of shape (n, d, k).
    names, unit : tuple of str, str
        Of the k coefficients.
    searched : int
        Parameters of the grid.
    scale : float
        Printed value = coefficient times scale.
    rows : callable or None
        The design of a grid point row by row, shape (m, d, k); None = what holds for a block holds
        for each of its rows.
    possible : callable or None
        Whether coefficients, shape (k,), are any that a sensor can have; a model with others is
        none.
    """

    id: str
    designs: Callable[[Floats], Sequence[tuple[dict[str, float], Floats]]]
    names: tuple[str, ...]
    unit: str
    searched: int = 0
    scale: float = 1.0
    rows: Callable[[Mapping[str, float]], Floats] | None = None
    possible: Callable[[Floats], bool] | None = None


@dataclass(frozen=True, slots=True)
class Chosen:
    """An effect in the model at a grid point."""

    candidate: Candidate
    grid: dict[str, float]
    design: Floats


@dataclass(frozen=True, slots=True)
class LoopFit:
    """A model fitted under its best noise.

    Parameters
    ----------
    chosen : tuple of Chosen
    noise : str
    bic : float
    x : ndarray, shape (p,)
    covariance : ndarray, shape (p, p)
    residual : ndarray, shape (n, d)
        Observed minus fitted, not whitened.
    parameters : int
    """

    chosen: tuple[Chosen, ...]
    noise: str
    bic: float
    x: Floats
    covariance: Floats
    residual: Floats
    parameters: int

    @property
    def ids(self) -> tuple[str, ...]:
        """Effects of the model."""
        return tuple(c.candidate.id for c in self.chosen)


@dataclass(frozen=True, slots=True)
class Trial:
    """One candidate at one step: the BIC it gains, None where it could not be fitted."""

    id: str
    gain: float | None
    likelihood_ratio: float = 0.0
    extra: int = 1
    noise: str = "white"


@dataclass(frozen=True, slots=True)
class LoopResult:
    """What the loop found.

    Parameters
    ----------
    before, after, best : LoopFit
        ``best`` holds the best member of an ambiguous set too.
    trials : tuple of tuple of Trial
        Of each step.
    ambiguous : tuple of Trial
        Effects of the last step that none could be told from another, or from noise.
    steps : tuple of Trial
        What was taken at each step.
    doubted : tuple of str
        Effects that were taken out again: the field of the room may look like them.
    """

    before: LoopFit
    after: LoopFit
    best: LoopFit
    trials: tuple[tuple[Trial, ...], ...]
    ambiguous: tuple[Trial, ...] = ()
    steps: tuple[Trial, ...] = ()
    doubted: tuple[str, ...] = ()


Refine = Callable[[LoopFit], LoopFit]


def fit_model(
    data: Data, chosen: tuple[Chosen, ...], *, only_white: bool = False
) -> LoopFit | None:
    """Fit under every noise and keep the best by BIC.

    None where the design has a defect, or an effect coefficients that it cannot have.
    """
    observed = data.observed
    n, d = observed.shape
    design = np.concatenate([data.base, *(c.design for c in chosen)], axis=2)
    p = design.shape[2]
    if n * d <= p + 2:
        return None
    searched = sum(c.candidate.searched for c in chosen)
    best: tuple[float, Whitener, Floats, Floats, float] | None = None
    for white in data.rivals[: 1 if only_white else None]:
        a = white.apply(design).reshape(n * d, p)
        y = white.apply(observed).reshape(n * d)
        scale = np.sqrt(np.sum(a**2, axis=0))
        if np.any(scale <= 0.0):
            return None
        q, r = np.linalg.qr(a / scale)
        diagonal = np.abs(np.diag(r))
        if float(diagonal.min()) < 1e-8 * float(diagonal.max()):
            return None
        x = np.linalg.solve(r, q.T @ y) / scale
        rest = y - a @ x
        total = float(rest @ rest)
        value = bic(total, white, (n, d), p + searched)
        if best is None or value < best[0]:
            inverse = np.linalg.solve(r, np.eye(p)) / scale[:, None]
            best = (value, white, x, inverse @ inverse.T, total)
    if best is None or not _possible(chosen, best[2][data.base.shape[2] :]):
        return None
    value, white, x, cofactor, total = best
    variance = total / max(n * d - p, 1)
    residual = observed - design @ x
    return LoopFit(
        chosen, white.id, value, x, cofactor * variance, np.asarray(residual), p + searched
    )


def _possible(chosen: Sequence[Chosen], x: Floats) -> bool:
    """Whether every effect has coefficients that it can have."""
    start = 0
    for item in chosen:
        own = x[start : start + item.design.shape[2]]
        start += own.size
        if item.candidate.possible is not None and not item.candidate.possible(own):
            return False
    return True


def run_loop(
    data: Data,
    candidates: Sequence[Candidate],
    *,
    refine: Refine = lambda fit: fit,
) -> LoopResult:
    """Search the effects of a record.

    Parameters
    ----------
    data : Data
    candidates : sequence of Candidate
    refine : callable
        Finds in every model that is tried what the grid of an effect is too coarse for.

    Returns
    -------
    LoopResult
    """
    current = fit_model(data, ())
    if current is None:
        raise ValueError("the base model has a defect")
    before, history, steps = current, [], []
    ambiguous: tuple[Trial, ...] = ()
    best = current
    for _ in range(MOST_EFFECTS):
        fits = _tried(data, candidates, current, refine)
        trials = tuple(_trial(current, cid, fit) for cid, fit in fits.items())
        history.append(trials)
        ranked = sorted((t for t in trials if t.gain is not None), key=lambda t: -(t.gain or 0.0))
        if not ranked or (ranked[0].gain or 0.0) < MARGIN:
            break
        near = tuple(t for t in ranked if (t.gain or 0.0) > (ranked[0].gain or 0.0) - NEAR)
        top = fits[ranked[0].id]
        if top is None:
            break
        if len(near) > 1 and not _both(data, candidates, (top, near[1].id), refine):
            ambiguous, best = near, top
            break
        steps.append(ranked[0])
        current = best = _pruned(data, top)
    return LoopResult(before, current, best, tuple(history), ambiguous, tuple(steps))


def _tried(
    data: Data, candidates: Sequence[Candidate], current: LoopFit, refine: Refine
) -> dict[str, LoopFit | None]:
    found: dict[str, LoopFit | None] = {}
    for candidate in candidates:
        if candidate.id in current.ids:
            continue
        best: LoopFit | None = None
        for grid, design in candidate.designs(current.residual):
            fit = fit_model(data, (*current.chosen, Chosen(candidate, grid, design)))
            if fit is not None and (best is None or fit.bic < best.bic):
                best = fit
        found[candidate.id] = None if best is None else refine(best)
    return found


def _trial(current: LoopFit, identity: str, fit: LoopFit | None) -> Trial:
    if fit is None:
        return Trial(identity, None)
    extra = fit.parameters - current.parameters
    gain = current.bic - fit.bic
    ratio = gain + extra * math.log(current.residual.size)
    return Trial(identity, gain, ratio, max(extra, 1), fit.noise)


def _both(
    data: Data, candidates: Sequence[Candidate], pair: tuple[LoopFit, str], refine: Refine
) -> bool:
    """Whether the second effect is still there once the first is in the model."""
    first, second = pair
    candidate = next(c for c in candidates if c.id == second)
    fit = _tried(data, [candidate], first, refine)[second]
    return fit is not None and first.bic - fit.bic > MARGIN


def _pruned(data: Data, fit: LoopFit) -> LoopFit:
    """Without what a later effect has made needless."""
    for index in range(len(fit.chosen) - 1):
        rest = (*fit.chosen[:index], *fit.chosen[index + 1 :])
        without = fit_model(data, rest)
        if without is not None and without.bic < fit.bic + MARGIN:
            return _pruned(data, without)
    return fit
