"""Priors learned from an archive of campaigns by expectation and maximization.

Each campaign says how likely it is under every cause and size; the shares that make the whole
archive most likely, held back a little by a Dirichlet prior, are the priors of the next campaign.

Source: prediction.md A.9; Dempster, Laird & Rubin (1977), J. R. Statist. Soc. B 39, 1-38.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from surveyapp.core.prediction.members import Determinations, members
from surveyapp.domain.priors import (
    AMPLITUDES,
    BASE,
    DEFAULT_PRIORS,
    GROSS,
    PAIRS,
    UNITS,
    Priors,
)
from surveyapp_models.arrays import Floats

DIRICHLET = 0.3
"""Campaigns that each unit is given beforehand."""
ROUNDS = 300
SIZELESS = frozenset({BASE, GROSS, PAIRS})
_FLAT = Priors(
    {unit: 1.0 / len(UNITS) for unit in UNITS}, (1.0 / len(AMPLITUDES),) * len(AMPLITUDES)
)


@dataclass(frozen=True, slots=True)
class Evidence:
    """What one campaign says: its likelihood under each unit and size.

    Parameters
    ----------
    table : ndarray, shape (units, sizes)
        Log mean likelihood; -inf where the campaign lacks the columns. A unit without sizes has
        the same number in every column.
    sessions : int
    excess, spread : float
        Of the scatter beside the stated sigmas: what the weighted squares have too much [1], and
        what a variance of 1 rad^2 would add to them [rad^-2] (DerSimonian & Laird 1986, Control.
        Clin. Trials 7, 177-188, equation 8).
    """

    table: Floats
    sessions: int
    excess: float = 0.0
    spread: float = 0.0


def evidence_of(data: Determinations) -> Evidence:
    """Likelihood of a campaign under every unit and size."""
    found = members(data, _FLAT)
    table = np.full((len(UNITS), len(AMPLITUDES)), -np.inf)
    units, sizes = np.array(found.units), np.array(found.sizes)
    # members of a unit and a size share its prior equally, whatever their number
    total = found.log_evidence + found.log_prior
    for i, unit in enumerate(UNITS):
        for k in range(len(AMPLITUDES)):
            own = total[(units == unit) & ((sizes == k) | (sizes < 0))]
            if own.size:
                prior = found.log_prior[(units == unit) & ((sizes == k) | (sizes < 0))]
                table[i, k] = _log_sum(own) - _log_sum(prior)
    return Evidence(table, data.size, *_excess(data))


def _excess(data: Determinations) -> tuple[float, float]:
    if data.sigmas is None or data.size < 2:
        return 0.0, 0.0
    w = data.sigmas**-2
    mean = float(w @ data.values / w.sum())
    excess = float(w @ (data.values - mean) ** 2) - (data.size - 1)
    return excess, float(w.sum() - w @ w / w.sum())


def _log_sum(values: Floats) -> float:
    top = float(values.max())
    return top + float(np.log(np.exp(values - top).sum()))


def learned(
    archive: Sequence[Evidence],
    *,
    origin: str,
    start: Priors = DEFAULT_PRIORS,
    strength: float = 0.0,
) -> Priors:
    """Priors that an archive makes most likely.

    Parameters
    ----------
    archive : sequence of Evidence
        One for each campaign.
    origin : str
        For people: which archive.
    start : Priors
        Where the iteration begins, and what the archive is held against.
    strength : float
        Campaigns that ``start`` counts for: a small archive moves it a little only.
    """
    tables = np.stack([item.table for item in archive])
    shares = np.array([start.share(unit) for unit in UNITS])
    sizes = np.array(start.sizes)
    sized = np.array([unit not in SIZELESS for unit in UNITS])
    held, held_sizes = DIRICHLET + strength * shares, DIRICHLET + strength * sizes
    for _ in range(ROUNDS):
        with np.errstate(divide="ignore"):
            log = tables + np.log(shares)[None, :, None] + np.log(sizes)[None, None, :]
        top = log.max(axis=(1, 2), keepdims=True)
        weight = np.exp(log - top)
        # what a campaign cannot tell for want of columns it leaves as it was
        able = np.isfinite(tables[:, :, 0])
        weight *= ((able * shares).sum(axis=1) / weight.sum(axis=(1, 2)))[:, None, None]
        rest = np.where(able, 0.0, shares)
        counts = weight.sum(axis=(0, 2)) + rest.sum(axis=0)
        shares = counts + held
        shares /= shares.sum()
        sizes = weight[:, sized].sum(axis=(0, 1)) + held_sizes
        sizes /= sizes.sum()
    return Priors(
        dict(zip(UNITS, shares.tolist(), strict=True)),
        tuple(sizes.tolist()),
        origin,
        sum(item.sessions for item in archive),
        _scatter(archive),
    )


def _scatter(archive: Sequence[Evidence]) -> float | None:
    """Standard deviation [rad] of the constant within campaigns, pooled over them."""
    spread = math.fsum(item.spread for item in archive)
    if spread <= 0.0:
        return None
    return math.sqrt(max(math.fsum(item.excess for item in archive) / spread, 0.0))
