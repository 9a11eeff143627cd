"""Soft iron that turns with the sensor distorts the field in proportion to it."""

from __future__ import annotations

import numpy as np

from surveyapp_models.arrays import Floats
from surveyapp_models.effects.compass import AXIS, FIELD, SHAPES, SYMMETRIC, own_axis, three
from surveyapp_models.effects.effect import Coefficient, Columns, Effect


def basis(columns: Columns, /, **grid: float) -> Floats:
    """Symmetric distortion of the field along the row's axis, shape (n, 5) [uT]."""
    del grid
    bent = three(columns, FIELD) @ SHAPES
    return np.asarray(np.einsum("skn,nk->ns", bent.transpose(0, 2, 1), own_axis(columns)))


EFFECT = Effect(
    id="soft_iron",
    title="Soft iron",
    subject="compass",
    needs=(AXIS, *FIELD),
    coefficients=tuple(
        Coefficient(f"soft_iron_{s}", "1", 1.0, -1.0, 1.0, f"element {s} of the distortion")
        for s in SYMMETRIC
    ),
    basis=basis,
    datum="field without the iron of the carrier; its size is not told from the distortion",
    source="Gebre-Egziabher et al. 2006, soft iron",
    remedy="Calibrate the compass by a full ellipsoid with this mounting.",
    symptom="the field was stretched along an axis of the carrier",
    separate_by="more attitudes, all over the sphere",
    confusable_with=("misalignment", "field_gradient"),
)
