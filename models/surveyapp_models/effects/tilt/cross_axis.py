"""A tilt of one axis shows in the reading of the other."""

from __future__ import annotations

from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Coefficient, Columns, Effect
from surveyapp_models.effects.tilt import AXIS, OTHER, by_axis


def basis(columns: Columns, /, **grid: float) -> Floats:
    """Tilt of the other axis in the rows of each, shape (n, 2) [arcsec]."""
    del grid
    return by_axis(columns, columns["other_reference"])


EFFECT = Effect(
    id="cross_axis",
    title="Cross-axis sensitivity",
    subject="tilt",
    needs=(AXIS, OTHER),
    coefficients=tuple(
        Coefficient(f"cross_{a}", "1", 1.0, -1.0, 1.0, f"share of the other axis in {a}")
        for a in ("along", "across")
    ),
    basis=basis,
    datum="reading of an axis that the other does not reach",
    source="IEEE Std 1293, cross-axis sensitivity",
    remedy="Use a card with the cross terms, or mount the sensor along its axes.",
    symptom="an axis moved when the other was tilted",
    separate_by="tilts of one axis with the other held level",
    confusable_with=("scale_nonlinearity",),
)
