"""All distances are too long or too short by the same amount: the prism or its constant."""

from __future__ import annotations

import numpy as np

from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Coefficient, Column, Columns, Effect


def basis(columns: Columns, /, **grid: float) -> Floats:
    """1 for every distance, else 0."""
    del grid
    return np.asarray(columns["distance_m"] > 0.0, dtype=np.float64)[:, None]


EFFECT = Effect(
    id="distance_constant",
    title="Additive constant of the distances",
    subject="traverse",
    needs=(Column("distance_m", "m, 0 where no distance was observed"),),
    coefficients=(Coefficient("constant", "mm", 1e-3, -100.0, 100.0, "observed minus true"),),
    basis=basis,
    datum="the coordinates with every distance freed of the constant",
    source="Rueger 1996, Electronic Distance Measurement, ch. 12",
    remedy=(
        "Compare the constant set in the instrument with the prism that was used (round, mini and "
        "360 degree prisms differ by 10 to 35 mm); determine it on a line in three parts."
    ),
    symptom="every distance were too long or too short by the same amount",
    separate_by="short and long distances in one network, or a line measured whole and in parts",
    per="instrument",
    confusable_with=("distance_scale", "distance_cyclic", "gross_error"),
)
