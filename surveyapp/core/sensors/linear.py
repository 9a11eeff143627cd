"""A linear fit of few parameters to many rows, and what its residuals say of their own noise."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

RANK_TOLERANCE = 1e-10
"""Relative to the largest: below it a direction of the scaled design counts as absent."""


@dataclass(frozen=True, slots=True)
class LinearFit:
    """A least-squares fit.

    Parameters
    ----------
    x : ndarray, shape (p,)
    covariance : ndarray, shape (p, p)
        Scaled by the residuals, and by ``inflation``.
    residual : ndarray, shape (n,)
        Observed minus fitted.
    sigma0 : float
        sqrt(v'v / dof).
    dof : int
    condition : float
        Of the design with its columns scaled to unit length.
    inflation : float
        Factor on the sigmas because neighbouring residuals resemble each other; 1 = none.
    """

    x: Array
    covariance: Array
    residual: Array
    sigma0: float
    dof: int
    condition: float
    inflation: float = 1.0

    @property
    def sigma(self) -> Array:
        """Standard deviations, shape (p,)."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def rms(self) -> float:
        """sqrt(v'v / n)."""
        return rms(self.residual)


def rms(values: Array) -> float:
    """Root mean square of all elements."""
    return math.sqrt(float(np.mean(np.square(values)))) if values.size else 0.0


def fit_linear(design: Array, observed: Array, *, correlated: bool = False) -> LinearFit | None:
    """Fit by QR; None where the design has a rank defect or no degree of freedom.

    Parameters
    ----------
    design : ndarray, shape (n, p)
    observed : ndarray, shape (n,)
    correlated : bool
        Whether the rows follow each other, so that correlated residuals widen the sigmas.
    """
    n, p = design.shape
    if n <= p:
        return None
    scale = np.sqrt(np.sum(design**2, axis=0))
    if np.any(scale == 0.0):
        return None
    q, r = np.linalg.qr(design / scale)
    singular = np.linalg.svd(r, compute_uv=False)
    if singular[-1] <= RANK_TOLERANCE * singular[0]:
        return None
    inverse = np.linalg.solve(r, np.eye(p)) / scale[:, None]
    x = inverse @ (q.T @ observed)
    residual = observed - design @ x
    dof = n - p
    variance = float(residual @ residual) / dof
    factor = correlation_inflation(residual) if correlated else 1.0
    covariance = inverse @ inverse.T * variance * factor**2
    condition = float(singular[0] / singular[-1])
    return LinearFit(x, covariance, residual, math.sqrt(variance), dof, condition, factor)


def lag_one(residual: Array) -> float:
    """Autocorrelation of neighbouring residuals."""
    centred = residual - residual.mean()
    total = float(centred @ centred)
    return float(centred[1:] @ centred[:-1]) / total if total > 0.0 else 0.0


def correlation_inflation(residual: Array) -> float:
    """Factor on the sigma of a mean for AR(1) residuals, 1 where they are not proved correlated.

    sqrt((1 + r) / (1 - r)), r the lag-one autocorrelation where it exceeds its 99 % bound of
    white noise, 2.58 / sqrt(n).
    """
    r = lag_one(residual)
    if residual.size < 10 or r <= 2.58 / math.sqrt(residual.size):
        return 1.0
    r = min(r, 0.99)
    return math.sqrt((1.0 + r) / (1.0 - r))


def alternate_blocks(
    size: int, block: int
) -> Iterator[tuple[NDArray[np.bool_], NDArray[np.bool_]]]:
    """Two halves of contiguous blocks: (fitted, held out), each half once held out."""
    odd = (np.arange(size) // max(block, 1)) % 2 == 1
    yield ~odd, odd
    yield odd, ~odd
