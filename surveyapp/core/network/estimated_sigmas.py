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

_GRID: Final = 400
"""Quantiles that stand for one distribution; bounds of F agree with its table within 0.3 %."""
_TRACE: Final = 1e-6
"""Share below which an estimate plays no part."""


@dataclass(frozen=True, slots=True)
class Share:
    """Part of one estimate in the redundancy, and the degrees of freedom behind it."""

    part: float
    dof: float


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
            old = found.get(obs.estimated.name, Share(0.0, obs.estimated.dof))
            part = old.part + weight * obs.estimated.variance / dof
            found[obs.estimated.name] = Share(part, obs.estimated.dof)
    return tuple(item for item in found.values() if item.part > _TRACE)


def degrees(known: Sequence[Share]) -> float | None:
    """Degrees of freedom of all estimates together as of one (Satterthwaite); None without any."""
    total = sum(item.part**2 / item.dof for item in known)
    return 1.0 / total if total > 0.0 else None


def bounds(known: Sequence[Share], dof: int, probability: float) -> tuple[float, float]:
    """Two-sided bounds of the ratio of a-posteriori and a-priori sigma0.

    Parameters
    ----------
    known : sequence of Share
        At least one.
    dof : int
        Redundancy of the network.
    probability : float
    """
    inflation = _inflation(known)
    alpha = 1.0 - probability
    return tuple(  # type: ignore[return-value]
        math.sqrt(_quantile(inflation, dof, p)) for p in (alpha / 2.0, 1.0 - alpha / 2.0)
    )


def _inflation(known: Sequence[Share]) -> Floats:
    """Equally likely values of (true variance) / (stated variance) of the whole network."""
    from scipy.special import chdtri

    tails = (np.arange(_GRID) + 0.5) / _GRID
    rest = max(1.0 - sum(item.part for item in known), 0.0)
    found = np.full(1, rest)
    for item in known:
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
