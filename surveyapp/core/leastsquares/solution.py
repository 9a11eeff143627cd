"""Solve a whitened system: corrections, rank defect, datum, blocks of the cofactor matrix.

Small systems go through a dense singular value decomposition of the equations themselves, large
ones through the sparse factor of the normal equations; both deliver the same values. A defect is
taken away by the inner constraints of the unknowns that carry the datum; what stays undetermined
is returned by number, never guessed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from surveyapp.core.leastsquares import factor as sparse
from surveyapp.core.leastsquares.equations import (
    ElementGroup,
    Ints,
    Structure,
    column_norms,
    dense_jacobian,
    gradient,
    product,
    scaled,
)
from surveyapp.core.leastsquares.symbolic import Plan
from surveyapp_models.arrays import Floats

DENSE_UNKNOWNS = 160
"""Up to this many unknowns the dense route is at least as quick."""
RANK_TOLERANCE = 1e-9
"""Relative singular value below which a direction is undetermined: far above rounding (1e-14 for
columns of length 1), far below the weakest geometry that deserves a result (1e-7)."""
PIVOT_TOLERANCES = (1e-11, 1e-13, 1e-14, 0.0)
"""Pivots of the scaled normal matrix below which an unknown is suspected to be undetermined. The
suspicion is checked with the equations themselves (``NULL_TOLERANCE``); if it proves wrong the
system is weak but determined (a loop of thousands of legs), and the next one is tried. Rounding
leaves about 1e-15 of a pivot that vanishes."""
NULL_TOLERANCE = 1e-6
"""Largest |A g| of a unit vector g that counts as a true null vector."""


@dataclass(frozen=True, slots=True)
class Datum:
    """How the inner constraints change a minimally constrained solution (S-transformation).

    Parameters
    ----------
    basis : float array, shape (count, d)
        Null space G.
    gain : float array, shape (count, d)
        D G (G'DG)^-1, so that x_S = x - G gain'x.
    """

    basis: Floats
    gain: Floats


@dataclass(frozen=True, slots=True)
class Solved:
    """Result of one linear solution.

    Parameters
    ----------
    correction : float array, shape (count,)
    defect : int
        Rank defect of the system before the datum.
    undetermined : int array
        Unknowns that neither the observations nor the datum determine; empty where all is well.
    decrease : float
        Predicted decrease of the weighted sum of squares.
    cofactor : Cofactor
    """

    correction: Floats
    defect: int
    undetermined: Ints
    decrease: float
    cofactor: Cofactor


@dataclass(frozen=True, slots=True)
class Cofactor:
    """Cofactor matrix of the unknowns, its needed parts only.

    Parameters
    ----------
    norms : float array
        Column norms: cofactors of the scaled system are divided by them.
    datum : Datum or None
    full : float array or None
        Whole matrix of a small system, minimally constrained, scaled.
    factor : Factor or None
        Sparse factor of a large one.
    cache : list
        Selected inverse and datum products, computed when first asked for.
    """

    norms: Floats
    datum: Datum | None
    full: Floats | None = None
    factor: sparse.Factor | None = None
    cache: list[Floats] = field(default_factory=list)

    def blocks(self, unknowns: Ints) -> Floats:
        """Cofactors (n, p, p) of sets of unknowns (n, p) that share an element; -1 gives 0."""
        if self.full is not None:
            padded = np.zeros((len(self.full) + 1,) * 2)
            padded[:-1, :-1] = self.full
            values = padded[unknowns[:, :, None], unknowns[:, None, :]]
        else:
            values = self._sparse_blocks(unknowns)
        inverse = np.append(1.0 / self.norms, 0.0)[unknowns]
        return np.asarray(values * inverse[:, :, None] * inverse[:, None, :])

    def columns(self, unknowns: Ints) -> Floats:
        """Whole columns (count, m) of the cofactor matrix for a few unknowns."""
        unit = np.zeros((len(self.norms), len(unknowns)))
        unit[unknowns, np.arange(len(unknowns))] = 1.0 / self.norms[unknowns]
        return np.asarray(self.apply(unit) / self.norms[:, None])

    def apply(self, right: Floats) -> Floats:
        """Cofactor matrix of the scaled system, datum included, times ``right`` (count, m)."""
        if self.datum is not None:
            right = right - self.datum.gain @ (self.datum.basis.T @ right)
        result = self._minimal(right)
        if self.datum is not None:
            result = result - self.datum.basis @ (self.datum.gain.T @ result)
        return result

    def _minimal(self, right: Floats) -> Floats:
        if self.full is not None:
            return np.asarray(self.full @ right)
        assert self.factor is not None
        return sparse.solve(self.factor, right)

    def _sparse_blocks(self, unknowns: Ints) -> Floats:
        assert self.factor is not None
        if not self.cache:
            self.cache.append(sparse.selected_inverse(self.factor))
            if self.datum is not None:
                self.cache.append(self._minimal(self.datum.gain))
        values = sparse.inverse_blocks(self.factor.plan, self.cache[0], unknowns)
        if self.datum is None:
            return values
        pad = np.zeros((1, self.datum.basis.shape[1]))
        basis = np.vstack((self.datum.basis, pad))[unknowns]
        side = np.vstack((self.cache[1], pad))[unknowns]
        middle = self.datum.gain.T @ self.cache[1]
        mixed = np.einsum("npd,nqd->npq", basis, side)
        inner = np.einsum("npd,de,nqe->npq", basis, middle, basis)
        return np.asarray(values - mixed - mixed.swapaxes(1, 2) + inner)


def solve(
    groups: Sequence[ElementGroup],
    structure: Structure,
    datum_unknowns: Ints,
    *,
    offset: Floats | None = None,
    plan: Plan | None = None,
) -> Solved:
    """Solve the least-squares problem of whitened equations.

    Parameters
    ----------
    groups : sequence of ElementGroup
    structure : Structure
    datum_unknowns : int array
        Unknowns whose corrections carry the inner constraints.
    offset : float array, shape (count,), optional
        What the unknowns have already been corrected by: the constraint holds for offset +
        correction.
    plan : Plan, optional
        Symbolic factorisation; with it the sparse route is taken.

    Returns
    -------
    Solved
    """
    norms = column_norms(groups, structure.count)
    unit = scaled(groups, norms)
    right = gradient(unit, structure.count)
    if plan is None:
        full, basis = _dense(unit, structure.count)
        cofactor = Cofactor(norms, None, full=full)
        x = full @ right
    else:
        factor, basis = _sparse(unit, plan)
        cofactor = Cofactor(norms, None, factor=factor)
        x = sparse.solve(factor, right[:, None])[:, 0]
    decrease = float(right @ x)
    datum, undetermined = _datum(basis, norms, datum_unknowns)
    if datum is not None:
        start = np.zeros_like(x) if offset is None else offset * norms
        x = x - datum.basis @ (datum.gain.T @ (x + start))
        cofactor = Cofactor(norms, datum, full=cofactor.full, factor=cofactor.factor)
        if cofactor.full is not None:
            cofactor = _transformed(cofactor)
    return Solved(x / norms, basis.shape[1], undetermined, decrease, cofactor)


def _transformed(cofactor: Cofactor) -> Cofactor:
    full = cofactor.apply(np.eye(len(cofactor.norms)))
    return Cofactor(cofactor.norms, None, full=(full + full.T) / 2.0)


def _dense(unit: Sequence[ElementGroup], count: int) -> tuple[Floats, Floats]:
    """Pseudo-inverse of the scaled normal matrix and a basis of its null space."""
    matrix, _ = dense_jacobian(unit, count)
    if len(matrix) < count:
        matrix = np.vstack((matrix, np.zeros((count - len(matrix), count))))
    _, values, rows = np.linalg.svd(np.linalg.qr(matrix, mode="r"))
    good = values > RANK_TOLERANCE * max(float(values[0]), 1e-300)
    right = rows[good].T / values[good]
    return right @ right.T, rows[~good].T


def _sparse(unit: Sequence[ElementGroup], plan: Plan) -> tuple[sparse.Factor, Floats]:
    for threshold in PIVOT_TOLERANCES:
        factor = sparse.factorise(plan, unit, threshold)
        basis = sparse.null_space(factor)
        lengths = np.linalg.norm(basis, axis=0)
        if not bool((product(unit, basis) > NULL_TOLERANCE * lengths).any()):
            break
    return factor, basis


def _datum(basis: Floats, norms: Floats, datum_unknowns: Ints) -> tuple[Datum | None, Ints]:
    """Datum of the unknowns that carry it, and the unknowns that it leaves undetermined."""
    none = np.empty(0, dtype=np.int64)
    if basis.shape[1] == 0:
        return None, none
    physical = basis / norms[:, None]
    physical = physical / np.abs(physical).max(axis=0)
    carried = np.zeros_like(physical)
    carried[datum_unknowns] = physical[datum_unknowns]
    lengths = np.linalg.norm(physical[datum_unknowns], axis=0) if len(datum_unknowns) else 0.0
    weight = 1.0 / np.where(lengths > 0.0, lengths, 1.0) * np.ones(basis.shape[1])
    values, vectors = np.linalg.eigh((carried * weight).T @ (carried * weight))
    open_ = values <= 1e-10 * max(float(values.max()), 1e-3)
    if open_.any():
        left = np.abs(physical @ (weight[:, None] * vectors[:, open_]))
        left = left / left.max(axis=0)
        return None, np.flatnonzero((left > 1e-5).any(axis=1))
    gain = carried @ np.linalg.inv(carried.T @ physical)
    return Datum(physical * norms[:, None], gain / norms[:, None]), none
