"""The bias of each gyro depends on the specific force along each axis."""

from __future__ import annotations

import numpy as np

from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Coefficient, Columns, Effect
from surveyapp_models.effects.rate import DEG_S, GYRO_FORCES


def basis(columns: Columns, /, **grid: float) -> Floats:
    """Force along x, y, z as the row has it through each gyro, shape (n, 9) [m/s2]."""
    del grid
    return np.column_stack([columns[need.name] for need in GYRO_FORCES])


EFFECT = Effect(
    id="g_sensitivity",
    title="Sensitivity of the gyro bias to gravity",
    subject="rate",
    needs=GYRO_FORCES,
    coefficients=tuple(
        Coefficient(
            f"{a}{b}", "deg/s per m/s2", DEG_S, -0.1, 0.1, f"bias of gyro {a} per force along {b}"
        )
        for a in "xyz"
        for b in "xyz"
    ),
    basis=basis,
    datum="biases without gravity",
    source="IEEE Std 1554, linear acceleration sensitivity",
    remedy="Correct the bias by the force that the accelerometers show, or choose another gyro.",
    symptom="the bias followed the attitude of the sensor",
    separate_by="more stops in other attitudes at one temperature",
    confusable_with=("temperature", "bias_ramp", "gross_error"),
)
