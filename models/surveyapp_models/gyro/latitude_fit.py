"""Periods measured at several latitudes, fitted by the two constants that they depend on.

1/T1^2 = a cos(phi) and 1/T2^2 = a cos(phi) + b: linear in cos(phi), with a = 1/T1^2 and b = D's
share at the equator. Two constants say every period, lambda and C at every latitude. The fit uses
periods only; it does not know where they came from.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from surveyapp_models.gyro.estimates import Estimate


@dataclass(frozen=True, slots=True)
class MeasuredPeriod:
    """One period measured at one latitude.

    Parameters
    ----------
    kind : {"tracking", "clamped"}
        T1 or T2.
    latitude : float
        [rad].
    period_s, sigma_s : float
        Small-swing period and its standard deviation [s], both positive.
    """

    kind: Literal["tracking", "clamped"]
    latitude: float
    period_s: float
    sigma_s: float


@dataclass(frozen=True, slots=True)
class LatitudeLaw:
    """The two constants of an instrument with their covariance.

    Parameters
    ----------
    directive : float
        a [1/s2]: 1/T1^2 at the equator.
    torsion : float
        b [1/s2]: 1/T2^2 - 1/T1^2 at any latitude.
    covariance : tuple
        Covariance of (a, b) from the stated sigmas [1/s4], shape (2, 2).
    chi_square : float
        Weighted sum of squares of the residuals [-].
    dof : int
        Degrees of freedom; with 0 the fit passes through its two periods.
    """

    directive: float
    torsion: float
    covariance: tuple[tuple[float, float], tuple[float, float]]
    chi_square: float
    dof: int


def fit_latitude_law(periods: list[MeasuredPeriod]) -> LatitudeLaw:
    """Fit a and b to periods of both kinds by weighted least squares.

    Parameters
    ----------
    periods : list of MeasuredPeriod
        At least one of each kind; any latitudes.

    Returns
    -------
    LatitudeLaw

    Raises
    ------
    ValueError
        If a kind is missing, a sigma or period is not positive, or the torsion comes out negative.
    """
    for kind in ("tracking", "clamped"):
        if not any(period.kind == kind for period in periods):
            raise ValueError(f"no {kind} period is given: a and b cannot be told apart")
    if any(not (period.period_s > 0.0 and period.sigma_s > 0.0) for period in periods):
        raise ValueError("every period and every sigma must be positive")
    seconds = np.array([period.period_s for period in periods])
    sigma = 2.0 * np.array([period.sigma_s for period in periods]) / seconds**3
    design = np.array(
        [
            [math.cos(period.latitude), 1.0 if period.kind == "clamped" else 0.0]
            for period in periods
        ]
    )
    white, target = design / sigma[:, None], seconds**-2 / sigma
    orthogonal, triangle = np.linalg.qr(white)
    solution = np.linalg.solve(triangle, orthogonal.T @ target)
    if solution[1] < 0.0:
        raise ValueError(
            "the clamped periods are longer than the tracking ones: are they mixed up?"
        )
    half = np.linalg.solve(triangle, np.eye(2))
    covariance = half @ half.T
    residual = target - white @ solution
    return LatitudeLaw(
        directive=float(solution[0]),
        torsion=float(solution[1]),
        covariance=(
            (float(covariance[0, 0]), float(covariance[0, 1])),
            (float(covariance[1, 0]), float(covariance[1, 1])),
        ),
        chi_square=float(residual @ residual),
        dof=len(periods) - 2,
    )


def predicted_tracking_period(law: LatitudeLaw, latitude: float) -> Estimate:
    """Return T1 [s] at a latitude [rad] with its sigma."""
    inverse = law.directive * math.cos(latitude)
    return _with_sigma(law, inverse**-0.5, (-0.5 * inverse**-1.5 * math.cos(latitude), 0.0))


def predicted_clamped_period(law: LatitudeLaw, latitude: float) -> Estimate:
    """Return T2 [s] at a latitude [rad] with its sigma."""
    inverse = law.directive * math.cos(latitude) + law.torsion
    slope = -0.5 * inverse**-1.5
    return _with_sigma(law, inverse**-0.5, (slope * math.cos(latitude), slope))


def predicted_torsion_ratio(law: LatitudeLaw, latitude: float) -> Estimate:
    """Return lambda = b/(a cos(latitude)) [-] with its sigma."""
    moment = law.directive * math.cos(latitude)
    ratio = law.torsion / moment
    return _with_sigma(law, ratio, (-ratio / law.directive, 1.0 / moment))


def predicted_transit_coefficient(
    law: LatitudeLaw, latitude: float, *, scale_value: float
) -> Estimate:
    """Return C = (pi/2) mu T1^2/T2^3 [rad/(div s)]; ``scale_value`` is mu [rad/div]."""
    cosine = math.cos(latitude)
    inverse = law.directive * cosine + law.torsion
    value = 0.5 * math.pi * scale_value * inverse**1.5 / (law.directive * cosine)
    by_directive = value * (1.5 * cosine / inverse - 1.0 / law.directive)
    return _with_sigma(law, value, (by_directive, value * 1.5 / inverse))


def _with_sigma(law: LatitudeLaw, value: float, gradient: tuple[float, float]) -> Estimate:
    slope: NDArray[np.float64] = np.array(gradient)
    variance = float(slope @ np.array(law.covariance) @ slope)
    return Estimate(value, math.sqrt(max(variance, 0.0)))
