"""Eccentricity of the horizontal circle: enters through both circle readings."""

from __future__ import annotations

import numpy as np

from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Coefficient, Column, Columns, Effect


def basis(columns: Columns, /, **grid: float) -> Floats:
    """Sin and cos of the reading of gyro north minus those of the line.

    The constant is A_true - (R_line - R_north); a reading is too large by e1 sin R + e2 cos R.
    """
    del grid
    line, north = columns["line_reading"], columns["north_reading"]
    return np.column_stack([np.sin(north) - np.sin(line), np.cos(north) - np.cos(line)])


EFFECT = Effect(
    id="circle_eccentricity",
    title="Eccentricity of the horizontal circle",
    subject="campaign",
    needs=(Column("line_reading", "rad"), Column("north_reading", "rad")),
    coefficients=(
        Coefficient("sine", "arcsec", ARCSEC, -60.0, 60.0, "reading too large by e1 sin R"),
        Coefficient("cosine", "arcsec", ARCSEC, -60.0, 60.0, "reading too large by e2 cos R"),
    ),
    basis=basis,
    datum="the constant free of the circle's error",
    source="first harmonic of the circle error on each reading",
    remedy="Read both ends of the circle or shift the circle by 180 degrees / n between rounds.",
    symptom="the constant followed the part of the circle that was used",
    separate_by="rounds on one line with the circle shifted by 180 degrees / n",
    per="instrument",
    confusable_with=("line_offset",),
)
