"""A constant disturbing torque turns north by an amount that grows with sec(latitude)."""

from __future__ import annotations

import numpy as np

from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats
from surveyapp_models.effects.datum import at_mean_secant
from surveyapp_models.effects.effect import Coefficient, Column, Columns, Effect


def basis(columns: Columns, /, **grid: float) -> Floats:
    """sec(phi) - mean(sec(phi))."""
    del grid
    secant = 1.0 / np.cos(columns["latitude"])
    return np.asarray(secant - secant.mean())[:, None]


EFFECT = Effect(
    id="latitude",
    title="Constant growing with sec(latitude)",
    subject="campaign",
    needs=(Column("latitude", "rad"),),
    coefficients=(
        Coefficient(
            "torque at the equator",
            "arcsec",
            ARCSEC,
            -600.0,
            600.0,
            "deflection that the torque would give at the equator",
        ),
    ),
    basis=basis,
    datum="the constant at the mean sec(latitude) of the campaign",
    source="Delta(phi) = Delta_0 + k (sec phi - sec phi_0), k = torque / (H w)",
    remedy="Determine the constant at the latitude of the mine.",
    symptom="the constant followed the latitude",
    separate_by="two lines at one latitude, and one of them again at another season",
    per="instrument",
    confusable_with=("line_offset", "time_drift", "temperature"),
    reference=at_mean_secant,
)
