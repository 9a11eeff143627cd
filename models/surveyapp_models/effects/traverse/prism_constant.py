"""One reflector has another constant than the others."""

from __future__ import annotations

import numpy as np

from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Coefficient, Column, Columns, Effect, GridParameter


def basis(columns: Columns, /, **grid: float) -> Floats:
    """1 for every distance to this reflector, else 0."""
    return np.asarray(columns["prism"] == grid["prism"], dtype=np.float64)[:, None]


def prisms(columns: Columns) -> Floats:
    """Every reflector but the one that most distances go to: that is the distance constant."""
    names, counts = np.unique(columns["prism"][columns["prism"] > 0.0], return_counts=True)
    return np.asarray(np.delete(names, np.argmax(counts)) if names.size else names)


EFFECT = Effect(
    id="prism_constant",
    title="Constant of one prism",
    subject="traverse",
    needs=(Column("prism", "number of the reflector, 0 where no distance was observed"),),
    coefficients=(
        Coefficient("constant", "mm", 1e-3, -100.0, 100.0, "observed minus true to this prism"),
    ),
    grid=(GridParameter("prism", "number", prisms, "the reflector that differs"),),
    basis=basis,
    datum="the coordinates with the distances to that prism corrected",
    source="Rueger 1996, Electronic Distance Measurement, ch. 13 (reflectors)",
    remedy="Compare the prisms at one mark; makers' constants differ by 17.5, 30 or 34.4 mm.",
    symptom="the distances to one prism were all too long or too short by the same amount",
    separate_by="the same mark measured with both prisms",
    per="instrument",
    confusable_with=("distance_constant", "gross_error"),
)
