"""The zero of each axis depends on the temperature."""

from __future__ import annotations

from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Coefficient, Columns, Effect
from surveyapp_models.effects.tilt import AXIS, TEMPERATURE, by_axis


def basis(columns: Columns, /, **grid: float) -> Floats:
    """Theta - mean(theta) in the rows of each axis, shape (n, 2) [K]."""
    del grid
    theta = columns["temperature_c"]
    return by_axis(columns, theta - theta.mean())


EFFECT = Effect(
    id="temperature",
    title="Temperature coefficient of the zeros",
    subject="tilt",
    needs=(AXIS, TEMPERATURE),
    coefficients=tuple(
        Coefficient(f"temperature_{a}", "arcsec/K", 1.0, -1e4, 1e4, f"zero per kelvin {a}")
        for a in ("along", "across")
    ),
    basis=basis,
    datum="zeros at the mean temperature of the record",
    source="IEEE Std 1293, bias temperature sensitivity",
    remedy="Let the sensor reach its temperature, or use a card with its coefficient.",
    symptom="the zero followed the temperature",
    separate_by="the same tilts again at another temperature",
    confusable_with=("warm_up",),
)
