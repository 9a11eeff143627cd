"""How well an adjustment is controlled: redundancies, tests, detectable biases, ellipses.

Everything comes from the needed parts of the cofactor matrix; nothing here solves a system.

Source: W. Baarda (1968), A testing procedure for use in geodetic networks; A. J. Pope (1976), The
statistics of residuals and the detection of outliers (tau); W. Niemeier (2008),
Ausgleichungsrechnung, ch. 9.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import NormalDist

import numpy as np

from surveyapp.core.leastsquares.equations import ElementGroup
from surveyapp.core.leastsquares.solution import Cofactor
from surveyapp.core.network.estimated_sigmas import Share, bounds, degrees
from surveyapp.domain.adjustment import Ellipse, GlobalTest
from surveyapp_models.arrays import Floats

TEST_LEVEL = 0.001
"""Level of the single test in the smallest detectable bias (Baarda's 0.1 %)."""
TEST_POWER = 0.8
"""Its power (Baarda's 80 %)."""
UNCONTROLLED = 1e-7
"""Redundancy below which an observation is uncontrolled: rounding of 1 - a'Qa stays below it."""


def noncentrality(level: float = TEST_LEVEL, power: float = TEST_POWER) -> float:
    """Square root of the noncentrality that a two-sided normal test detects; 4.13 by default."""
    normal = NormalDist()
    return normal.inv_cdf(1.0 - level / 2.0) + normal.inv_cdf(power)


@dataclass(frozen=True, slots=True)
class Quality:
    """Quality of each observation, a-priori scale; arrays of shape (rows,), nan = uncontrolled.

    Parameters
    ----------
    redundancy : float array
    standardized : float array
        Of the residual adjusted - observed, with the a-priori sigma0.
    sigma_adjusted : float array
    error : float array
        Estimate of a gross error in this observation alone.
    mdb : float array
        Smallest detectable bias.
    effect : float array
        Largest change of a coordinate of its own points by that bias [m].
    """

    redundancy: Floats
    standardized: Floats
    sigma_adjusted: Floats
    error: Floats
    mdb: Floats
    effect: Floats


def assess(
    groups: Sequence[ElementGroup], cofactor: Cofactor, rows: int, coordinate: Floats
) -> Quality:
    """Quality of all observations.

    Parameters
    ----------
    groups : sequence of ElementGroup
        At the solution.
    cofactor : Cofactor
    rows : int
        Number of observations.
    coordinate : float array, shape (unknowns + 1,)
        1 for unknowns that are coordinates, else 0; the last entry is 0.

    Returns
    -------
    Quality
    """
    result = np.full((6, rows), np.nan)
    delta = noncentrality()
    for group in groups:
        k = group.rows.shape[1]
        blocks = cofactor.blocks(group.unknowns)
        side = np.einsum("npq,nkq->npk", blocks, group.jacobian)
        hat = np.einsum("nkp,npj->nkj", group.jacobian, side)
        inverse = np.linalg.inv(group.root) if k > 1 else 1.0 / group.root
        rest = np.eye(k) - hat
        weighted = inverse.swapaxes(1, 2) @ rest @ inverse  # P Qvv P
        control = np.einsum("nkk->nk", weighted)
        weight = np.einsum("njk,njk->nk", inverse, inverse)
        residual = -np.einsum("njk,nj->nk", inverse, group.misclosure)  # P v
        good = control > UNCONTROLLED * weight
        safe = np.where(good, control, 1.0)
        place = group.rows
        result[0, place] = np.einsum("nij,njk,nki->ni", group.root, rest, inverse)
        result[1, place] = np.where(good, residual / np.sqrt(safe), np.nan)
        variance = np.einsum("nij,njk,nik->ni", group.root, hat, group.root)
        result[2, place] = np.sqrt(np.maximum(variance, 0.0))
        result[3, place] = np.where(good, -residual / safe, np.nan)
        mdb = np.where(good, delta / np.sqrt(safe), np.nan)
        result[4, place] = mdb
        effect = np.abs(side @ inverse) * coordinate[group.unknowns][:, :, None]
        result[5, place] = effect.max(axis=1, initial=0.0) * mdb
    return Quality(*result)


def control(mdb: Floats) -> Floats:
    """Diagonal of P Qvv P from smallest detectable biases; nan = uncontrolled."""
    return np.asarray((noncentrality() / mdb) ** 2, dtype=np.float64)


def global_test(
    sum_of_squares: float,
    dof: int,
    *,
    sigma_apriori: float,
    probability: float,
    estimated: Sequence[Share] = (),
) -> GlobalTest:
    """Test of the whole adjustment, two-sided: chi-square, or F where sigmas were estimated.

    Parameters
    ----------
    sum_of_squares : float
        Of whitened residuals.
    dof : int
    sigma_apriori, probability : float
    estimated : sequence of Share
        Of sigmas that were estimated from a few readings.

    Returns
    -------
    GlobalTest
        Without bounds and verdict where there are no degrees of freedom.
    """
    total = sum_of_squares * sigma_apriori**2
    if dof <= 0:
        return GlobalTest(total, sigma_apriori, None, None, None, probability, None)
    from scipy.special import chdtri

    ratio = math.sqrt(sum_of_squares / dof)
    if estimated:
        lower, upper = bounds(estimated, dof, probability)
        return GlobalTest(
            total,
            sigma_apriori,
            ratio,
            lower,
            upper,
            probability,
            lower <= ratio <= upper,
            degrees(estimated),
        )
    alpha = 1.0 - probability
    lower = math.sqrt(float(chdtri(dof, 1.0 - alpha / 2.0)) / dof)
    upper = math.sqrt(float(chdtri(dof, alpha / 2.0)) / dof)
    passed = lower <= ratio <= upper
    return GlobalTest(total, sigma_apriori, ratio, lower, upper, probability, passed)


def confidence_scale(probability: float, dof: int | None) -> float | None:
    """Factor from a standard ellipse to one of the given probability.

    Parameters
    ----------
    probability : float
    dof : int or None
        Degrees of freedom of an estimated sigma0; None where it is known beforehand.
    """
    if dof is None:
        return math.sqrt(-2.0 * math.log(1.0 - probability))
    if dof <= 0:
        return None
    # F(2, f) has the closed quantile f/2 ((1 - p)^(-2/f) - 1)
    return math.sqrt(dof * ((1.0 - probability) ** (-2.0 / dof) - 1.0))


def family_critical(
    tests: int, level: float, dof: int | None, *, sigma_dof: float | None = None
) -> float | None:
    """Critical value of the largest of many standardized residuals.

    Parameters
    ----------
    tests : int
        Distinct tests.
    level : float
        Probability that the largest exceeds the value although nothing is wrong (Bonferroni's
        bound over the tests: it holds whatever their correlation).
    dof : int or None
        Degrees of freedom where sigma0 is estimated from the same residuals (tau), else None.
    sigma_dof : float or None
        Degrees of freedom of sigmas that were estimated beforehand (Student), None where known.

    Returns
    -------
    float or None
        None where nothing can be tested (no tests, or tau with one degree of freedom).
    """
    if tests <= 0:
        return None
    if dof is None and sigma_dof is None:
        return NormalDist().inv_cdf(1.0 - level / (2.0 * tests))
    if dof is not None and dof <= 1:
        return None
    from scipy.special import stdtrit

    if dof is None:
        return float(stdtrit(sigma_dof, 1.0 - level / (2.0 * tests)))

    t = float(stdtrit(dof - 1, 1.0 - level / (2.0 * tests)))
    return math.sqrt(dof) * t / math.sqrt(dof - 1 + t * t)  # Pope (1976)


def distinct_tests(standardized: Floats) -> int:
    """Number of tests that are not copies of each other.

    Fully correlated tests have equal absolute values and cannot be told apart: they count once.
    """
    values = np.abs(standardized[np.isfinite(standardized)])
    values = values[values > 0.0]
    if not len(values):
        return 0
    values = np.sort(values)
    gaps = np.diff(values) > 1e-6 * np.maximum(values[1:], 1e-3)
    return int(gaps.sum()) + 1


def ellipse_axes(ee: Floats, en: Floats, nn: Floats) -> tuple[Floats, Floats, Floats]:
    """Semi-axes and azimuth of the major axis [rad, 0..pi) from covariances, any shape."""
    half = np.hypot((nn - ee) / 2.0, en)
    mean = (ee + nn) / 2.0
    a = np.sqrt(np.maximum(mean + half, 0.0))
    b = np.sqrt(np.maximum(mean - half, 0.0))
    azimuth = np.mod(0.5 * np.arctan2(2.0 * en, nn - ee), math.pi)
    return a, b, azimuth


def ellipse(covariance: Floats) -> Ellipse:
    """Standard ellipse of a covariance matrix in e, n, shape (2, 2)."""
    a, b, azimuth = ellipse_axes(covariance[0, 0], covariance[0, 1], covariance[1, 1])
    return Ellipse(float(a), float(b), float(azimuth))
