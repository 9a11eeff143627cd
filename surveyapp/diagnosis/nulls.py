"""What pure noise does: the distribution of every test under the null, by Monte Carlo.

The draws pass through the same projector, the same scan and the same rounding as the data, so that
a p value means what it says. The null depends on the design only; it is kept per design within a
process, and its seed comes from the design, so that a result never depends on what ran before.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surveyapp.diagnosis.case import OwnScale
from surveyapp.diagnosis.projection import Projected
from surveyapp_models.arrays import Floats

CHUNK = 500_000
"""Numbers held at once while the draws are scanned."""
KEPT = 64
"""Nulls kept in memory."""


@dataclass(frozen=True, slots=True)
class Null:
    """Sorted draws of each candidate's statistic and of the family's smallest p value.

    Parameters
    ----------
    statistics : ndarray, shape (candidates, draws)
        Sorted per candidate.
    smallest : ndarray, shape (draws,)
        Sorted smallest weighted p value of each draw.
    weights : ndarray, shape (candidates,)
        A p value counts divided by its weight.
    """

    statistics: Floats
    smallest: Floats
    weights: Floats

    def p_values(self, observed: Floats) -> Floats:
        """P of each candidate: share of draws at least as large, never 0."""
        draws = self.statistics.shape[1]
        above = [
            draws - np.searchsorted(row, value * (1.0 - 1e-12), side="left")
            for row, value in zip(self.statistics, observed, strict=True)
        ]
        return np.asarray((1.0 + np.array(above, dtype=np.float64)) / (draws + 1.0))

    def family(self, p: Floats) -> Floats:
        """Westfall-Young p of each candidate: how often noise shows one as small anywhere."""
        draws = self.smallest.size
        weighted = p / self.weights
        below = np.searchsorted(self.smallest, weighted * (1.0 + 1e-12), side="right")
        return np.asarray((1.0 + below) / (draws + 1.0))


_CACHE: dict[bytes, Null] = {}


@dataclass(frozen=True, slots=True)
class Noise:
    """How noise is drawn.

    Parameters
    ----------
    draws : int
    rounding : float
        Reading resolution in units of the noise's standard deviation (0 = not rounded).
    root : ndarray, shape (n,)
        Root weights; rounding acts on the reading, before the weight.
    known : bool
        Whether the standard deviation is known (few observations): then nothing is divided by
        what is left.
    colour : ndarray, shape (n, n), or None
        Square root of the covariance of correlated noise.
    own_scales : tuple of OwnScale
        Rows that were divided by a scatter of their own.
    """

    draws: int
    rounding: float
    root: Floats
    known: bool = False
    colour: Floats | None = None
    own_scales: tuple[OwnScale, ...] = ()


def null_of(projected: tuple[Projected, ...], q: Floats, noise: Noise) -> Null:
    """Null of a family of candidates beside one model.

    Parameters
    ----------
    projected : tuple of Projected
    q : ndarray, shape (n, p)
        Orthonormal basis of the model.
    noise : Noise

    Returns
    -------
    Null
    """
    key = _key(projected, q, noise)
    known = _CACHE.get(key)
    if known is None:
        known = _simulate(projected, q, noise, key)
        if len(_CACHE) >= KEPT:
            _CACHE.pop(next(iter(_CACHE)))
        _CACHE[key] = known
    return known


def _key(projected: tuple[Projected, ...], q: Floats, noise: Noise) -> bytes:
    digest = hashlib.sha256()
    for part in (q @ q.T, noise.root, np.array([noise.draws, noise.rounding, noise.known])):
        digest.update(np.ascontiguousarray(np.round(part, 9)).tobytes())
    if noise.colour is not None:
        digest.update(np.ascontiguousarray(np.round(noise.colour, 9)).tobytes())
    for own in noise.own_scales:
        digest.update(own.rows.tobytes())
        digest.update(np.ascontiguousarray(np.round(own.basis @ own.basis.T, 9)).tobytes())
    for item in projected:
        digest.update(item.candidate.id.encode())
        digest.update(np.ascontiguousarray(np.round(item.columns, 9)).tobytes())
    return digest.digest()


def residual_draws(q: Floats, noise: Noise, generator: np.random.Generator) -> Floats:
    """Residuals (draws, n) of noise that passed through rounding and the model's projector."""
    sample = generator.standard_normal((noise.draws, q.shape[0]))
    if noise.colour is not None:
        sample = sample @ noise.colour.T
    if noise.rounding > 0.0:
        sample += noise.root * noise.rounding * generator.uniform(-0.5, 0.5, sample.shape)
    for own in noise.own_scales:
        sample = own.scaled(sample)
    return np.asarray(sample - (sample @ q) @ q.T)


def _simulate(projected: tuple[Projected, ...], q: Floats, noise: Noise, key: bytes) -> Null:
    generator = np.random.default_rng(int.from_bytes(key[:16], "big"))
    residuals = residual_draws(q, noise, generator)
    floor = (q.shape[0] - q.shape[1]) * noise.rounding**2 / 12.0
    total = np.einsum("dn,dn->d", residuals, residuals)
    found = np.empty((len(projected), noise.draws))
    single = residuals.astype(np.float32)
    for c, item in enumerate(projected):
        largest = _largest(item, single)
        found[c] = largest if noise.known else ratio(largest, total, floor)
    order = np.sort(found, axis=1)
    weights = np.array([item.candidate.weight for item in projected])
    smallest = np.full(noise.draws, np.inf)
    for row, values, weight in zip(order, found, weights, strict=True):
        above = noise.draws - np.searchsorted(row, values, side="left")
        np.minimum(smallest, above / noise.draws / weight, out=smallest)
    return Null(order, np.sort(smallest), weights)


def ratio(reduction: Floats, total: Floats, floor: float) -> Floats:
    """Reduction of the sum of squares relative to what is left, at least the rounding's."""
    return np.asarray(reduction / np.maximum(np.maximum(total - reduction, floor), 1e-300))


def _largest(item: Projected, residuals: NDArray[np.float32]) -> Floats:
    """Largest reduction over the grid for each draw; single precision is enough to rank draws."""
    g, n, q = item.columns.shape
    draws = residuals.shape[0]
    if g == 0:
        return np.zeros(draws)
    flat = item.columns.transpose(1, 2, 0).reshape(n, q * g).astype(np.float32)
    result = np.empty(draws)
    size = max(1, CHUNK // (g * q))
    for begin in range(0, draws, size):
        along = residuals[begin : begin + size] @ flat
        if item.candidate.one_sided:
            np.maximum(along, 0.0, out=along)
        np.square(along, out=along)
        total = along[:, :g]
        for j in range(1, q):
            total += along[:, j * g : (j + 1) * g]
        result[begin : begin + size] = total.max(axis=1)
    return result


def reductions(item: Projected, residual: Floats) -> Floats:
    """Reduction of the sum of squares at each separable grid point, shape (g,)."""
    along = np.einsum("gnq,n->gq", item.columns, residual)
    if item.candidate.one_sided:
        along = np.maximum(along, 0.0)
    return np.asarray(np.square(along).sum(axis=1))
