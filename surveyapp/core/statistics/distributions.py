"""Student, chi-square and F distributions from the incomplete beta and gamma functions.

They exist so that the reduction of a field book needs no scipy (its import costs more than the
whole computation). Held against ``scipy.special`` in the tests.

Source: W. H. Press et al. (2007), Numerical Recipes, 3rd ed., sections 6.2 and 6.4 (series and
continued fractions of Lentz); Abramowitz & Stegun (1964), 26.5 and 26.7.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache
from statistics import NormalDist

_EPS = 1e-16
_TINY = 1e-300
_NORMAL = NormalDist()


def _beta_fraction(a: float, b: float, x: float) -> float:
    c, d = 1.0, 1.0 - (a + b) * x / (a + 1.0)
    d = 1.0 / (d if abs(d) > _TINY else _TINY)
    h = d
    for m in range(1, 10_000):
        for numerator in (
            m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m)),
            -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1)),
        ):
            d = 1.0 + numerator * d
            d = 1.0 / (d if abs(d) > _TINY else _TINY)
            c = 1.0 + numerator / c
            c = c if abs(c) > _TINY else _TINY
            h *= d * c
        if abs(d * c - 1.0) < _EPS * 8:
            break
    return h


def regularized_beta(x: float, *, a: float, b: float) -> float:
    """Regularized incomplete beta function I_x(a, b), 0 <= x <= 1."""
    if x <= 0.0:
        return 0.0
    if x >= 1.0:
        return 1.0
    log_front = math.lgamma(a + b) - math.lgamma(a) - math.lgamma(b)
    front = math.exp(log_front + a * math.log(x) + b * math.log1p(-x))
    if x < (a + 1.0) / (a + b + 2.0):
        return front * _beta_fraction(a, b, x) / a
    return 1.0 - front * _beta_fraction(b, a, 1.0 - x) / b


def _gamma_upper(a: float, x: float) -> float:
    if x <= 0.0:
        return 1.0
    front = math.exp(-x + a * math.log(x) - math.lgamma(a))
    if x < a + 1.0:
        term = total = 1.0 / a
        n = a
        while abs(term) > abs(total) * _EPS:
            n += 1.0
            term *= x / n
            total += term
        return 1.0 - total * front
    b = x + 1.0 - a
    c, d = 1.0 / _TINY, 1.0 / b
    h = d
    for i in range(1, 10_000):
        numerator = -i * (i - a)
        b += 2.0
        d = numerator * d + b
        d = 1.0 / (d if abs(d) > _TINY else _TINY)
        c = b + numerator / c
        c = c if abs(c) > _TINY else _TINY
        h *= d * c
        if abs(d * c - 1.0) < _EPS * 8:
            break
    return front * h


def chi_square_tail(value: float, dof: float) -> float:
    """Probability that a chi-square variable with ``dof`` degrees of freedom exceeds ``value``."""
    return _gamma_upper(0.5 * dof, 0.5 * value)


def f_tail(value: float, *, dof_numerator: float, dof_denominator: float) -> float:
    """Probability that an F variable exceeds ``value``; an infinite denominator is allowed."""
    if value <= 0.0:
        return 1.0
    if math.isinf(dof_denominator):
        return chi_square_tail(value * dof_numerator, dof_numerator)
    x = dof_denominator / (dof_denominator + dof_numerator * value)
    return regularized_beta(x, a=0.5 * dof_denominator, b=0.5 * dof_numerator)


def student_tail(value: float, dof: float) -> float:
    """Probability that a Student variable exceeds ``value`` (one side); dof may be infinite."""
    if math.isinf(dof):
        return 1.0 - _NORMAL.cdf(value)
    tail = 0.5 * regularized_beta(dof / (dof + value * value), a=0.5 * dof, b=0.5)
    return tail if value >= 0.0 else 1.0 - tail


def _root(function: Callable[[float], float], low: float, high: float) -> float:
    """Bracketed secant (Illinois) root of a monotonic function."""
    f_low, f_high = function(low), function(high)
    for _ in range(200):
        if f_high == f_low:
            break
        middle = high - f_high * (high - low) / (f_high - f_low)
        f_middle = function(middle)
        if f_middle * f_high < 0.0:
            low, f_low = high, f_high
        else:
            f_low *= 0.5
        converged = abs(middle - high) <= 1e-13 * max(1.0, abs(middle))
        high, f_high = middle, f_middle
        if converged or f_middle == 0.0:
            break
    return high


@lru_cache(maxsize=4096)
def student_quantile(probability: float, dof: float) -> float:
    """Quantile of the Student distribution.

    Parameters
    ----------
    probability : float
        Probability below the quantile, 0 < p < 1.
    dof : float
        Degrees of freedom > 0, need not be whole (Welch-Satterthwaite), may be infinite.

    Raises
    ------
    ValueError
        If probability or dof lies outside its range.
    """
    if not 0.0 < probability < 1.0 or not dof > 0.0:
        raise ValueError(f"no Student quantile for p = {probability}, dof = {dof}")
    if probability < 0.5:
        return -student_quantile(1.0 - probability, dof)
    normal = _NORMAL.inv_cdf(probability)
    if math.isinf(dof) or dof > 1e7:
        return normal
    near = _student_series(normal, dof)
    if dof >= MANY_DOF and normal <= MOST_NORMAL:
        return near
    tail = 1.0 - probability
    if dof >= FEW_DOF:
        polished = _polished(near, tail, dof)
        if polished is not None:
            return polished
    low, high = 0.0, normal + 1.0
    while student_tail(high, dof) > tail:
        high *= 2.0
    return _root(lambda value: math.log(student_tail(value, dof) / tail), low, high)


FEW_DOF = 3.0
"""From here on the series lies within a few per cent at usual probabilities."""
MANY_DOF = 1000.0
MOST_NORMAL = 5.0
"""The first term left out is below 1e-12 of the quantile there."""


def _polished(near: float, tail: float, dof: float) -> float | None:
    """Quantile from an approximate one by Halley's method; None where that does not settle."""
    log_front = math.lgamma(0.5 * (dof + 1.0)) - math.lgamma(0.5 * dof)
    log_front -= 0.5 * math.log(dof * math.pi)
    value = near
    for _ in range(6):
        density = math.exp(log_front - 0.5 * (dof + 1.0) * math.log1p(value * value / dof))
        newton = (student_tail(value, dof) - tail) / density
        bend = 0.5 * (dof + 1.0) * value / (dof + value * value)
        step = newton * (1.0 + newton * bend)
        if not abs(step) < 0.1 * near:
            return None
        value += step
        if abs(step) ** 3 <= 1e-15:  # the next step is of this order
            return value
    return None


def _student_series(z: float, dof: float) -> float:
    """Student quantile in powers of 1/dof (Abramowitz and Stegun 1964, eq. 26.7.5)."""
    q = z * z
    return z * (
        1.0
        + (q + 1.0) / (4.0 * dof)
        + ((5.0 * q + 16.0) * q + 3.0) / (96.0 * dof**2)
        + (((3.0 * q + 19.0) * q + 17.0) * q - 15.0) / (384.0 * dof**3)
        + ((((79.0 * q + 776.0) * q + 1482.0) * q - 1920.0) * q - 945.0) / (92160.0 * dof**4)
    )


@lru_cache(maxsize=4096)
def chi_square_quantile(probability: float, dof: float) -> float:
    """Quantile of the chi-square distribution, 0 < p < 1, dof > 0."""
    if not 0.0 < probability < 1.0 or not dof > 0.0:
        raise ValueError(f"no chi-square quantile for p = {probability}, dof = {dof}")
    tail = 1.0 - probability
    high = dof + 10.0
    while chi_square_tail(high, dof) > tail:
        high *= 2.0
    return _root(lambda value: chi_square_tail(value, dof) - tail, 0.0, high)


def normal_quantile(probability: float) -> float:
    """Quantile of the standard normal distribution."""
    return _NORMAL.inv_cdf(probability)


NORMAL_95 = normal_quantile(0.975)
"""Half-width of a two-sided 95 % interval in standard deviations."""


@lru_cache(maxsize=256)
def f_quantile(level: float, numerator: int, denominator: int) -> float:
    """Upper quantile of F by bisection."""
    low, high = 0.0, 1.0
    while f_tail(high, dof_numerator=numerator, dof_denominator=denominator) > level:
        high *= 2.0
    for _ in range(80):
        middle = 0.5 * (low + high)
        tail = f_tail(middle, dof_numerator=numerator, dof_denominator=denominator)
        low, high = (middle, high) if tail > level else (low, middle)
    return high
