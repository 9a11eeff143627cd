"""Turning points of a tracked swing: least squares with exponential damping, and Schuler means.

The model of a run is u_k = N + A s_k q^k with s_k = +1 for a turning point on the right (east,
larger reading) and -1 on the left, k the number of the turning point counted from the first, q the
amplitude ratio of one half swing. What this model lacks is the business of ``surveyapp.diagnosis``.

Source: physics.md section 2.1; Thomas, T. L. (1982), The six methods of finding north using a
suspended gyroscope, Survey Review 26 (203).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surveyapp_models.angles import wrap_pi_array

Floats = NDArray[np.float64]

MAX_ITERATIONS = 50
LOG_DECREMENT_BOUND = 3.0
"""A swing that loses 95 % of its amplitude in half a period is no swing."""


@dataclass(frozen=True, slots=True)
class SwingFit:
    """Least-squares fit of one run.

    Parameters
    ----------
    north : float
        Midpoint N, relative to ``origin`` [same unit as the readings].
    amplitude : float
        A at the first turning point, positive.
    log_decrement : float
        -ln q per half swing.
    residuals : ndarray, shape (n,)
        Observed minus fitted.
    cofactor : ndarray, shape (3, 3)
        Cofactor matrix of (N, A, log decrement): covariance divided by the variance of unit weight.
    dof : int
        n - 3.
    converged : bool
        Whether the iteration reached its fixed point.
    """

    north: float
    amplitude: float
    log_decrement: float
    residuals: Floats
    cofactor: Floats
    dof: int
    converged: bool

    @property
    def damping_ratio(self) -> float:
        """Amplitude ratio q of one half swing [-]."""
        return math.exp(-self.log_decrement)

    @property
    def sum_of_squares(self) -> float:
        """Sum of the squared residuals."""
        return float(self.residuals @ self.residuals)

    @property
    def residual_rms(self) -> float:
        """sqrt(v'v / n)."""
        return math.sqrt(self.sum_of_squares / self.residuals.size)

    @property
    def variance(self) -> float | None:
        """Variance of one reading, None without redundancy."""
        return self.sum_of_squares / self.dof if self.dof > 0 else None


def unwrap(readings: Floats) -> Floats:
    """Circle readings [rad] as differences from the first one, across 0/360 degrees as well."""
    return wrap_pi_array(readings - readings[0])


def design(index: Floats, sides: Floats, *, amplitude: float, log_decrement: float) -> Floats:
    """Derivatives of the turning points with respect to N, A and the log decrement.

    Parameters
    ----------
    index : ndarray, shape (n,)
        Number of each turning point, missed ones counted.
    sides : ndarray, shape (n,)
        +1 right, -1 left.

    Returns
    -------
    ndarray, shape (n, 3)
    """
    decay = sides * np.exp(-log_decrement * index)
    return np.column_stack([np.ones_like(index), decay, -amplitude * index * decay])


def fit_swing(values: Floats, index: Floats, sides: Floats) -> SwingFit:
    """Fit N, A and the damping to at least three turning points by Gauss-Newton.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Turning points, unwrapped [any unit].
    index : ndarray, shape (n,)
        Their numbers, increasing, missed ones counted.
    sides : ndarray, shape (n,)
        +1 right, -1 left.

    Returns
    -------
    SwingFit
        ``converged`` is False where the damping ran to its bound: then nothing in it is to be
        trusted.

    Raises
    ------
    ValueError
        If there are fewer than three points, or points of one side only.
    """
    if values.size < 3 or not (np.any(sides > 0) and np.any(sides < 0)):
        raise ValueError("a damped swing needs three turning points, on both sides")
    start = index - index[0]
    decrement = 0.0
    converged = False
    linear = np.zeros(2)
    for _ in range(MAX_ITERATIONS):
        decay = sides * np.exp(-decrement * start)
        basis = np.column_stack([np.ones_like(start), decay])
        linear = np.linalg.lstsq(basis, values, rcond=None)[0]
        jacobian = design(start, sides, amplitude=float(linear[1]), log_decrement=decrement)
        residuals = values - basis @ linear
        step = float(np.linalg.lstsq(jacobian, residuals, rcond=None)[0][2])
        step = min(max(step, -0.5), 0.5)
        decrement += step
        if abs(decrement) > LOG_DECREMENT_BOUND:
            break
        if abs(step) < 1e-13 + 1e-10 * abs(decrement):
            converged = True
            break
    decrement = min(max(decrement, -LOG_DECREMENT_BOUND), LOG_DECREMENT_BOUND)
    decay = sides * np.exp(-decrement * start)
    basis = np.column_stack([np.ones_like(start), decay])
    linear = np.linalg.lstsq(basis, values, rcond=None)[0]
    jacobian = design(start, sides, amplitude=float(linear[1]), log_decrement=decrement)
    r = np.linalg.qr(jacobian, mode="r")
    inverse_r = np.linalg.pinv(r)
    return SwingFit(
        north=float(linear[0]),
        amplitude=float(linear[1]),
        log_decrement=decrement,
        residuals=values - basis @ linear,
        cofactor=inverse_r @ inverse_r.T,
        dof=values.size - 3,
        converged=converged and float(linear[1]) > 0.0,
    )


def schuler_means(values: Floats, index: Floats) -> tuple[Floats, Floats]:
    """Overlapping three-point Schuler means (u1 + 2 u2 + u3) / 4 of consecutive turning points.

    Parameters
    ----------
    values, index : ndarray, shape (n,)
        Turning points and their numbers; a triple with a missed point gives no mean.

    Returns
    -------
    means : ndarray, shape (m,)
    weights : ndarray, shape (n,)
        The weights of the readings in the mean of the means (sum 1); zeros where m = 0.
    """
    triples = [
        i for i in range(values.size - 2) if index[i + 1] == index[i] + 1 == index[i + 2] - 1
    ]
    weights = np.zeros(values.size)
    means = np.empty(len(triples))
    for row, i in enumerate(triples):
        means[row] = 0.25 * (values[i] + 2.0 * values[i + 1] + values[i + 2])
        weights[i : i + 3] += np.array([0.25, 0.5, 0.25]) / len(triples)
    return means, weights


def schuler_standard_error(points: int, sigma: float) -> float:
    """Standard error of the mean of all overlapping Schuler means.

    The means share readings: dividing the scatter by the root of their number is wrong by a factor
    of up to two.

    Parameters
    ----------
    points : int
        Number of consecutive turning points, at least 3.
    sigma : float
        Standard deviation of one turning point.

    Source: physics.md 2.1, se = sigma sqrt(16 v - 44) / (4 (v - 2)) for v >= 4; sqrt(6)/4 sigma
    for v = 3.
    """
    if points < 3:
        raise ValueError("a Schuler mean needs three turning points")
    if points == 3:
        return sigma * math.sqrt(6.0) / 4.0
    return sigma * math.sqrt(16.0 * points - 44.0) / (4.0 * (points - 2))
