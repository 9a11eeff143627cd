"""A candidate beside a model: what the model leaves of its columns, made orthonormal."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surveyapp.diagnosis.candidates import Candidate
from surveyapp_models.arrays import Floats


def orthonormal(columns: Floats, share: float) -> tuple[Floats, Floats]:
    """Orthonormalise the columns of each grid point.

    Parameters
    ----------
    columns : ndarray, shape (g, n, q)
        Already projected on what the model leaves.
    share : float
        Norms below this (absolute, per grid point and column) count as nothing.

    Returns
    -------
    ndarray, shape (g, n, q)
    ndarray of bool, shape (g,)
        Where all q columns are independent.
    """
    result = columns.copy()
    good = np.ones(columns.shape[0], dtype=bool)
    for j in range(columns.shape[2]):
        for i in range(j):
            along = np.einsum("gn,gn->g", result[:, :, i], result[:, :, j])
            result[:, :, j] -= along[:, None] * result[:, :, i]
        norms = np.sqrt(np.einsum("gn,gn->g", result[:, :, j], result[:, :, j]))
        good &= norms > share
        result[:, :, j] /= np.where(norms > 0.0, norms, 1.0)[:, None]
    return result, good


@dataclass(frozen=True, slots=True)
class Projected:
    """A candidate beside a model: orthonormal columns of its separable grid points.

    Parameters
    ----------
    candidate : Candidate
    columns : ndarray, shape (g, n, q)
    index : ndarray of int, shape (g,)
        Grid points of the candidate that are separable.
    left : float
        Largest share of its norm that is left beside the model.
    """

    candidate: Candidate
    columns: Floats
    index: NDArray[np.intp]
    left: float


def project(candidate: Candidate, q: Floats) -> Projected:
    """Project a candidate on what an orthonormal basis ``q`` of the model leaves."""
    raw = candidate.columns
    if raw.shape[0] == 0:
        return Projected(candidate, raw, np.zeros(0, dtype=np.intp), 0.0)
    norms = np.sqrt(np.einsum("gnq,gnq->gq", raw, raw))
    unit = raw / np.where(norms > 0.0, norms, 1.0)[:, None, :]
    left = unit - q @ (q.T @ unit)
    share = np.sqrt(np.einsum("gnq,gnq->gq", left, left)).min(axis=1)
    columns, good = orthonormal(left, candidate.separable_share)
    index = np.flatnonzero(good & (norms.min(axis=1) > 0.0))
    return Projected(candidate, columns[index], index, float(share.max()))
