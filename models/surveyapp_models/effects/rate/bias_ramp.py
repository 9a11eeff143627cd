"""The bias of each gyro drifts evenly with time."""

from __future__ import annotations

from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Coefficient, Columns, Effect
from surveyapp_models.effects.rate import AXIS, DEG_S, ELAPSED, by_axis


def basis(columns: Columns, /, **grid: float) -> Floats:
    """Minutes from the middle of the record in the rows of each gyro, shape (n, 3)."""
    del grid
    minutes = columns["elapsed_s"] / 60.0
    return by_axis(columns, minutes - minutes.mean())


EFFECT = Effect(
    id="bias_ramp",
    title="Drift of the gyro bias",
    subject="rate",
    needs=(AXIS, ELAPSED),
    coefficients=tuple(
        Coefficient(a, "deg/s/min", DEG_S, -5.0, 5.0, f"drift of gyro {a} per minute")
        for a in "xyz"
    ),
    basis=basis,
    datum="biases in the middle of the record",
    source="IEEE Std 952, rate ramp",
    remedy="Warm up longer; take the bias anew at each stop.",
    symptom="the bias drifted with time",
    separate_by="the same stops again at once, without another change of temperature",
    confusable_with=("temperature", "g_sensitivity"),
)
