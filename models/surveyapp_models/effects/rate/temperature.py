"""The bias of each gyro depends on its temperature."""

from __future__ import annotations

from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Coefficient, Columns, Effect
from surveyapp_models.effects.rate import AXIS, DEG_S, TEMPERATURE, by_axis


def basis(columns: Columns, /, **grid: float) -> Floats:
    """Theta - mean(theta) in the rows of each gyro, shape (n, 3) [K]."""
    del grid
    theta = columns["temperature_c"]
    return by_axis(columns, theta - theta.mean())


EFFECT = Effect(
    id="temperature",
    title="Temperature coefficient of the gyro bias",
    subject="rate",
    needs=(AXIS, TEMPERATURE),
    coefficients=tuple(
        Coefficient(a, "deg/s/K", DEG_S, -1.0, 1.0, f"bias of gyro {a} per kelvin") for a in "xyz"
    ),
    basis=basis,
    datum="biases at the mean temperature of the record",
    source="IEEE Std 952, temperature sensitivity of the bias",
    remedy="Let the sensor warm up; calibrate it over the temperatures of its use.",
    symptom="the bias followed the temperature",
    separate_by="the same stops again when warm, or in another order",
    confusable_with=("bias_ramp", "g_sensitivity"),
)
