"""The constant depends on the supply voltage."""

from __future__ import annotations

from surveyapp_models.angles import ARCSEC
from surveyapp_models.effects.datum import at_mean_of, centred
from surveyapp_models.effects.effect import Coefficient, Column, Effect

EFFECT = Effect(
    id="supply_voltage",
    title="Supply voltage in the instrument constant",
    subject="campaign",
    needs=(Column("supply_v", "V"),),
    coefficients=(
        Coefficient(
            "coefficient", "arcsec/V", ARCSEC, -100.0, 100.0, "change of constant per volt"
        ),
    ),
    basis=centred("supply_v"),
    datum="the constant at the mean of the campaign",
    source=(
        "angular momentum follows the speed of the rotor; a KT 1 wandered by 4'44\" in a day on a "
        "failing battery"
    ),
    remedy=("Charge or replace the battery; read the voltage before every swing and at its end."),
    symptom="the constant followed the supply voltage",
    separate_by="determinations with a fresh and a used battery on one day",
    per="instrument",
    reference=at_mean_of("supply_v"),
)
