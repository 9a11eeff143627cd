"""Turning points of a tracked swing: least squares with exponential damping, and Schuler means.

The model of a run is u_k = N + A s_k q^k with s_k = +1 for a turning point on the right (east,
larger reading) and -1 on the left, k the number of the turning point counted from the first, q the
amplitude ratio of one half swing. What this model lacks is the business of ``surveyapp.diagnosis``.

Source: physics.md section 2.1; Thomas, T. L. (1982), The six methods of finding north using a
suspended gyroscope, Survey Review 26 (203).
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from surveyapp.domain.readings import Reading, Side
from surveyapp_models.angles import wrap_pi_array
from surveyapp_models.arrays import Floats

LEAST_SQUARES_FROM = 6
"""Turning points from which least squares is the default, for tracked and scale swings alike."""
MAX_ITERATIONS = 50
LOG_DECREMENT_BOUND = 3.0
"""A swing that loses 95 % of its amplitude in half a period is no swing."""


@dataclass(frozen=True, slots=True)
class DampedFit:
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

    def jacobian(self, index: Floats, sides: Floats) -> Floats:
        """Derivatives by (N, A, log decrement) at turning points with these numbers and sides."""
        return design(index, sides, amplitude=self.amplitude, log_decrement=self.log_decrement)

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

    ``amplitude`` [rad].
    """
    decay = sides * np.exp(-log_decrement * index)
    columns = np.empty((index.size, 3))
    columns[:, 0] = 1.0
    columns[:, 1] = decay
    columns[:, 2] = -amplitude * index * decay
    return columns


def side_signs(rows: Iterable[Reading]) -> Floats:
    """+1 for each turning point on the right, -1 for each other."""
    return np.array([1.0 if row.side is Side.RIGHT else -1.0 for row in rows])


def fit_damped_swing(values: Floats, index: Floats, sides: Floats) -> DampedFit:
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
    DampedFit
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
    mean = float(values.mean())
    centred = values - mean
    decrement = _first_decrement(centred, start)
    converged = False
    rows = np.empty((3, values.size))
    rows[0] = 1.0
    step = _reduced(centred, start, sides, decrement, rows=rows)
    for _ in range(MAX_ITERATIONS):
        change = min(max(step.change, -0.5), 0.5)
        decrement += change
        if abs(decrement) > LOG_DECREMENT_BOUND:
            decrement = math.copysign(LOG_DECREMENT_BOUND, decrement)
            step = _reduced(centred, start, sides, decrement, rows=rows)
            break
        step = _reduced(centred, start, sides, decrement, rows=rows)
        if abs(change) < 1e-13 + 1e-9 * abs(decrement):
            converged = True
            break
    return DampedFit(
        north=mean + step.north,
        amplitude=step.amplitude,
        log_decrement=decrement,
        residuals=centred - step.north - step.amplitude * rows[1],
        cofactor=_cofactor(step.gram, step.amplitude),
        dof=values.size - 3,
        converged=converged and step.amplitude > 0.0,
    )


@dataclass(frozen=True, slots=True)
class _Step:
    """N and A at one damping, the Gauss-Newton change of the damping, and the Gram matrix."""

    north: float
    amplitude: float
    change: float
    gram: Floats


def _first_decrement(values: Floats, index: Floats) -> float:
    """Damping from the first and the last difference of neighbours."""
    first, last = abs(float(values[0] - values[1])), abs(float(values[-2] - values[-1]))
    span = float(index[-2] - index[0])
    if first <= 0.0 or last <= 0.0 or span <= 0.0:
        return 0.0
    return min(max(math.log(first / last) / span, -0.5), 0.5)


def _reduced(
    values: Floats, index: Floats, sides: Floats, decrement: float, *, rows: Floats
) -> _Step:
    """Eliminate N and A at one damping (variable projection); fills ``rows`` with 1, d, k d.

    Source: Golub & Pereyra (1973), SIAM J. Numer. Anal. 10, 413-432; Kaufman (1975), BIT 15.
    The columns 1 and d = s q^k are nearly orthogonal: their 2 x 2 system is well conditioned.
    """
    np.multiply(sides, np.exp(-decrement * index), out=rows[1])
    np.multiply(index, rows[1], out=rows[2])
    gram = rows @ rows.T
    (one, one_d, one_k), (_, d_d, d_k), (_, _, k_k) = gram.tolist()
    sum_v, d_v, k_v = (rows @ values).tolist()
    determinant = one * d_d - one_d * one_d
    north = (d_d * sum_v - one_d * d_v) / determinant
    amplitude = (one * d_v - one_d * sum_v) / determinant
    # slope = -A k d, of which only what 1 and d do not explain can change the damping
    explained = (d_d * one_k**2 - 2.0 * one_d * one_k * d_k + one * d_k**2) / determinant
    free = amplitude**2 * (k_k - explained)
    misfit = -amplitude * (k_v - north * one_k - amplitude * d_k)
    return _Step(north, amplitude, misfit / free if free > 0.0 else 0.0, gram)


def _cofactor(gram: Floats, amplitude: float) -> Floats:
    """Inverse of J'J, J = (1, d, -A k d), with columns scaled to one: well conditioned.

    A swing without amplitude does not determine its damping: the pseudo-inverse says so by zeros.
    """
    factors = np.array([1.0, 1.0, -amplitude])
    scaled = gram * (factors[:, None] * factors)
    scale = np.sqrt(np.diagonal(scaled))
    if not np.all(scale > 0.0):
        return np.asarray(np.linalg.pinv(scaled), dtype=np.float64)
    outer = scale[:, None] * scale
    return np.asarray(np.linalg.inv(scaled / outer) / outer, dtype=np.float64)


@dataclass(frozen=True, slots=True)
class SwingMiddle:
    """Middle of a swing by one estimator.

    Parameters
    ----------
    value : float
        [unit of the readings].
    weight_norm : float
        Its standard error divided by the standard deviation of one reading.
    damping_left : float
        What the damping leaves in it.
    """

    value: float
    weight_norm: float
    damping_left: float = 0.0


def fitted_middle(fit: DampedFit) -> SwingMiddle:
    """The midpoint of the damped fit."""
    return SwingMiddle(fit.north, math.sqrt(fit.cofactor[0, 0]))


def schuler_middle(
    fit: DampedFit, values: Floats, *, index: Floats, sides: Floats
) -> SwingMiddle | None:
    """The mean of all Schuler means, None where no three turning points are consecutive."""
    means, weights = schuler_means(values, index)
    if means.size == 0:
        return None
    left = damping_left(fit, weights, index=index, sides=sides)
    return SwingMiddle(float(means.mean()), float(np.sqrt(weights @ weights)), left)


def expected_weight_norm(fit: DampedFit, *, index: Floats, sides: Floats) -> float:
    """``weight_norm`` of the default estimator if a swing like this had these turning points."""
    if index.size < LEAST_SQUARES_FROM:
        _, weights = schuler_means(np.zeros(index.size), index)
        return float(np.sqrt(weights @ weights))
    return float(np.linalg.norm(np.linalg.pinv(fit.jacobian(index, sides))[0]))


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


def damping_left(fit: DampedFit, weights: Floats, *, index: Floats, sides: Floats) -> float:
    """What the damping leaves in a mean with these weights, as the fit sees it; 0 without a fit.

    The mean of three turning points is off by A (1 - q)^2 / 4 (physics.md 2.1): nothing where the
    swing loses 1 %, more than the reading error where it loses 5 %. It is no correction, because a
    mean is reported as it is formed; it belongs into the sigma.
    """
    if not fit.converged:
        return 0.0
    swing = fit.amplitude * sides * np.exp(-fit.log_decrement * (index - index[0]))
    return abs(float(weights @ swing))
