"""What nobody has seen: a later visit outside the range in which the determinations were made.

Inside their range determinations say that a cause does little; beyond it a member without that
cause claims that it does nothing at all. To such members, the base too, the second moment of the
coefficient is added that the determinations allow, times the distance from the edge of the range
(hardly any of it within 2 K, all of it from 6 K on): as if every instrument had an effect of the
size that the archive has taught, which these determinations have not shown. Many of them over a
wide range allow little. It changes no evidence, only the interval.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from surveyapp.core.prediction.kernels import COVARIATE_UNITS, TEMPERATURE_UNIT_K
from surveyapp.domain.priors import AMPLITUDES, Priors
from surveyapp_models.arrays import Floats

EDGE = 3.0 / 8.0
"""Distance from the range, in units of a cause, that may still be inside of it: air tells the
temperature of a gyro to some 3 K, and the extremes of a few determinations are no boundary."""
TEMPERATURE = frozenset({"temperature", "curve"})
COLUMNS = {
    "temperature_c": (TEMPERATURE, TEMPERATURE_UNIT_K),
    **{name: (frozenset({"covariate"}), unit) for name, unit in COVARIATE_UNITS.items()},
}
"""The causes that a column bears on, and what changes an effect of it by its size."""


@dataclass(frozen=True, slots=True)
class Unseen:
    """What one column adds beyond its range.

    Parameters
    ----------
    causes : frozenset of str
        A member with one of them has that coefficient itself: nothing is added to it.
    covariance : ndarray, shape (t, t)
        Between what is wanted, in squares of the median sigma.
    """

    causes: frozenset[str]
    covariance: Floats


def unseen(
    columns: Mapping[str, Floats], y: Floats, d: Floats, targets: Floats, *, priors: Priors
) -> list[Unseen]:
    """What lies beyond the range of each column.

    A cause that was named and taken out has a range of its own.

    Parameters
    ----------
    columns : mapping of ndarray, shape (n + q,)
        n determinations first.
    y, d : ndarray, shape (n,)
        Determinations and their variances, in median sigmas.
    targets : ndarray, shape (t, n + q)
    priors : Priors
    """
    n = y.size
    found = []
    variance = float(np.dot(priors.sizes, np.square(AMPLITUDES)))
    for name, (causes, unit) in COLUMNS.items():
        values = columns.get(name)
        if values is None or not np.isfinite(values).all():
            continue
        if all(priors.share(cause) <= 0.0 for cause in causes):
            continue
        low, high = float(values[:n].min()), float(values[:n].max())
        far = targets @ _outside((values - np.clip(values, low, high)) / unit)
        if np.any(far != 0.0):
            moment = _moment(values[:n] / unit, y, d, variance)
            found.append(Unseen(causes, moment * far[:, None] * far[None, :]))
    return found


def _outside(far: Floats) -> Floats:
    """Distances from the range, counted as surely as they lie outside of it."""
    return np.asarray(far * -np.expm1(-((far / EDGE) ** 2)))


def _moment(x: Floats, y: Floats, d: Floats, variance: float) -> float:
    """Second moment of a coefficient of x beside a flat constant, N(0, variance) beforehand."""
    w = 1.0 / d
    left, rest = (v - float(w @ v / w.sum()) for v in (x, y))
    spread = 1.0 / (float(w @ left**2) + 1.0 / variance)
    return float(spread + (spread * (w @ (left * rest))) ** 2)
