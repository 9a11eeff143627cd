"""Whether a run breaks the model, and how, while the surveyor still stands at the instrument.

The residuals of the damped swing are searched for three kinds of trouble at every possible place:
a single wrong reading, a step of the midpoint, a change of the amplitude's decay. The largest of
all these statistics is judged against its own null distribution, simulated for exactly this number
of points, so that the search is paid for: a clean run alarms in 1 % of cases. This is a first
alarm and proves nothing; the proof is the business of ``surveyapp.diagnosis``.

Source: physics.md 2.7 and section 4 (signatures in the two channels).
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Final

import numpy as np

from surveyapp.core.statistics.levels import LOUD
from surveyapp.core.swing.gyrofit import DampedFit
from surveyapp_models.arrays import Floats

MIN_POINTS: Final = 6
"""N, A, damping and one more leave two degrees of freedom."""
DRAWS: Final = 2000
SEPARATE_FROM: Final = 12
"""Points from which step and decay separate: below, the advice is to go on (design of issue 6)."""
CLOSE: Final = 2.0
"""Difference of n ln(v'v) below which two explanations count as equally good (Delta BIC of 2)."""


class Trouble(StrEnum):
    """What may be wrong with a run."""

    GROSS_ERROR = "gross_error"
    STEP = "midpoint_step"
    DAMPING = "damping_break"
    UNCLEAR = "unclear"
    MISSED = "passage_missed"
    MISTIMED = "passage_mistimed"


@dataclass(frozen=True, slots=True)
class Alert:
    """A run that breaks the model.

    Parameters
    ----------
    trouble : Trouble
        UNCLEAR where two explanations are equally good and more points would separate them.
    seq : int or None
        Row of the suspected reading, or of the first reading behind the break.
    index : int
        Number of that turning point (for a passage: of that passage; for a round: of that round),
        from 0.
    p : float
        Probability of so large a statistic, the search included, if nothing were wrong.
    """

    trouble: Trouble
    seq: int | None
    index: int
    p: float


def channels(residuals: Floats, sides: Floats) -> tuple[Floats, Floats]:
    """Residuals in the channels of midpoint and amplitude, one value for each neighbouring pair.

    Parameters
    ----------
    residuals : ndarray, shape (n,)
        Observed minus fitted.
    sides : ndarray, shape (n,)
        +1 right, -1 left.

    Returns
    -------
    midpoint, amplitude : ndarray, shape (n - 1,)
        Half the sum and half the difference (outwards positive) of neighbours.
    """
    first, second = residuals[:-1], residuals[1:]
    midpoint = 0.5 * (first + second)
    amplitude = 0.5 * (sides[:-1] * first + sides[1:] * second)
    return midpoint, amplitude


def find_trouble(
    fit: DampedFit, index: Floats, sides: Floats, rng: np.random.Generator
) -> tuple[Trouble, int, float] | None:
    """Search a run for the trouble that explains its residuals best.

    Parameters
    ----------
    fit : DampedFit
    index, sides : ndarray, shape (n,)
    rng : numpy.random.Generator
        For the null distribution.

    Returns
    -------
    (trouble, place, p) or None
        Place counts the readings; None where the run gives no alarm.
    """
    if index.size < MIN_POINTS or not fit.converged:
        return None
    basis = fit.jacobian(index, sides)
    return search(fit.residuals, basis, _candidates(index, sides), rng)


Candidates = tuple[Floats, list[tuple[Trouble, int]]]
"""Regressors, shape (n, m), and the trouble and place that each stands for."""


def search(
    residuals: Floats, basis: Floats, candidates: Candidates, rng: np.random.Generator
) -> tuple[Trouble, int, float] | None:
    """Search residuals of any linear model for the candidate that explains them best.

    Parameters
    ----------
    residuals : ndarray, shape (n,)
        Of equal weight.
    basis : ndarray, shape (n, p)
        Columns of the model.
    candidates : (ndarray of shape (n, m), list)
    rng : numpy.random.Generator

    Returns
    -------
    (trouble, place, p) or None
        None where the largest share is no larger than chance makes it.
    """
    size = residuals.size
    orthogonal = np.linalg.qr(basis)[0]
    columns, names = candidates
    columns = columns - orthogonal @ (orthogonal.T @ columns)
    norms = np.linalg.norm(columns, axis=0)
    usable = norms > 1e-8 * np.sqrt(size)
    columns, names = (
        columns[:, usable] / norms[usable],
        [name for name, good in zip(names, usable.tolist(), strict=True) if good],
    )
    shares = _shares(residuals[:, None], columns)[:, 0]
    noise = rng.standard_normal((size, DRAWS))
    noise -= orthogonal @ (orthogonal.T @ noise)
    null = _shares(noise, columns).max(axis=0)
    best = int(np.argmax(shares))
    p = float((1.0 + np.count_nonzero(null >= shares[best])) / (DRAWS + 1.0))
    if p > LOUD:
        return None
    trouble, place = names[best]
    rivals = [
        float(share)
        for (name, _), share in zip(names, shares.tolist(), strict=True)
        if name is not trouble
    ]
    if not rivals:
        return trouble, place, p
    gap = size * (np.log1p(-max(rivals)) - np.log1p(-min(float(shares[best]), 1.0 - 1e-12)))
    if gap < CLOSE and size < SEPARATE_FROM:
        return Trouble.UNCLEAR, place, p
    return trouble, place, p


def _shares(residuals: Floats, columns: Floats) -> Floats:
    """Share of v'v that each candidate explains, shape (candidates, draws)."""
    total = np.sum(residuals**2, axis=0)
    explained: Floats = (columns.T @ residuals) ** 2
    shares: Floats = explained / np.where(total > 0.0, total, 1.0)
    return shares


def _candidates(index: Floats, sides: Floats) -> Candidates:
    """Regressors of every trouble at every place: one point, two plateaus, two decays."""
    columns: list[Floats] = []
    names: list[tuple[Trouble, int]] = []
    for place in range(index.size):
        columns.append((index == index[place]).astype(np.float64))
        names.append((Trouble.GROSS_ERROR, place))
    for place in range(2, index.size - 1):
        columns.append((index >= index[place]).astype(np.float64))
        names.append((Trouble.STEP, place))
        columns.append(sides * np.maximum(index - index[place - 1], 0.0))
        names.append((Trouble.DAMPING, place))
    return np.column_stack(columns), names
