"""Sights along a wall of another temperature than the air are bent to one side."""

from __future__ import annotations

import numpy as np

from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Coefficient, Column, Columns, Effect


def basis(columns: Columns, /, **grid: float) -> Floats:
    """Signed length of the sights past a wall; an angle has that of its fore minus its back sight.

    A ray of constant curvature leaves both ends of its chord by half the curvature times the
    length, towards the same side: right of the line from one end, left of it from the other.
    """
    del grid
    return np.asarray(columns["wall_length_m"], dtype=np.float64)[:, None]


EFFECT = Effect(
    id="lateral_refraction",
    title="Lateral refraction along a wall",
    subject="traverse",
    needs=(Column("wall_length_m", "m, + wall to the right of the sight, - left, 0 none"),),
    coefficients=(
        Coefficient(
            "bending",
            "arcsec/100 m",
            ARCSEC / 100.0,
            -60.0,
            60.0,
            "direction of a sight of 100 m bent towards the wall",
        ),
    ),
    basis=basis,
    datum="the coordinates with every sight along a wall straightened",
    source=(
        "Johnston 1991, Lateral refraction in tunnels, Survey Review 31: curvature of the ray "
        "from the horizontal gradient of temperature"
    ),
    remedy=(
        "Set the stations alternately at both walls (zig-zag) or in the middle of the gallery; "
        "put gyro sides between; observe when the air is mixed."
    ),
    symptom="sights along a wall were bent to one side",
    separate_by="sights along the other wall (zig-zag), reciprocal sights or gyro sides",
    confusable_with=("angle_bias", "gyro_constant_shift", "gross_error"),
)
