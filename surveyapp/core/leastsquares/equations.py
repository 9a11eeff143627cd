"""Whitened observation equations, grouped by shape so that everything is done for many at once.

An element is one independent observation (k = 1 row) or one correlated block (k rows) with the p
unknowns that it touches. It must not know what the unknowns mean.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surveyapp_models.arrays import Floats

Ints = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class ElementGroup:
    """Elements of one shape.

    Parameters
    ----------
    rows : int array, shape (n, k)
        Number of each observation.
    unknowns : int array, shape (n, p)
        Numbers of the unknowns, different ones within a row; -1 = none (its partials are 0).
    jacobian : float array, shape (n, k, p)
        Whitened partial derivatives of computed values.
    misclosure : float array, shape (n, k)
        Whitened observed minus computed.
    root : float array, shape (n, k, k)
        Lower Cholesky factor of the element's covariance; whitening divides by it.
    """

    rows: Ints
    unknowns: Ints
    jacobian: Floats
    misclosure: Floats
    root: Floats


@dataclass(frozen=True, slots=True)
class Structure:
    """The unknowns of a system and how they belong together.

    Parameters
    ----------
    count : int
        Number of unknowns.
    node_start : int array, shape (nodes + 1,)
        Node i owns the unknowns node_start[i] .. node_start[i + 1] - 1; unknowns that belong
        together (the coordinates of a point) are eliminated together.
    """

    count: int
    node_start: Ints

    @property
    def sizes(self) -> Ints:
        """Number of unknowns of each node."""
        return np.diff(self.node_start)

    @property
    def node_of(self) -> Ints:
        """Node of each unknown, shape (count,)."""
        return np.repeat(np.arange(len(self.sizes), dtype=np.int64), self.sizes)


def gradient(groups: Sequence[ElementGroup], count: int) -> Floats:
    """Right-hand side A'Pl of the normal equations, shape (count,)."""
    total = np.zeros(count + 1)
    for group in groups:
        part = np.einsum("nkp,nk->np", group.jacobian, group.misclosure)
        total += np.bincount(
            np.where(group.unknowns < 0, count, group.unknowns).ravel(),
            weights=part.ravel(),
            minlength=count + 1,
        )
    return total[:count]


def column_norms(groups: Sequence[ElementGroup], count: int) -> Floats:
    """Norm of each column of the whitened Jacobian, 1 where it is empty, shape (count,)."""
    squares = np.zeros(count + 1)
    for group in groups:
        part = np.einsum("nkp,nkp->np", group.jacobian, group.jacobian)
        squares += np.bincount(
            np.where(group.unknowns < 0, count, group.unknowns).ravel(),
            weights=part.ravel(),
            minlength=count + 1,
        )
    norms = np.sqrt(squares[:count])
    return np.where(norms > 0.0, norms, 1.0)


def scaled(groups: Sequence[ElementGroup], norms: Floats) -> tuple[ElementGroup, ...]:
    """The same equations in unknowns multiplied by ``norms``, so that all columns have length 1."""
    padded = np.append(norms, 1.0)
    return tuple(
        ElementGroup(
            group.rows,
            group.unknowns,
            group.jacobian / padded[group.unknowns][:, None, :],
            group.misclosure,
            group.root,
        )
        for group in groups
    )


def product(groups: Sequence[ElementGroup], vectors: Floats) -> Floats:
    """Largest length of A g over the columns g, shape (d,); ``vectors`` has shape (count, d)."""
    squares = np.zeros(vectors.shape[1])
    padded = np.vstack((vectors, np.zeros((1, vectors.shape[1]))))
    for group in groups:
        part = np.einsum("nkp,npd->nkd", group.jacobian, padded[group.unknowns])
        squares += np.einsum("nkd,nkd->d", part, part)
    return np.sqrt(squares)


def dense_jacobian(groups: Sequence[ElementGroup], count: int) -> tuple[Floats, Floats]:
    """Full whitened Jacobian (rows, count) and misclosures (rows,), for small systems."""
    rows = sum(group.rows.size for group in groups)
    matrix = np.zeros((rows, count + 1))
    misclosure = np.zeros(rows)
    offset = 0
    for group in groups:
        n, k = group.rows.shape
        place = offset + np.arange(n * k).reshape(n, k)
        columns = np.where(group.unknowns < 0, count, group.unknowns)
        matrix[place[:, :, None], columns[:, None, :]] = group.jacobian
        misclosure[place] = group.misclosure
        offset += n * k
    return matrix[:, :count], misclosure
