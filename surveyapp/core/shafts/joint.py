"""Azimuths of one side by wires and gyro: least squares, never where they contradict."""

from __future__ import annotations

import math

import numpy as np

from surveyapp.core.statistics.distributions import chi_square_tail
from surveyapp.domain.shaft_result import JointAzimuth, SideAzimuth
from surveyapp_models.angles import wrap_two_pi
from surveyapp_models.arrays import Floats

LEVEL = 0.01
"""|difference| < 2.576 sigma is chi-square of one degree of freedom at 1 %."""
CRITICAL = 2.576


def joined(
    first: float, relative: Floats, covariance: Floats
) -> tuple[SideAzimuth | None, JointAzimuth]:
    """The gyro's azimuth of the side, and the combination of all.

    Parameters
    ----------
    first : float
        Azimuth by the wires [rad].
    relative : ndarray, shape (n,)
        Azimuths minus the first: 0, then one per gyro determination [rad].
    covariance : ndarray, shape (n, n)
        [rad^2].
    """
    if relative.size == 1:
        alone = SideAzimuth(wrap_two_pi(first), math.sqrt(float(covariance[0, 0])))
        return None, JointAzimuth(alone, None, 0, None)
    gyro_value, gyro_variance, _ = _mean(relative[1:], covariance[1:, 1:])
    gyro = SideAzimuth(wrap_two_pi(first + gyro_value), math.sqrt(gyro_variance))
    value, variance, chi2 = _mean(relative, covariance)
    dof = relative.size - 1
    alike = math.sqrt(chi2) < CRITICAL
    consistent = alike if dof == 1 else chi_square_tail(chi2, dof) >= LEVEL
    together = SideAzimuth(wrap_two_pi(first + value), math.sqrt(variance))
    return gyro, JointAzimuth(together if consistent else None, chi2, dof, consistent)


def _mean(values: Floats, covariance: Floats) -> tuple[float, float, float]:
    """Weighted mean of correlated values, its variance, and v'Pv."""
    ones = np.ones(values.size)
    weighted = np.linalg.solve(covariance, np.column_stack([ones, values]))
    variance = 1.0 / float(ones @ weighted[:, 0])
    mean = variance * float(ones @ weighted[:, 1])
    residual = values - mean
    chi2 = float(residual @ np.linalg.solve(covariance, residual))
    return mean, variance, chi2
