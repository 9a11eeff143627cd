"""The zero of each axis of the magnetometer depends on its temperature."""

from __future__ import annotations

import numpy as np

from surveyapp_models.arrays import Floats
from surveyapp_models.effects.compass import AXIS, TEMPERATURE, own_axis
from surveyapp_models.effects.effect import Coefficient, Columns, Effect


def basis(columns: Columns, /, **grid: float) -> Floats:
    """Theta - mean(theta) in the rows of each axis, shape (n, 3) [K]."""
    del grid
    theta = columns["temperature_c"]
    return np.asarray(own_axis(columns) * (theta - theta.mean())[:, None])


EFFECT = Effect(
    id="temperature",
    title="Temperature coefficient of the zeros",
    subject="compass",
    needs=(AXIS, TEMPERATURE),
    coefficients=tuple(
        Coefficient(f"temperature_{a}", "uT/K", 1.0, -100.0, 100.0, f"zero per kelvin along {a}")
        for a in "xyz"
    ),
    basis=basis,
    datum="zeros at the mean temperature of the record",
    source="data sheets of magnetometers, offset drift",
    remedy="Let the sensor reach its temperature, or use a card with its coefficient.",
    symptom="the field followed the temperature",
    separate_by="the same turns again at another temperature",
    confusable_with=("interference_step", "hard_iron"),
)
