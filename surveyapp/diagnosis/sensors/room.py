"""The field of a room along the path of a sensor, as a rival of what a record seems to show.

A static field without sources and currents is the gradient of a harmonic function. Its first
degree is the effect ``field_gradient``; a real room bends it, and what the bend adds on a path
looks like a switch, an iron or a turn. So whatever is named beside the place must be wanted beside
the harmonic fields of higher degree too.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Final

import numpy as np

from surveyapp.diagnosis.sensors.windows import Blocks, block_means
from surveyapp_models.arrays import Floats

DEGREE: Final = 4
"""Highest degree in the place: 5 + 7 + 9 + 11 shapes."""

SEEN: Final = 1e-3
"""Shapes that a path shows with less than this share of the strongest one are not tried."""

Exponents = tuple[int, int, int]


def _monomials(degree: int) -> list[Exponents]:
    return [(i, j, degree - i - j) for i in range(degree + 1) for j in range(degree + 1 - i)]


@lru_cache(maxsize=8)
def harmonic(degree: int) -> tuple[tuple[Exponents, ...], Floats]:
    """Harmonic polynomials of a degree: monomials, and coefficients of shape (monomials, 2 l + 1).

    The null space of the Laplacian, which takes monomials of the degree to those of two less.
    """
    monomials = _monomials(degree)
    lower = {e: i for i, e in enumerate(_monomials(degree - 2))} if degree >= 2 else {}
    laplacian = np.zeros((len(lower), len(monomials)))
    for column, exponents in enumerate(monomials):
        for axis in range(3):
            power = exponents[axis]
            if power >= 2:
                left = _lowered(exponents, axis, 2)
                laplacian[lower[left], column] += power * (power - 1)
    right = np.linalg.svd(laplacian)[2] if lower else np.eye(len(monomials))
    return tuple(monomials), np.asarray(right[len(lower) :].T)


def _lowered(exponents: Exponents, axis: int, by: int) -> Exponents:
    i, j, k = (e - by * (axis == a) for a, e in enumerate(exponents))
    return i, j, k


def harmonic_fields(place: Floats, degree: int, *, only: int | None = None) -> Floats:
    """Fields of a degree in the place: gradients of the harmonic polynomials of one more.

    Parameters
    ----------
    place : ndarray, shape (m, 3)
    degree : int
    only : int or None
        One of the shapes.

    Returns
    -------
    ndarray, shape (m, 3, 2 degree + 3), or (m, 3, 1)
    """
    monomials, coefficients = harmonic(degree + 1)
    shapes = coefficients if only is None else coefficients[:, [only]]
    field = np.zeros((len(place), 3, shapes.shape[1]))
    for exponents, factors in zip(monomials, shapes, strict=True):
        for axis in range(3):
            power = exponents[axis]
            if power and np.abs(factors).max() > 1e-12:
                left = np.array(_lowered(exponents, axis, 1))
                slope = power * np.prod(place**left, axis=1)
                field[:, axis] += slope[:, None] * factors
    return field


def room_columns(place: Floats, matrices: Floats, block: Blocks) -> Floats:
    """Means of blocks of every harmonic field of degrees 1 to ``DEGREE``, in the body's axes.

    Parameters
    ----------
    place : ndarray, shape (m, 3)
        Level frame [m]; the middle and the size of the path are taken out.
    matrices : ndarray, shape (m, 3, 3)
        Body to level.
    block : ndarray of int, shape (m,)

    Returns
    -------
    ndarray, shape (n, 3, k)
        Combinations that the path shows, k at most 32, independent of each other.
    """
    at = place - place.mean(axis=0)
    at = at / max(float(np.abs(at).max()), 1e-9)
    columns = []
    for degree in range(1, DEGREE + 1):
        for shape in range(2 * degree + 3):
            field = harmonic_fields(at, degree, only=shape)[:, :, 0]
            columns.append(block_means(np.einsum("nij,ni->nj", matrices, field), block))
    whole = np.stack(columns, axis=2)
    u, size, _ = np.linalg.svd(whole.reshape(-1, whole.shape[2]), full_matrices=False)
    kept = size > SEEN * size[0] if size[0] > 0.0 else np.zeros(size.size, dtype=bool)
    return np.asarray((u[:, kept] * np.sqrt(len(u))).reshape(*whole.shape[:2], int(kept.sum())))
