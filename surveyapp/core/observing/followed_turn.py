"""A turning point from readings that follow the light mark: a parabola through its neighbourhood.

Around the turn the swing A cos(w t) is A (1 - w^2 t^2 / 2) but for A w^4 t^4 / 24. Over 15 s on
either side of the turn of a 400 s swing the parabola misses the turn by A w^4 t^4 / 280, 0.08" at
an amplitude of 2 degrees, but over 60 s by 20". A curve two degrees higher shows by how much: that
enters the sigma, and where it is beyond doubt the curve takes the place of the parabola. Following
readings err together: their autocorrelation enters the sigma.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

import numpy as np

from surveyapp.domain.instrument_reading import FollowedTurn
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said
from surveyapp_models.angles import wrap_pi_array, wrap_two_pi
from surveyapp_models.arrays import Floats

LEAST: Final = 12
"""Fewer readings give no parabola with an honest sigma."""
_LARGEST_CORRELATION: Final = 0.98
_SIGNIFICANT: Final = 5.0
"""A curvature below five of its sigmas is no turn."""
_BEYOND_DOUBT: Final = 20.0
"""Chi-square with two degrees of freedom: chance gives it once in 20 000 turns."""
_HIGHEST: Final = 8
_STEPS: Final = 20


def followed_turn(seconds: Sequence[float], readings: Sequence[float]) -> FollowedTurn:
    """Value and moment of a turning point.

    Parameters
    ----------
    seconds : sequence of float
        Moments [s], increasing, shape (n,).
    readings : sequence of float
        Circle readings [rad], shape (n,).

    Returns
    -------
    FollowedTurn

    Raises
    ------
    SurveyError
        With fewer than ``LEAST`` readings, without a bend, or if the turn lies outside of them.

    Notes
    -----
    value = a - b^2 / 4c of a + b t + c t^2 with t from the middle; sigmas by propagation, enlarged
    by sqrt((1 + r) / (1 - r)) of the residuals' correlation r from one reading to the next: the
    variance of means of a first-order autoregression. The difference of a curve two degrees higher
    at the turn is added.
    """
    t, y = np.asarray(seconds, dtype=np.float64), np.asarray(readings, dtype=np.float64)
    if len(t) < LEAST:
        raise _no_turn("too few readings", f"{len(t)}", said("{least} or more", least=LEAST))
    middle = 0.5 * (t[0] + t[-1])
    scale = max(0.5 * (t[-1] - t[0]), 1e-9)
    x = (t - middle) / scale
    offsets = np.asarray(wrap_pi_array(y - y[0]))
    parabola, variance = _fit(x, offsets, 2)[0], _fit(x, offsets, 4)[1]
    if abs(parabola[2]) < _SIGNIFICANT * math.sqrt(_cofactor(x, 2)[2, 2] * variance):
        raise _no_turn("the readings do not bend", "a straight line", "readings on both sides")
    place = float(-parabola[1] / (2.0 * parabola[2]))
    if not -1.0 < place < 1.0:
        raise _no_turn("the turn lies outside of the readings", f"{place * scale:+.1f} s", "inside")
    chosen, place, apart, variance = _curve(x, offsets, parabola, place)
    covariance = _cofactor(x, len(chosen) - 1) * variance
    curvature = _value(_derived(_derived(chosen)), place)
    at_place = place ** np.arange(len(chosen))  # d value / d coefficients: the turn is stationary
    moved = np.append(0.0, np.arange(1, len(chosen)) * at_place[:-1]) / curvature
    return FollowedTurn(
        value=wrap_two_pi(float(y[0]) + _value(chosen, place)),
        sigma=math.hypot(math.sqrt(float(at_place @ covariance @ at_place)), apart[0]),
        moment_s=float(middle - t[0] + place * scale),
        moment_sigma_s=math.hypot(math.sqrt(float(moved @ covariance @ moved)), apart[1]) * scale,
        readings=len(t),
        curvature=curvature / scale**2,
    )


def _curve(
    x: Floats, y: Floats, chosen: Floats, place: float
) -> tuple[Floats, float, tuple[float, float], float]:
    """The parabola, or the curve of higher degree that is beyond doubt, and what it may miss.

    Returns
    -------
    coefficients, place, apart, variance
        ``apart``: how far value and place of the turn are from those of the next degree.
    """
    while True:
        degree = len(chosen) + 1
        curve, variance = _fit(x, y, degree)
        turned = _turn_of(curve, place)
        cofactor = _cofactor(x, degree)[degree - 1 :, degree - 1 :]
        misfit = float(curve[degree - 1 :] @ np.linalg.solve(cofactor, curve[degree - 1 :]))
        beyond = turned is not None and misfit > _BEYOND_DOUBT * variance
        if not beyond or turned is None or degree >= _HIGHEST or len(x) < 2 * degree + LEAST:
            other = place if turned is None else turned
            apart = _value(curve, place) - _value(chosen, place), other - place
            return chosen, place, apart, variance
        chosen, place = curve, turned


def _value(coefficients: Floats, x: float) -> float:
    return float(np.polynomial.polynomial.polyval(x, coefficients))


def _derived(coefficients: Floats) -> Floats:
    return np.asarray(np.polynomial.polynomial.polyder(coefficients), dtype=np.float64)


def _turn_of(coefficients: Floats, near: float) -> float | None:
    """Place of the turn of a curve, by Newton's steps from that of the parabola."""
    first = _derived(coefficients)
    second, place = _derived(first), near
    for _ in range(_STEPS):
        bend = _value(second, place)
        if bend == 0.0 or not -1.0 < place < 1.0:
            return None
        place -= _value(first, place) / bend
    return place if -1.0 < place < 1.0 else None


def _cofactor(x: Floats, degree: int) -> Floats:
    design = np.vander(x, degree + 1, increasing=True)
    inverse = np.linalg.inv(np.linalg.qr(design, mode="r"))
    return np.asarray(inverse @ inverse.T, dtype=np.float64)


def _fit(x: Floats, y: Floats, degree: int) -> tuple[Floats, float]:
    """Coefficients of a curve, and the variance of a reading, its serial correlation included.

    A correlation r appears smaller by ((p + 1) + (p + 3) r) / n behind a curve of degree p
    (M. G. Kendall 1954, Biometrika 41, 403, for the mean; a degree more takes one more each).
    """
    design = np.vander(x, degree + 1, increasing=True)
    q, r = np.linalg.qr(design)
    solution = np.linalg.solve(r, q.T @ y)
    residual = y - design @ solution
    square = float(residual @ residual)
    lag = float(residual[1:] @ residual[:-1]) / square if square > 0.0 else 0.0
    lost = (degree + 1) / len(y), 1.0 - min((degree + 3) / len(y), 0.5)  # by the curve itself
    correlation = min(max((lag + lost[0]) / lost[1], 0.0), _LARGEST_CORRELATION)
    variance = square / (len(y) - degree - 1) * (1.0 + correlation) / (1.0 - correlation)
    return np.asarray(solution, dtype=np.float64), variance


def _no_turn(what: str, found: str, expected: str) -> SurveyError:
    hint = "follow the mark from some seconds before the turn to some seconds behind it"
    return SurveyError(Problem(what, "turning point", found, expected, hint))
