"""The next turning point before it comes: when, on which side, at which reading, how surely.

The time comes from the period T1 at this latitude and from the moments of the points so far, the
reading from the points themselves. One model for both: what is known beforehand enters as an
observation with its own sigma. Nothing here knows a clock or a screen.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from surveyapp.core.statistics.distributions import student_quantile
from surveyapp.core.swing.gyrofit import DampedFit, fit_damped_swing
from surveyapp.domain.readings import Reading
from surveyapp_models.arrays import Floats

LOG_DECREMENT: Final = 0.015
LOG_DECREMENT_SIGMA: Final = 0.015
"""Damping before there are points to tell it: zeta 0.002 to 0.01 (physics.md 1.2), as pi zeta."""
STAMP_SIGMA_S: Final = 4.0
"""How exactly the moment of typing tells the moment of turning [s]; the times themselves refine it
from five points on. An estimate of habit, not of physics: it only widens the countdown."""
HELD: Final = 0.995
"""Quantile of the forecast: 99 % of clean readings lie inside, one in a hundred is asked about."""
PERIOD_SHARE: Final = 0.02
"""Doubt of a card's period at another latitude and spin, as a share of it (physics.md 1.2: one
degree of latitude is 0.5 to 2.4 %, one percent of spin is 0.5 %)."""
PERIOD_SHARE_ANYWHERE: Final = 0.15
"""The same where the latitude is not known: from 47 degrees to the equator T2 loses 15 %, to 60
degrees it gains 13 % (physics.md 1.2, table)."""


@dataclass(frozen=True, slots=True)
class PointForecast:
    """The next turning point.

    Parameters
    ----------
    index : int
        Its number, the first point being 0, missed ones counted.
    side : str
        R or L; empty where one reading alone tells none.
    reading : float or None
        Relative to the readings' origin, in their unit; None before there are two points.
    half_width : float or None
        Half-width of the 99 % interval; None where nothing tells a reading sigma.
    moment_s : float or None
        On the clock of the points.
    moment_half_width_s : float or None
        Half-width of the 95 % interval.
    """

    index: int
    side: Literal["L", "R", ""]
    reading: float | None
    half_width: float | None
    moment_s: float | None
    moment_half_width_s: float | None


def side_unknown(points: Sequence[Reading]) -> bool:
    """Whether nothing tells the sides yet: one reading may be either end, unless it is labelled."""
    return len(points) < 2 and all(point.side is None for point in points)


@dataclass(frozen=True, slots=True)
class Timing:
    """Moments of the turning points: moment = start + half period * index.

    Parameters
    ----------
    start_s, half_period_s : float
    covariance : ndarray, shape (2, 2)
        Of the two [s^2].
    stamp_sigma_s : float
        Of one moment.
    """

    start_s: float
    half_period_s: float
    covariance: Floats
    stamp_sigma_s: float

    def moment(self, index: float) -> tuple[float, float]:
        """Moment of a point [s] and the 1-sigma of its stamp."""
        row = np.array([1.0, index])
        variance = float(row @ self.covariance @ row) + self.stamp_sigma_s**2
        return self.start_s + self.half_period_s * index, math.sqrt(variance)


def period_share(latitude: float | None) -> float:
    """Doubt of a card's period at a latitude [rad], as a share of it."""
    return PERIOD_SHARE_ANYWHERE if latitude is None else PERIOD_SHARE


def fit_timing(
    index: Floats, moments: Floats, period_s: float | None, *, share: float = PERIOD_SHARE
) -> Timing | None:
    """Combine the known period with the moments of the points.

    Parameters
    ----------
    index, moments : ndarray, shape (n,)
        Numbers and moments [s] of the points that have one.
    period_s : float or None
        T1 at this latitude [s] (T2 of a clamped swing).
    share : float
        Its doubt, as a share of it.

    Returns
    -------
    Timing or None
        None without any point, or with one point and no period.
    """
    if index.size == 0 or (period_s is None and (index.size < 2 or index[-1] == index[0])):
        return None
    sigma = STAMP_SIGMA_S
    for _ in range(2):
        rows = [np.array([1.0, k]) / sigma for k in index.tolist()]
        right = [float(moment - moments[0]) / sigma for moment in moments.tolist()]
        if period_s is not None:
            doubt = 0.5 * share * period_s
            rows.append(np.array([0.0, 1.0 / doubt]))
            right.append(0.5 * period_s / doubt)
        basis, values = np.vstack(rows), np.array(right)
        solution = np.linalg.lstsq(basis, values, rcond=None)[0]
        residuals = sigma * (values - basis @ solution)[: index.size]
        if index.size < 5:
            break
        sigma = max(math.sqrt(float(residuals @ residuals) / (index.size - 2)), 0.5)
    inverse = np.linalg.pinv(basis)
    return Timing(
        start_s=float(moments[0] + solution[0]),
        half_period_s=float(solution[1]),
        covariance=inverse @ inverse.T,
        stamp_sigma_s=sigma,
    )


def forecast_reading(
    values: Floats,
    index: Floats,
    sides: Floats,
    *,
    next_index: int,
    sigma: float | None,
    dof: float,
) -> tuple[float | None, float | None]:
    """Reading of the next turning point and the half-width of its 99 % interval.

    Parameters
    ----------
    values, index, sides : ndarray, shape (n,)
        As in ``fit_damped_swing``.
    next_index : int
    sigma : float or None
        Standard deviation of one reading, None where nothing tells.
    dof : float
        Its degrees of freedom.

    Returns
    -------
    reading : float or None
        None with fewer than two points, or with points of one side only.
    half_width : float or None
    """
    if values.size < 2 or not (np.any(sides > 0) and np.any(sides < 0)):
        return None, None
    steps = next_index - index[-1]
    side = float(sides[-1]) * (-1.0 if round(steps) % 2 else 1.0)
    known = sigma if sigma is not None and math.isfinite(sigma) else None
    if values.size == 2:
        return _from_two(values, side_now=float(sides[-1]), side=side, sigma=known)
    fit = fit_damped_swing(values, index, sides)
    start = index - index[0]
    target = np.array([next_index - index[0]])
    row = fit.jacobian(target, np.array([side]))[0]
    decay = side * math.exp(-fit.log_decrement * float(target[0]))
    reading = fit.north + fit.amplitude * decay
    if known is None:
        return reading, None
    cofactor = _with_prior(fit, start, sides, known)
    variance = known**2 * (1.0 + float(row @ cofactor @ row))
    return reading, student_quantile(HELD, dof) * math.sqrt(variance)


def _with_prior(fit: DampedFit, index: Floats, sides: Floats, sigma: float) -> Floats:
    """Cofactor of (N, A, log decrement) with what is known of damping beforehand."""
    jacobian = fit.jacobian(index, sides)
    prior = np.array([[0.0, 0.0, sigma / LOG_DECREMENT_SIGMA]]) if sigma > 0.0 else np.zeros((1, 3))
    inverse = np.linalg.pinv(np.vstack([jacobian, prior]))
    return inverse @ inverse.T


def _from_two(
    values: Floats, *, side_now: float, side: float, sigma: float | None
) -> tuple[float, float | None]:
    """From the first two points: u3 = u1 - (u1 - u2)(1 - q), and u4 likewise from u2."""
    q = math.exp(-LOG_DECREMENT)
    first, second = float(values[0]), float(values[1])
    swing = first - second
    decay = 1.0 - q
    if side == side_now:
        reading = second + swing * q * decay
        slope, noise = swing * q, (q * decay, 1.0 - q * decay)
    else:
        reading = first - swing * decay
        slope, noise = swing * q, (1.0 - decay, decay)
    own = 0.0 if sigma is None else sigma
    variance = (slope * LOG_DECREMENT_SIGMA) ** 2
    variance += own**2 * (1.0 + noise[0] ** 2 + noise[1] ** 2)
    return reading, student_quantile(HELD, math.inf) * math.sqrt(variance)


def swing_curve(
    *, north: float, amplitude: float, log_decrement: float, first_side: float, index: Floats
) -> Floats:
    """The swing between its turning points: N + A s exp(-d k) cos(pi k) for real k.

    Parameters
    ----------
    north, amplitude : float
        Of the fit [rad].
    log_decrement : float
        Of the fit, a half swing [-].
    first_side : float
        +1 if point 0 stands on the right, else -1.
    index : ndarray, shape (m,)
        Positions in half swings.

    Returns
    -------
    ndarray, shape (m,)
    """
    decay = np.exp(-log_decrement * index)
    return north + amplitude * first_side * decay * np.cos(math.pi * index)
