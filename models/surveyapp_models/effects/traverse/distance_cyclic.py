"""Cyclic error of the distance meter: a sine in the distance with its unit length as period."""

from __future__ import annotations

import math

import numpy as np

from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Coefficient, Column, Columns, Effect, GridParameter

UNIT_LENGTHS_M = (1.5, 10.0, 20.0)
"""Half the modulation wavelength: 100, 15 and 7.5 MHz."""
LARGEST_AMPLITUDE_M = 5e-3
"""No distance meter in order errs by more: 5 mm of 10 m were large in the first generation."""


def basis(columns: Columns, /, **grid: float) -> Floats:
    """Sine and cosine of the distance in its unit length; 0 where no distance was observed."""
    length = columns["distance_m"]
    phase = 2.0 * math.pi * length / grid["unit_length"]
    observed = length > 0.0
    return np.column_stack([np.where(observed, f(phase), 0.0) for f in (np.sin, np.cos)])


def unit_lengths(columns: Columns) -> Floats:
    """The unit lengths of common instruments."""
    del columns
    return np.array(UNIT_LENGTHS_M)


EFFECT = Effect(
    id="distance_cyclic",
    title="Cyclic error of the distance meter",
    subject="traverse",
    needs=(Column("distance_m", "m, 0 where no distance was observed"),),
    coefficients=(
        Coefficient("sine", "mm", 1e-3, -5.0, 5.0, "too long by this times sin(2 pi D / U)"),
        Coefficient("cosine", "mm", 1e-3, -5.0, 5.0, "too long by this times cos(2 pi D / U)"),
    ),
    grid=(GridParameter("unit_length", "m", unit_lengths, "half the modulation wavelength"),),
    basis=basis,
    datum="the coordinates with every distance freed of the cyclic term",
    source="Rueger 1996, Electronic Distance Measurement, ch. 12",
    remedy="Have the instrument calibrated on a baseline whose lengths cover the unit length.",
    symptom="the distances were wrong by a wave that repeats with the unit length",
    separate_by="distances spread over the whole unit length",
    per="instrument",
    confusable_with=("distance_constant", "gross_error"),
)
