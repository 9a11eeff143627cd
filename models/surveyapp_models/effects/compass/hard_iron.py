"""Magnetised iron that turns with the sensor adds a constant field in the body."""

from __future__ import annotations

from surveyapp_models.arrays import Floats
from surveyapp_models.effects.compass import AXIS, own_axis
from surveyapp_models.effects.effect import Coefficient, Columns, Effect


def basis(columns: Columns, /, **grid: float) -> Floats:
    """1 in the rows of each axis, shape (n, 3)."""
    del grid
    return own_axis(columns)


EFFECT = Effect(
    id="hard_iron",
    title="Hard iron",
    subject="compass",
    needs=(AXIS,),
    coefficients=tuple(
        Coefficient(f"hard_iron_{a}", "uT", 1.0, -1000.0, 1000.0, f"constant field along {a}")
        for a in "xyz"
    ),
    basis=basis,
    datum="field without the iron of the carrier",
    source="Gebre-Egziabher et al. 2006, hard iron",
    remedy="Calibrate the compass by an ellipsoid with this mounting, or take the iron away.",
    symptom="the field turned with the carrier by a constant amount",
    separate_by="the same turns with the sensor away from the carrier",
    confusable_with=("interference_step", "field_gradient", "temperature"),
)
