"""The scale factor of each gyro differs between positive and negative rates."""

from __future__ import annotations

import numpy as np

from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Coefficient, Columns, Effect
from surveyapp_models.effects.rate import GYRO_SIZES


def basis(columns: Columns, /, **grid: float) -> Floats:
    """Half the size of each gyro's own rate as the row has it, shape (n, 3) [rad/s]."""
    del grid
    return np.column_stack([columns[need.name] for need in GYRO_SIZES])


EFFECT = Effect(
    id="scale_asymmetry",
    title="Asymmetry of the scale factor",
    subject="rate",
    needs=GYRO_SIZES,
    coefficients=tuple(
        Coefficient(a, "ppm", 1e-6, -1e5, 1e5, f"excess of gyro {a} for positive rates")
        for a in "xyz"
    ),
    basis=basis,
    datum="biases at rest",
    source="IEEE Std 952, scale factor asymmetry",
    remedy="Use a scale factor for each sense, and take the bias at rest, not from turning.",
    symptom="turning either way raised the output",
    separate_by="turns at another rate, or a rest in the same position",
    confusable_with=("gross_error", "bias_ramp"),
)
