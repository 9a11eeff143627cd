"""Priors learned from an archive of campaigns by expectation and maximization.

Each campaign says how likely it is under every cause and size; the shares that make the whole
archive most likely, held back a little by a Dirichlet prior, are the priors of the next campaign.

Source: prediction.md A.9; Dempster, Laird & Rubin (1977), J. R. Statist. Soc. B 39, 1-38.
"""

from __future__ import annotations

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
    """

    table: Floats
    sessions: int


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
    return Evidence(table, data.size)


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
    )
