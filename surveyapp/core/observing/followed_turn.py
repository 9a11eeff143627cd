"""A turning point from readings that follow the light mark: a parabola through its neighbourhood.

Around the turn the swing A cos(w t) is A (1 - w^2 t^2 / 2) but for A w^4 t^4 / 24. Over 15 s on
either side of the turn of a 400 s swing the parabola misses the turn by A w^4 t^4 / 280, 0.08" at
an amplitude of 2 degrees. Following readings err together: their autocorrelation enters the sigma.
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
    variance of means of a first-order autoregression.
    """
    t, y = np.asarray(seconds, dtype=np.float64), np.asarray(readings, dtype=np.float64)
    if len(t) < LEAST:
        raise _no_turn("too few readings", f"{len(t)}", said("{least} or more", least=LEAST))
    middle = 0.5 * (t[0] + t[-1])
    scale = max(0.5 * (t[-1] - t[0]), 1e-9)
    x = (t - middle) / scale
    offsets = np.asarray(wrap_pi_array(y - y[0]))
    (a, b, c), covariance = _parabola(x, offsets)
    if abs(c) < _SIGNIFICANT * math.sqrt(covariance[2, 2]):
        raise _no_turn("the readings do not bend", "a straight line", "readings on both sides")
    turn = -b / (2.0 * c)
    if not -1.0 < turn < 1.0:
        raise _no_turn("the turn lies outside of the readings", f"{turn * scale:+.1f} s", "inside")
    slope = np.array([1.0, turn, turn**2])  # d value / d (a, b, c), the turn itself stationary
    at_turn = np.array([0.0, -1.0 / (2.0 * c), b / (2.0 * c**2)])
    return FollowedTurn(
        value=wrap_two_pi(float(y[0] + a + b * turn + c * turn**2)),
        sigma=math.sqrt(float(slope @ covariance @ slope)),
        moment_s=float(middle - t[0] + turn * scale),
        moment_sigma_s=math.sqrt(float(at_turn @ covariance @ at_turn)) * scale,
        readings=len(t),
        curvature=2.0 * float(c) / scale**2,
    )


def _parabola(x: Floats, y: Floats) -> tuple[tuple[float, float, float], Floats]:
    """Coefficients and their covariance, serial correlation included."""
    design = np.stack([np.ones_like(x), x, x**2], axis=1)
    q, r = np.linalg.qr(design)
    solution = np.linalg.solve(r, q.T @ y)
    residual = y - design @ solution
    square = float(residual @ residual)
    lag = float(residual[1:] @ residual[:-1]) / square if square > 0.0 else 0.0
    correlation = min(max(lag, 0.0), _LARGEST_CORRELATION)
    inverse = np.linalg.solve(r, np.eye(3))
    variance = square / (len(y) - 3) * (1.0 + correlation) / (1.0 - correlation)
    a, b, c = (float(value) for value in solution)
    return (a, b, c), np.asarray(inverse @ inverse.T * variance)


def _no_turn(what: str, found: str, expected: str) -> SurveyError:
    hint = "follow the mark from some seconds before the turn to some seconds behind it"
    return SurveyError(Problem(what, "turning point", found, expected, hint))
