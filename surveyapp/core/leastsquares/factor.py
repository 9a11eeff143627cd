"""Sparse block factorisation N = L D L' and the needed parts of the inverse.

Multifrontal elimination in batches; the inverse is computed only where the factor has entries
(Takahashi's recursion), which covers every pair of unknowns of one observation and every point.
Normal equations are formed here and nowhere else, in unknowns scaled to unit columns.

Source: I. S. Duff, J. K. Reid (1983), ACM TOMS 9, 302-325 (multifrontal); K. Takahashi, J. Fagan,
M.-S. Chin (1973); A. M. Erisman, W. F. Tinney (1975), Comm. ACM 18, 177-179.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from surveyapp.core.leastsquares.equations import ElementGroup, Ints
from surveyapp.core.leastsquares.symbolic import Batch, Plan
from surveyapp_models.arrays import Floats

PANEL = 64
"""Columns eliminated before the rest of a front is updated by one matrix product."""


@dataclass(frozen=True, slots=True)
class Factor:
    """Numeric factorisation.

    Parameters
    ----------
    plan : Plan
    buffer : float array
        Fronts after elimination: column j of an own unknown holds L below the diagonal.
    pivot_inverse : float array, shape (count,)
        1/D; 0 where the pivot vanished: that unknown is held at 0.
    vanished : int array
        Unknowns whose pivot vanished: the rank defect, one each.
    """

    plan: Plan
    buffer: Floats
    pivot_inverse: Floats
    vanished: Ints


def _assemble(plan: Plan, groups: Sequence[ElementGroup]) -> Floats:
    buffer = np.zeros(plan.length + 1)
    for group in groups:
        front, place, present = plan.locate(group.unknowns)
        products = np.einsum("nkp,nkq->npq", group.jacobian, group.jacobian)
        target = (
            plan.front_base[front][:, None, None]
            + place[:, :, None] * plan.front_size[front][:, None, None]
            + place[:, None, :]
        )
        target[~(present[:, :, None] & present[:, None, :])] = plan.length
        np.add.at(buffer, target.ravel(), products.ravel())
    return buffer[: plan.length]


def _eliminate(front: Floats, own: int, threshold: float) -> tuple[Floats, Floats]:
    """Eliminate the own unknowns of a batch in place; return 1/D (n, own) and who vanished."""
    inverse = np.zeros((len(front), own))
    for begin in range(0, own, PANEL):
        end = min(begin + PANEL, own)
        for j in range(begin, end):
            pivot = front[:, j, j]
            good = pivot > threshold
            inverse[:, j] = np.where(good, 1.0 / np.where(good, pivot, 1.0), 0.0)
            column = front[:, j + 1 :, j] * inverse[:, j, None]
            front[:, j + 1 :, j + 1 : end] -= column[:, :, None] * front[:, None, j, j + 1 : end]
            front[:, j + 1 :, j] = column
        lower = front[:, end:, begin:end]
        pivots = np.where(inverse[:, begin:end] > 0.0, 1.0, 0.0)
        pivots /= np.where(inverse[:, begin:end] > 0.0, inverse[:, begin:end], 1.0)
        front[:, end:, end:] -= (lower * pivots[:, None, :]) @ lower.swapaxes(1, 2)
    return inverse, inverse == 0.0


def _add_update(buffer: Floats, batch: Batch, front: Floats) -> None:
    own = batch.own
    target = (
        batch.parent_base[:, None, None]
        + batch.parent_place[:, :, None] * batch.parent_size[:, None, None]
        + batch.parent_place[:, None, :]
    )
    np.add.at(buffer, target.ravel(), front[:, own:, own:].ravel())


def factorise(plan: Plan, groups: Sequence[ElementGroup], threshold: float) -> Factor:
    """Factorise the normal matrix of whitened, column-scaled equations.

    Parameters
    ----------
    plan : Plan
    groups : sequence of ElementGroup
        With unit columns, so that every diagonal element of the normal matrix is 1.
    threshold : float
        A pivot not above it has vanished.

    Returns
    -------
    Factor
    """
    buffer = _assemble(plan, groups)
    pivot_inverse = np.zeros(plan.structure.count)
    vanished = [np.empty(0, dtype=np.int64)]
    for batch in plan.batches:
        front = buffer[batch.start : batch.stop].reshape(batch.shape)
        inverse, zero = _eliminate(front, batch.own, threshold)
        own_unknowns = batch.unknowns[:, : batch.own]
        pivot_inverse[own_unknowns] = inverse
        vanished.append(own_unknowns[zero])
        if zero.any():
            rows, columns = np.nonzero(zero)
            for row, column in zip(rows, columns, strict=True):
                front[row, column + 1 :, column] = 0.0
        if batch.unknowns.shape[1] > batch.own:
            _add_update(buffer, batch, front)
    return Factor(plan, buffer, pivot_inverse, np.concatenate(vanished))


def _fronts(factor: Factor, batch: Batch) -> Floats:
    return factor.buffer[batch.start : batch.stop].reshape(batch.shape)


def solve(factor: Factor, right: Floats) -> Floats:
    """Solve N x = b with vanished unknowns held at 0; ``right`` has shape (count, m)."""
    x = right.copy()
    for batch in factor.plan.batches:
        front = _fronts(factor, batch)
        for j in range(batch.own):
            value = x[batch.unknowns[:, j]]
            later = batch.unknowns[:, j + 1 :]
            np.subtract.at(x, later, front[:, j + 1 :, j, None] * value[:, None, :])
    x *= factor.pivot_inverse[:, None]
    return _back_substitute(factor, x)


def _back_substitute(factor: Factor, x: Floats) -> Floats:
    for batch in reversed(factor.plan.batches):
        front = _fronts(factor, batch)
        for j in range(batch.own - 1, -1, -1):
            later = x[batch.unknowns[:, j + 1 :]]
            x[batch.unknowns[:, j]] -= np.einsum("nr,nrm->nm", front[:, j + 1 :, j], later)
    return x


def null_space(factor: Factor) -> Floats:
    """Vectors that the normal matrix sends to zero, shape (count, defect): L' g = e_j."""
    vectors = np.zeros((factor.plan.structure.count, len(factor.vanished)))
    vectors[factor.vanished, np.arange(len(factor.vanished))] = 1.0
    return _back_substitute(factor, vectors)


def selected_inverse(factor: Factor) -> Floats:
    """Inverse in the pattern of the factor, as a buffer of the same layout.

    Vanished unknowns count as fixed: their rows and columns are 0.
    """
    inverse = np.zeros_like(factor.buffer)
    for batch in reversed(factor.plan.batches):
        front = _fronts(factor, batch)
        part = inverse[batch.start : batch.stop].reshape(batch.shape)
        own = batch.own
        if batch.unknowns.shape[1] > own:
            source = (
                batch.parent_base[:, None, None]
                + batch.parent_place[:, :, None] * batch.parent_size[:, None, None]
                + batch.parent_place[:, None, :]
            )
            part[:, own:, own:] = inverse[source]
        _invert_own(front, part, factor.pivot_inverse[batch.unknowns[:, :own]])
    return inverse


def _invert_own(front: Floats, part: Floats, pivots: Floats) -> None:
    """Rows and columns of the inverse that belong to the own unknowns of a batch, in place."""
    own = pivots.shape[1]
    for begin in range((own - 1) // PANEL * PANEL, -1, -PANEL):
        end = min(begin + PANEL, own)
        triangle = np.tril(front[:, begin:end, begin:end], -1) + np.eye(end - begin)
        unit = np.linalg.inv(triangle)  # unit lower triangular: always regular
        below = front[:, end:, begin:end] @ unit
        side = -part[:, end:, end:] @ below
        part[:, end:, begin:end] = side
        part[:, begin:end, end:] = side.swapaxes(1, 2)
        middle = (unit.swapaxes(1, 2) * pivots[:, None, begin:end]) @ unit
        part[:, begin:end, begin:end] = middle - below.swapaxes(1, 2) @ side


def inverse_blocks(plan: Plan, inverse: Floats, unknowns: Ints) -> Floats:
    """Blocks (n, p, p) of the inverse for sets of unknowns (n, p) that share an element."""
    front, place, present = plan.locate(unknowns)
    source = (
        plan.front_base[front][:, None, None]
        + place[:, :, None] * plan.front_size[front][:, None, None]
        + place[:, None, :]
    )
    blocks = inverse[source]
    blocks[~(present[:, :, None] & present[:, None, :])] = 0.0
    return blocks
