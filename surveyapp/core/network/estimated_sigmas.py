"""The global test where sigmas were estimated from a few readings: F in the place of chi-square.

A sigma from f readings is itself in error by 1 / sqrt(2 f): eight readings leave 25 %, and v'Pv of
a sound traverse then misses chi-square bounds far more often than they say. Given the estimate,
the true variance is f / chi2(f) times it. With the share p of each estimate in the network's
redundancy, v'Pv / r is distributed as (p0 + sum p f / chi2(f)) chi2(r) / r; one estimate that holds
everything gives F(r, f) exactly, and none gives chi-square.

Source: share of a variance component in the redundancy: W. Foerstner (1979), ZfV 104, 149-156; its
degrees of freedom as of one estimate: F. E. Satterthwaite (1946), Biometrics Bulletin 2, 110-114.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from surveyapp.domain.observations import Observation
from surveyapp_models.arrays import Floats

_GRID: Final = 160
"""Quantiles that stand for one distribution; bounds agree with a table of F within 0.4 %."""
_TRACE: Final = 1e-6
"""Share below which an estimate plays no part."""


@dataclass(frozen=True, slots=True)
class Share:
    """Part of one estimate in the redundancy, and the degrees of freedom behind it.

    ``rest_assumed``: what no reading holds (centring, heights) is a mere assumption.
    """

    part: float
    dof: float
    rest_assumed: bool = False


def shares(observations: Sequence[Observation], control: Floats, dof: int) -> tuple[Share, ...]:
    """Share of each estimated sigma in the redundancy of a network.

    Parameters
    ----------
    observations : sequence of Observation
    control : float array, shape (observations,)
        Diagonal of P Qvv P; not a number or 0 where uncontrolled.
    dof : int
        Redundancy of the network.

    Returns
    -------
    tuple of Share
        Empty where no sigma was estimated.
    """
    found: dict[str, Share] = {}
    if dof <= 0:
        return ()
    for obs, weight in zip(observations, np.nan_to_num(control).tolist(), strict=True):
        if obs.estimated is not None:
            own = obs.estimated
            old = found.get(own.name, Share(0.0, own.dof))
            part = old.part + weight * own.variance / dof
            found[own.name] = Share(part, own.dof, own.rest_assumed)
    return tuple(item for item in found.values() if item.part > _TRACE)


def degrees(known: Sequence[Share]) -> float | None:
    """Degrees of freedom of all estimates together as of one (Satterthwaite); None without any."""
    total = sum(item.part**2 / item.dof for item in known)
    return 1.0 / total if total > 0.0 else None


def bounds(known: Sequence[Share], dof: int, probability: float) -> tuple[float, float]:
    """Two-sided bounds of the ratio of a-posteriori and a-priori sigma0.

    The lower one without what is a mere assumption: that there is less of it is no fault.

    Parameters
    ----------
    known : sequence of Share
        At least one.
    dof : int
        Redundancy of the network.
    probability : float
    """
    alpha = 1.0 - probability
    rest = max(1.0 - sum(item.part for item in known), 0.0)
    least = 0.0 if any(item.rest_assumed for item in known) else rest
    return (
        math.sqrt(_quantile(_inflation(known, least), dof, alpha / 2.0)),
        math.sqrt(_quantile(_inflation(known, rest), dof, 1.0 - alpha / 2.0)),
    )


def _inflation(known: Sequence[Share], rest: float) -> Floats:
    """Equally likely values of (true variance) / (stated variance) of the whole network."""
    from scipy.special import chdtri

    tails = (np.arange(_GRID) + 0.5) / _GRID
    found = np.full(1, rest)
    for item in known:
        if math.isinf(item.dof):
            found = found + item.part
            continue
        own = item.part * item.dof / chdtri(item.dof, tails)
        sums = np.sort(np.add.outer(found, own), axis=None)
        found = sums.reshape(_GRID, -1).mean(axis=1)
    return np.asarray(found, dtype=np.float64)


def _quantile(inflation: Floats, dof: int, probability: float) -> float:
    """Of inflation times chi2(dof) / dof, by bisection."""
    from scipy.special import chdtr

    low, high = 0.0, float(inflation.max()) * (10.0 + 40.0 / dof)
    for _ in range(60):
        middle = 0.5 * (low + high)
        if float(chdtr(dof, middle * dof / inflation).mean()) < probability:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)
