"""Observation equations of a compiled network at given values: linearised, whitened, grouped."""

from __future__ import annotations

import numpy as np

from surveyapp.core.leastsquares.equations import ElementGroup
from surveyapp.core.network.linearise import LINEARISATION, OFFSETS, SHARING
from surveyapp.core.network.model import WIDEST, Model
from surveyapp_models.angles import wrap_pi_array
from surveyapp_models.arrays import Floats


def linearised(model: Model, values: Floats) -> tuple[Floats, Floats]:
    """Computed values (rows,) and partials (rows, WIDEST) at the given slot values."""
    computed = np.full(len(model.value), np.nan)
    partials = np.zeros((len(model.value), WIDEST))
    for kind, rows in model.by_kind:
        width = len(OFFSETS[kind]) + (kind in SHARING)
        result = LINEARISATION[kind](values, model.slots[rows, :width], model.constant[rows])
        computed[rows] = result.computed
        partials[rows, :width] = result.partials
    return computed, partials


def misclosures(model: Model, computed: Floats) -> Floats:
    """Observed minus computed, angles wrapped to (-pi, pi], shape (rows,)."""
    difference = model.value - computed
    difference[model.angular] = wrap_pi_array(difference[model.angular])
    return difference


def equations(model: Model, partials: Floats, misclosure: Floats) -> tuple[ElementGroup, ...]:
    """Whiten the linearised observations.

    Parameters
    ----------
    model : Model
    partials : float array, shape (rows, WIDEST)
    misclosure : float array, shape (rows,)

    Returns
    -------
    tuple of ElementGroup
        Independent observations by kind, then the correlated blocks by shape.
    """
    groups = []
    for rows in model.independent:
        unknowns = model.unknown_of[model.slots[rows]]
        used = (unknowns >= 0).any(axis=0)
        weight = 1.0 / model.sigma[rows]
        jacobian = np.where(unknowns >= 0, partials[rows], 0.0) * weight[:, None]
        groups.append(
            ElementGroup(
                rows[:, None],
                unknowns[:, used],
                jacobian[:, None, used],
                (misclosure[rows] * weight)[:, None],
                model.sigma[rows][:, None, None],
            )
        )
    for shape in model.blocks:
        n, k = shape.rows.shape
        width = shape.slots.shape[1]
        full = np.zeros((n, k, width + 1))
        np.put_along_axis(full, shape.place, partials[shape.rows], axis=2)
        unknowns = model.unknown_of[shape.slots]
        jacobian = np.where((unknowns >= 0)[:, None, :], full[:, :, :width], 0.0)
        right = misclosure[shape.rows][:, :, None]
        groups.append(
            ElementGroup(
                shape.rows,
                unknowns,
                np.asarray(np.linalg.solve(shape.root, jacobian), dtype=np.float64),
                np.asarray(np.linalg.solve(shape.root, right), dtype=np.float64)[:, :, 0],
                shape.root,
            )
        )
    return tuple(groups)
