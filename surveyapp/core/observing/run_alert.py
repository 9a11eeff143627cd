"""Whether a run breaks the model, and how, while the surveyor still stands at the instrument.

After each reading the evidence of a mixture of troubles is weighed against that of the undisturbed
swing: a drift, a warm-up or a bent decay of the amplitude, a step of the midpoint, a break of the
decay, a single wrong reading, at every possible place. The alarm rings where the mixture is 20
times as likely. Because such a ratio is a fair game, a clean run reaches 20 at any time of its
whole length in at most one case of 20, however often one looks. This is a first alarm and proves
nothing; the proof is the business of ``surveyapp.diagnosis``.

Source: prediction.md E; Ville, J. (1939), Etude critique de la notion de collectif; Grunwald, de
Heide & Koolen (2024), Safe testing, J. R. Statist. Soc. B 86 (unknown variance); physics.md 2.7 and
section 4 (signatures in the two channels).
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Final

import numpy as np

from surveyapp.core.swing.gyrofit import DampedFit
from surveyapp_models.arrays import Floats

MIN_POINTS: Final = 6
"""N, A, damping and one more leave two degrees of freedom."""
LEVEL: Final = 0.05
"""Share of clean runs that alarm at any time, at most."""
SIZES: Final = (2.0, 8.0)
"""Prior standard deviations of a trouble, in those of a reading."""
STATED: Final = 8.0
"""Readings for which a stated standard deviation counts."""
SURE: Final = 0.5
"""Share of the suspected trouble below which none is suspected alone."""


class Trouble(StrEnum):
    """What may be wrong with a run."""

    DRIFT = "midpoint_drift"
    WARM_UP = "warm_up"
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
        UNCLEAR where no explanation is as likely as all others together.
    seq : int or None
        Row of the suspected reading, or of the first reading behind the break.
    index : int
        Number of that turning point (for a passage: of that passage; for a round: of that round),
        from 0.
    p : float
        Bound of the probability that a clean run ever shows as much, the search included.
    share : float
        How likely the suspected trouble is among all.
    """

    trouble: Trouble
    seq: int | None
    index: int
    p: float
    share: float = 1.0


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


WEIGHTS: Final = {
    Trouble.DRIFT: 0.15,
    Trouble.WARM_UP: 0.15,
    Trouble.STEP: 0.3,
    Trouble.GROSS_ERROR: 0.1,
    Trouble.DAMPING: 0.3,
}
"""Prior share of each trouble; its places share it equally. Others take a tenth each."""
TAUS: Final = (2.0, 4.0, 8.0)
"""Half swings in which a warm-up falls to 1/e."""

Candidates = tuple[Floats, list[tuple[Trouble, int]]]
"""Regressors, shape (n, m), and the trouble and place that each stands for."""
Found = tuple[Trouble, int, float, float]
"""Trouble, place, bound of the probability, share of the trouble."""


def find_trouble(
    fit: DampedFit, index: Floats, sides: Floats, *, sigma: float | None = None
) -> Found | None:
    """Search a run for the trouble that explains its residuals best.

    Parameters
    ----------
    fit : DampedFit
    index, sides : ndarray, shape (n,)
    sigma : float or None
        Stated standard deviation of a reading, in the unit of the fit.

    Returns
    -------
    (trouble, place, p, share) or None
        Place counts the readings; None where the run gives no alarm.
    """
    if index.size < MIN_POINTS or not fit.converged:
        return None
    basis = fit.jacobian(index, sides)
    return search(fit.residuals, basis, _candidates(index, sides), sigma=sigma)


def search(
    residuals: Floats, basis: Floats, candidates: Candidates, *, sigma: float | None = None
) -> Found | None:
    """Weigh the candidates together against the undisturbed model.

    Parameters
    ----------
    residuals : ndarray, shape (n,)
        Of equal weight.
    basis : ndarray, shape (n, p)
        Columns of the model.
    candidates : (ndarray of shape (n, m), list)
    sigma : float or None
        Stated standard deviation in the unit of the residuals; counts as much as eight readings.

    Returns
    -------
    (trouble, place, p, share) or None
        None where the mixture is not 20 times as likely.
    """
    evidence, names = _evidence(residuals, basis, candidates, sigma)
    if not names:
        return None
    top = float(evidence.max())
    terms = np.exp(evidence - top)
    total = top + float(np.log(terms.sum()))
    if total < -np.log(LEVEL):
        return None
    shares: dict[Trouble, float] = {}
    for (trouble, _), term in zip(names, terms.tolist(), strict=True):
        shares[trouble] = shares.get(trouble, 0.0) + term / float(terms.sum())
    likeliest = max(shares, key=lambda trouble: shares[trouble])
    own = [i for i, (trouble, _) in enumerate(names) if trouble is likeliest]
    place = names[max(own, key=lambda i: evidence[i])][1]
    p = float(np.exp(-min(total, 700.0)))
    share = shares[likeliest]
    return (likeliest if share >= SURE else Trouble.UNCLEAR), place, p, share


def _evidence(
    residuals: Floats, basis: Floats, candidates: Candidates, sigma: float | None
) -> tuple[Floats, list[tuple[Trouble, int]]]:
    """Log of prior share times likelihood ratio of each candidate, its size integrated out.

    The variance of a reading is not known, or known as from some readings: the ratio is that of
    Student distributions, and the prior size of a trouble is in units of it.
    """
    orthogonal = np.linalg.qr(basis)[0]
    columns, names = candidates
    scale = np.max(np.abs(columns), axis=0)
    columns = columns / np.where(scale > 0.0, scale, 1.0)
    columns = columns - orthogonal @ (orthogonal.T @ columns)
    square = np.sum(columns**2, axis=0)
    usable = square > 1e-12 * residuals.size
    columns, square = columns[:, usable], square[usable]
    names = [name for name, good in zip(names, usable.tolist(), strict=True) if good]
    left = residuals - orthogonal @ (orthogonal.T @ residuals)
    known = 0.0 if sigma is None else STATED
    total = float(left @ left) + known * (sigma or 0.0) ** 2
    if not names or total <= 0.0:
        return np.zeros(0), []
    along = (columns.T @ left) ** 2
    dof = known + residuals.size - basis.shape[1]
    ratios = []
    for size in SIZES:
        spread = 1.0 + size**2 * square
        explained = np.minimum(along * size**2 / spread / total, 1.0 - 1e-12)
        ratios.append(-0.5 * np.log(spread) - 0.5 * dof * np.log1p(-explained))
    top = np.maximum(*ratios)
    mean = top + np.log(sum(np.exp(r - top) for r in ratios) / len(SIZES))
    return mean + np.log(_prior(names)), names


def _prior(names: list[tuple[Trouble, int]]) -> Floats:
    """Prior share of each candidate, sum 1."""
    count: dict[Trouble, int] = {}
    for trouble, _ in names:
        count[trouble] = count.get(trouble, 0) + 1
    weight = np.array([WEIGHTS.get(trouble, 0.1) / count[trouble] for trouble, _ in names])
    return np.asarray(weight / weight.sum())


def _candidates(index: Floats, sides: Floats) -> Candidates:
    """Regressors of every trouble at every place it can have."""
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
    t = index - index[0]
    columns.append(t - t.mean())
    names.append((Trouble.DRIFT, 0))
    for tau in TAUS:
        columns.append(np.exp(-t / tau))
        names.append((Trouble.WARM_UP, 0))
    columns.append(sides * t**2)
    names.append((Trouble.DAMPING, 0))
    return np.column_stack(columns), names
