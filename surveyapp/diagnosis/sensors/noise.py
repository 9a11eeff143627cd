"""Noise that rivals every effect: white, AR(1), and a random walk under white noise.

A slow wander of a sensor looks like iron, like warm-up, like a step. An effect is named only if it
beats each of these noises, with its parameters paid for, on the likelihood of the whole record.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

import numpy as np

from surveyapp.diagnosis.wander_shapes import decay_of, walk_of
from surveyapp_models.arrays import Floats

AR: Final = (0.3, 0.6, 0.8, 0.9, 0.95, 0.98, 0.995)
WALK: Final = (1e-4, 1e-3, 1e-2, 0.05, 0.2, 1.0)
"""Variance of a step of the walk over that of the white noise, per row."""

AR_SLOW: Final = (0.9, 0.98)
AR_SHARE: Final = (1.0, 10.0)
"""AR(1) of the zeros: correlation of neighbours, variance over that of the white noise."""


@dataclass(frozen=True, slots=True)
class Whitener:
    """A noise model as a matrix that makes its residuals white.

    Parameters
    ----------
    id : str
        white, ar1 or random_walk.
    parameters : int
    root : ndarray, shape (n, n), or None
        Lower triangular inverse root of the covariance; None = white.
    log_determinant : float
        Of the covariance, relative to white noise of unit variance.
    """

    id: str
    parameters: int
    root: Floats | None
    log_determinant: float

    def apply(self, values: Floats) -> Floats:
        """Whitened values; the first axis is time."""
        if self.root is None:
            return values
        flat = values.reshape(values.shape[0], -1)
        return np.asarray((self.root @ flat).reshape(values.shape))


@lru_cache(maxsize=8)
def whiteners(n: int) -> tuple[Whitener, ...]:
    """Every rival for a record of n rows."""
    found = [Whitener("white", 0, None, 0.0)]
    lag = np.abs(np.arange(n)[:, None] - np.arange(n)).astype(np.float64)
    found += [_of("ar1", decay_of(lag, phi)) for phi in AR]
    steps = walk_of(np.arange(float(n)))
    walks = [_of("random_walk", np.eye(n) + ratio * steps) for ratio in WALK]
    return (*found, *walks)


def along(direction: Floats) -> tuple[Whitener, ...]:
    """The zeros of three axes that wander, as the size of the field shows it.

    What wanders in the body is seen through the direction of the field there: two rows resemble
    each other by the cosine between their directions as well as by their distance in time.

    Parameters
    ----------
    direction : ndarray, shape (n, 3)
        Of the field in the body, of length 1.
    """
    n = direction.shape[0]
    alike = direction @ direction.T
    lag = np.abs(np.arange(n)[:, None] - np.arange(n)).astype(np.float64)
    found = [
        _of("ar1", np.eye(n) + ratio * alike * decay_of(lag, phi))
        for phi in AR_SLOW
        for ratio in AR_SHARE
    ]
    steps = walk_of(np.arange(float(n)))
    return (*found, *(_of("random_walk", np.eye(n) + ratio * alike * steps) for ratio in WALK))


def _of(name: str, covariance: Floats) -> Whitener:
    lower = np.linalg.cholesky(covariance)
    root = np.linalg.solve(lower, np.eye(covariance.shape[0]))
    return Whitener(name, 1, root, 2.0 * float(np.sum(np.log(np.diag(lower)))))


def bic(total: float, white: Whitener, size: tuple[int, int], parameters: int) -> float:
    """BIC of a fit with the variance profiled out.

    Parameters
    ----------
    total : float
        Whitened sum of squares.
    white : Whitener
    size : tuple of int
        Rows and channels.
    parameters : int
        Searched positions counted.
    """
    n = size[0] * size[1]
    fit = n * math.log(max(total, 1e-300) / n) + size[1] * white.log_determinant
    return fit + (parameters + white.parameters) * math.log(n)
