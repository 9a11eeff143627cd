"""The constant depends on the pressure of the air."""

from __future__ import annotations

from surveyapp_models.angles import ARCSEC
from surveyapp_models.effects.datum import at_mean_of, centred
from surveyapp_models.effects.effect import Coefficient, Column, Effect

EFFECT = Effect(
    id="pressure",
    title="Pressure of the air in the instrument constant",
    subject="campaign",
    needs=(Column("pressure_hpa", "hPa"),),
    coefficients=(
        Coefficient(
            "coefficient", "arcsec/hPa", ARCSEC, -2.0, 2.0, "change of constant per hectopascal"
        ),
    ),
    basis=centred("pressure_hpa"),
    datum="the constant at the mean of the campaign",
    source="damping and buoyancy of a suspended rotor in its gas; no published coefficient is used",
    remedy=("Note the pressure at every session; seal or vent the housing as its maker says."),
    symptom="the constant followed the pressure of the air",
    separate_by="determinations in other weather at the same temperature",
    per="instrument",
    reference=at_mean_of("pressure_hpa"),
)
