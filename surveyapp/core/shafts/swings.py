"""A swinging wire reduced like the turning points of a gyro: rest, drift, damping by least squares.

Readings at successive turning points: u_k = N + d (k - mid) + A (-q)^k. Rest is N at mid-record, so
that a drift of the wire (water, air current, a settling bob) does not enter it.

Source: physics.md sections 2.1 and 6.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from surveyapp_models.arrays import Floats

GRAVITY = 9.81
"""[m/s^2] (penetration.md section 6)."""
WITH_DRIFT = 5
"""Turning points from which drift and damping are estimated beside rest and amplitude."""
MAX_ITERATIONS = 60


@dataclass(frozen=True, slots=True)
class SwingRest:
    """Rest of one wire on one scale.

    Parameters
    ----------
    rest : float
        [unit of the readings].
    weight_norm : float
        Its standard error divided by that of one reading.
    squares : float
        Sum of the squared residuals.
    dof : int
    """

    rest: float
    weight_norm: float
    squares: float
    dof: int


def period_s(depth_m: float) -> float:
    """Period of a wire as a simple pendulum [s]."""
    return 2.0 * math.pi * math.sqrt(depth_m / GRAVITY)


def swing_rest(readings: Sequence[float]) -> SwingRest:
    """Rest of a swing from its turning points in order.

    Parameters
    ----------
    readings : sequence of float
        At least 3.

    Notes
    -----
    With 3 or 4 points the mean of the Schuler means (exact for a linear drift).
    """
    values = np.asarray(readings, dtype=np.float64)
    if values.size < WITH_DRIFT:
        weights = np.zeros(values.size)
        for i in range(values.size - 2):
            weights[i : i + 3] += np.array([0.25, 0.5, 0.25]) / (values.size - 2)
        return SwingRest(float(weights @ values), float(np.sqrt(weights @ weights)), 0.0, 0)
    return _fitted(values)


def _fitted(values: Floats) -> SwingRest:
    k = np.arange(values.size, dtype=np.float64)
    sign = np.where(k % 2 == 0, 1.0, -1.0)
    centred = k - k.mean()
    origin = float(values.mean())
    decrement = 0.0
    linear = np.zeros(3)
    for _ in range(MAX_ITERATIONS):
        decay = sign * np.exp(-decrement * k)
        base = np.column_stack([np.ones_like(k), centred, decay])
        linear = np.linalg.lstsq(base, values - origin, rcond=None)[0]
        jacobian = np.column_stack([base, -linear[2] * k * decay])
        residual = values - origin - base @ linear
        step = float(np.linalg.lstsq(jacobian, residual, rcond=None)[0][3])
        step = min(max(step, -0.2), 0.2)
        decrement = min(max(decrement + step, -1.0), 1.0)
        if abs(step) < 1e-12:
            break
    decay = sign * np.exp(-decrement * k)
    base = np.column_stack([np.ones_like(k), centred, decay])
    linear = np.linalg.lstsq(base, values - origin, rcond=None)[0]
    residual = values - origin - base @ linear
    jacobian = np.column_stack([base, -linear[2] * k * decay])
    inverse = np.linalg.pinv(jacobian)
    return SwingRest(
        origin + float(linear[0]),
        float(np.linalg.norm(inverse[0])),
        float(residual @ residual),
        values.size - 4,
    )


def pooled_sigma(swings: Sequence[SwingRest]) -> float | None:
    """1 sigma of one reading from the residuals of all swings together, None without any."""
    dof = sum(swing.dof for swing in swings)
    return math.sqrt(sum(swing.squares for swing in swings) / dof) if dof > 0 else None
