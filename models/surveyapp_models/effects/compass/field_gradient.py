"""The field of the place changes over the path of the sensor: iron in the room."""

from __future__ import annotations

import numpy as np

from surveyapp_models.arrays import Floats
from surveyapp_models.effects.compass import LEVEL, PLACE, SHAPES, SYMMETRIC, three
from surveyapp_models.effects.effect import Coefficient, Columns, Effect


def basis(columns: Columns, /, **grid: float) -> Floats:
    """Symmetric gradient times place along the row's axis, shape (n, 5) [m]."""
    del grid
    changed = three(columns, PLACE) @ SHAPES
    return np.asarray(np.einsum("snk,nk->ns", changed, three(columns, LEVEL)))


EFFECT = Effect(
    id="field_gradient",
    title="Gradient of the field of the place",
    subject="compass",
    needs=(*LEVEL, *PLACE),
    coefficients=tuple(
        Coefficient(f"gradient_{s}", "uT/m", 1.0, -1000.0, 1000.0, f"gradient {s}, level frame")
        for s in SYMMETRIC
    ),
    basis=basis,
    datum="field in the middle of the record",
    source="Maxwell: a static field without sources has a symmetric gradient of trace zero",
    remedy="Calibrate at one place, away from iron; stay there while turning.",
    symptom="the field followed the place",
    separate_by="the same turns at one place",
    confusable_with=("hard_iron", "interference_step", "soft_iron"),
)
