"""The magnetometer sits crookedly in the body whose attitude is known."""

from __future__ import annotations

import numpy as np

from surveyapp_models.arrays import Floats
from surveyapp_models.effects.compass import AXIS, FIELD, own_axis, three
from surveyapp_models.effects.effect import Coefficient, Columns, Effect


def basis(columns: Columns, /, **grid: float) -> Floats:
    """Small turns of the field about each axis along the row's axis, shape (n, 3) [uT]."""
    del grid
    field, own = three(columns, FIELD), own_axis(columns)
    return np.column_stack([np.sum(np.cross(turn, field) * own, axis=1) for turn in np.eye(3)])


EFFECT = Effect(
    id="misalignment",
    title="Misalignment of the magnetometer",
    subject="compass",
    needs=(AXIS, *FIELD),
    coefficients=tuple(
        Coefficient(
            f"misalignment_{a}", "deg", 0.017453292519943295, -180.0, 180.0, f"turn about {a}"
        )
        for a in "xyz"
    ),
    basis=basis,
    datum="field in the axes of the body",
    source="Kok and Schon 2016, sensor axes misalignment",
    remedy="Mount the sensor along the body's axes, or calibrate it with an attitude.",
    symptom="the field was turned against the body",
    separate_by="more attitudes, all over the sphere",
    confusable_with=("soft_iron",),
)
