"""The constant depends on the temperature of the instrument."""

from __future__ import annotations

import numpy as np

from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats
from surveyapp_models.effects.datum import at_mean_temperature, reference_temperature
from surveyapp_models.effects.effect import Coefficient, Column, Columns, Effect


def basis(columns: Columns, /, **grid: float) -> Floats:
    """Theta - mean(theta)."""
    del grid
    theta = columns["temperature_c"]
    return np.asarray(theta - theta.mean())[:, None]


EFFECT = Effect(
    id="temperature",
    title="Temperature coefficient of the instrument constant",
    subject="campaign",
    needs=(Column("temperature_c", "degree Celsius"),),
    coefficients=(
        Coefficient(
            "coefficient", "arcsec/K", ARCSEC, -10.0, 10.0, "change of constant per kelvin"
        ),
    ),
    basis=basis,
    datum="the constant at the reference temperature, else at the mean of the campaign",
    source=(
        "Delta = Delta_0 + a (theta - theta_0), instrument calibration practice; over 50 K it is "
        "not linear: a Gyromat 2000 needed a hyperbolic term as well (zfv 4/2004, abstract)"
    ),
    remedy=(
        "Let the instrument reach the temperature of the place; determine the constant at the "
        "temperature of the mine, or apply the coefficient inside its range."
    ),
    symptom="the constant followed the temperature",
    separate_by="determinations at another temperature in the same season",
    per="instrument",
    confusable_with=("time_drift", "latitude", "warm_up"),
    at_datum=reference_temperature,
    reference=at_mean_temperature,
)
