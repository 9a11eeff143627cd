"""All distances are too long or too short in proportion to their length."""

from __future__ import annotations

import numpy as np

from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Coefficient, Column, Columns, Effect


def basis(columns: Columns, /, **grid: float) -> Floats:
    """The distance; 0 for every other kind of observation."""
    del grid
    return np.asarray(columns["distance_m"], dtype=np.float64)[:, None]


EFFECT = Effect(
    id="distance_scale",
    title="Scale of the distances",
    subject="traverse",
    needs=(Column("distance_m", "m, 0 where no distance was observed"),),
    coefficients=(
        Coefficient("scale", "ppm", 1e-6, -1000.0, 1000.0, "observed minus true per length"),
    ),
    basis=basis,
    datum="the coordinates in the scale of the fixed points",
    source="Rueger 1996, Electronic Distance Measurement, ch. 5 (atmosphere) and 12 (scale)",
    remedy=(
        "Look first whether the atmosphere was corrected twice or not at all: what the instrument "
        "applies must not be applied again (1 degree Celsius or 3.5 hPa is 1 ppm). Then the "
        "reduction to the grid and to its height, then the frequency of the instrument."
    ),
    symptom="every distance were too long or too short in proportion to its length",
    separate_by="distances of very different length, or the instrument on a baseline",
    per="instrument",
    confusable_with=("distance_constant", "gross_error"),
)
