"""The bias of a fibre-optic gyro follows the magnetic field along it (Faraday effect)."""

from __future__ import annotations

import math

from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Coefficient, Columns, Effect
from surveyapp_models.effects.rate import AXIS, FIELDS, by_axis, own


def basis(columns: Columns, /, **grid: float) -> Floats:
    """Field along the gyro's own axis, shape (n, 3) [T]."""
    del grid
    return by_axis(columns, own(columns, "field"))


EFFECT = Effect(
    id="magnetic_sensitivity",
    title="Magnetic sensitivity of the gyro bias",
    subject="rate",
    needs=(AXIS, *FIELDS),
    coefficients=tuple(
        Coefficient(
            a, "deg/h/T", math.radians(1.0) / 3600.0, -1e7, 1e7, f"bias of gyro {a} per tesla"
        )
        for a in "xyz"
    ),
    basis=basis,
    datum="biases without a field",
    source="source 000-7: 10^4 deg/h/T unshielded (printed as 104)",
    remedy="Shield the gyro, keep it from motors and cables, or correct by a fluxgate.",
    symptom="the bias followed the magnetic field",
    separate_by="the same stop with the field reversed",
    confusable_with=("temperature", "g_sensitivity"),
)
