"""Angles as pairs of directions: the same equations in a form that stays accurate in long chains.

See ``model`` for why. Used for large networks only; results are expressed in the network's own
observations again (``fold``).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from surveyapp.core.leastsquares.equations import Ints
from surveyapp.core.network.model import Model, number_unknowns
from surveyapp.core.network.quality import Quality
from surveyapp.domain.observations import ObservationKind
from surveyapp.domain.traverse import Status
from surveyapp_models.arrays import Floats


def with_orientations(model: Model, values: Floats) -> tuple[Model, Floats]:
    """Write every independent angle as two directions with an orientation of their own.

    Both directions get the sigma of the angle over the root of two: with their orientation
    eliminated they are the same equation, so nothing changes but the numerics (see the module).

    Parameters
    ----------
    model : Model
    values : float array
        All slots.

    Returns
    -------
    model, values
        The first slots are those of the given model; the new orientations follow them.
    """
    correlated = np.zeros(len(model.value), dtype=bool)
    for shape in model.blocks:
        correlated[shape.rows] = True
    angles = next((r for k, r in model.by_kind if k is ObservationKind.ANGLE), np.empty(0, int))
    angles = angles[~correlated[angles]]
    if not len(angles):
        return model, values
    slots = len(model.unknown_of) - 1
    theta = slots + np.arange(len(angles), dtype=np.int64)
    at, back, to = (model.slots[angles, i : i + 2] for i in (0, 2, 4))
    none = np.full((len(angles), 1), -1, dtype=np.int64)
    rays = [np.concatenate((at, target, theta[:, None], none), axis=1) for target in (back, to)]
    gap = values[back] - values[at]
    first = len(model.value)
    new = first + np.arange(2 * len(angles), dtype=np.int64)
    keep = np.ones(first, dtype=bool)
    keep[angles] = False
    by_kind = [(k, r[keep[r]]) for k, r in model.by_kind]
    half = model.sigma[angles] / np.sqrt(2.0)
    unknowns = number_unknowns(
        _slot_status(model),
        len(model.constants),
        np.concatenate((model.station_of, at[:, 0] // 3)),
    )
    return (
        replace(
            model,
            by_kind=(*((k, r) for k, r in by_kind if len(r)), (ObservationKind.DIRECTION, new)),
            slots=np.concatenate((model.slots, *rays)),
            constant=np.append(model.constant, np.zeros(len(new))),
            value=np.concatenate((model.value, np.zeros(len(angles)), model.value[angles])),
            sigma=np.concatenate((model.sigma, half, half)),
            angular=np.append(model.angular, np.ones(len(new), dtype=bool)),
            independent=(
                *(r[keep[r]] for r in model.independent if keep[r].any()),
                new,
            ),
            unknown_of=unknowns[0],
            slot_of=unknowns[1],
            structure=unknowns[2],
            datum_unknowns=unknowns[3],
            orientations=(*model.orientations, *_angle_names(model, angles)),
            station_of=np.concatenate((model.station_of, at[:, 0] // 3)),
            pairs=np.stack((angles, *np.split(new, 2)), axis=1),
        ),
        np.append(values, np.arctan2(gap[:, 0], gap[:, 1])),
    )


def _angle_names(model: Model, angles: Ints) -> list[tuple[str, str]]:
    return [
        (model.observations[row].at, f"{model.observations[row].back}-...")
        for row in angles.tolist()
    ]


def _slot_status(model: Model) -> list[Status]:
    """Status of each coordinate slot as far as the numbering of unknowns needs it."""
    status = np.where(model.unknown_of[: model.coordinate_slots] >= 0, 1, 0)
    status[model.slot_of[model.datum_unknowns]] = 2
    names = (Status.FIXED, Status.FREE, Status.CONSTRAINED)
    return [names[item] for item in status.tolist()]


def fold(model: Model, checked: Quality, rows: int) -> Quality:
    """Quality of the network's own observations from that of the pairs.

    The half difference of a pair carries the angle with its redundancy, their half sum only the
    orientation with none; so each direction has half the redundancy, and the standardized
    residual, the estimated error and the detectable bias of the angle.

    Parameters
    ----------
    model : Model
        With the pairs.
    checked : Quality
        Of all its rows.
    rows : int
        Observations of the network itself.
    """
    if not len(model.pairs):
        return checked
    angle, back, fore = model.pairs.T
    redundancy, standardized, adjusted, error, mdb, effect = (
        values[:rows].copy()
        for values in (
            checked.redundancy,
            checked.standardized,
            checked.sigma_adjusted,
            checked.error,
            checked.mdb,
            checked.effect,
        )
    )
    redundancy[angle] = checked.redundancy[back] + checked.redundancy[fore]
    standardized[angle] = checked.standardized[fore]
    share = np.maximum(1.0 - redundancy[angle], 0.0)
    adjusted[angle] = model.sigma[angle] * np.sqrt(share)
    error[angle] = checked.error[fore]
    mdb[angle] = checked.mdb[fore]
    effect[angle] = np.maximum(checked.effect[back], checked.effect[fore])
    return Quality(redundancy, standardized, adjusted, error, mdb, effect)
