"""The constant depends on the humidity of the air."""

from __future__ import annotations

from surveyapp_models.angles import ARCSEC
from surveyapp_models.effects.datum import at_mean_of, centred
from surveyapp_models.effects.effect import Coefficient, Column, Effect

EFFECT = Effect(
    id="humidity",
    title="Humidity of the air in the instrument constant",
    subject="campaign",
    needs=(Column("humidity_percent", "%"),),
    coefficients=(
        Coefficient(
            "coefficient",
            "arcsec/%",
            ARCSEC,
            -2.0,
            2.0,
            "change of constant per per cent of humidity",
        ),
    ),
    basis=centred("humidity_percent"),
    datum="the constant at the mean of the campaign",
    source="band and wiring take up water; no published coefficient is used",
    remedy=("Keep the instrument dry before it is used; note the humidity at every session."),
    symptom="the constant followed the humidity of the air",
    separate_by="determinations in damp and dry air at the same temperature",
    per="instrument",
    reference=at_mean_of("humidity_percent"),
)
