"""Distances follow the temperature of the air: the atmosphere was corrected wrongly, or not."""

from __future__ import annotations

import numpy as np

from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Coefficient, Column, Columns, Effect


def basis(columns: Columns, /, **grid: float) -> Floats:
    """Distance times temperature above the mean of the distances; 0 for every other kind."""
    del grid
    length, theta = columns["distance_m"], columns["distance_temperature_c"]
    observed = length > 0.0
    mean = float(theta[observed].mean()) if observed.any() else 0.0
    return np.where(observed, length * (theta - mean), 0.0)[:, None]


EFFECT = Effect(
    id="distance_temperature",
    title="Distances that follow the temperature",
    subject="traverse",
    needs=(
        Column("distance_m", "m, 0 where no distance was observed"),
        Column("distance_temperature_c", "C, 0 where no distance was observed"),
    ),
    coefficients=(
        Coefficient("rate", "ppm/K", 1e-6, -5.0, 5.0, "observed minus true per length and kelvin"),
    ),
    basis=basis,
    datum="the coordinates at the mean temperature of the distances",
    source="Rueger 1996, Electronic Distance Measurement, ch. 5: about 1 ppm per kelvin",
    remedy=(
        "Look whether the temperature was entered into the instrument: 1 ppm per kelvin is the "
        "atmosphere itself, not corrected; the opposite sign is a correction applied twice."
    ),
    symptom="distances of warm air were too long or too short against those of cold air",
    separate_by="the same sides at another temperature",
    per="instrument",
    confusable_with=("distance_scale", "gross_error"),
)
