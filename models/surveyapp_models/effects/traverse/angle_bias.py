"""Every turned angle is wrong by the same amount: the tripod twists, or a collimation is left."""

from __future__ import annotations

import numpy as np

from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Coefficient, Column, Columns, Effect


def basis(columns: Columns, /, **grid: float) -> Floats:
    """Sights turned since the first of the set: 1 for an angle, 0, 1, 2 ... for directions."""
    del grid
    return np.asarray(columns["sights_turned"], dtype=np.float64)[:, None]


EFFECT = Effect(
    id="angle_bias",
    title="Bias of the turned angles",
    subject="traverse",
    needs=(Column("sights_turned", "sights since the first of the set, 0 elsewhere"),),
    coefficients=(
        Coefficient("bias", "arcsec", ARCSEC, -120.0, 120.0, "angle observed minus true"),
    ),
    basis=basis,
    datum="the coordinates with every angle freed of the bias",
    source="Cooper 1982, Modern Theodolites and Levels: twist of the support, one face only",
    remedy=(
        "Observe on both faces and close every set on the first target; half of the sets in the "
        "opposite order; let the tripod settle."
    ),
    symptom="every turned angle were wrong by the same amount in the same sense",
    separate_by=(
        "sets turned in the opposite order, gyro sides between the angles, and zig-zag or "
        "reciprocal sights against lateral refraction"
    ),
    per="instrument",
    confusable_with=("lateral_refraction", "gyro_constant_shift", "gross_error"),
)
