"""North follows the temperature during the run."""

from __future__ import annotations

import numpy as np

from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats
from surveyapp_models.effects.datum import reference_temperature
from surveyapp_models.effects.effect import Coefficient, Column, Columns, Effect


def basis(columns: Columns, /, **grid: float) -> Floats:
    """Theta - mean(theta)."""
    del grid
    theta = columns["temperature_c"]
    return np.asarray(theta - theta.mean())[:, None]


EFFECT = Effect(
    id="temperature",
    title="Temperature during the run",
    subject="reversal_run",
    needs=(Column("temperature_c", "degree Celsius"),),
    coefficients=(
        Coefficient("coefficient", "arcsec/K", ARCSEC, -60.0, 60.0, "change of north per kelvin"),
    ),
    basis=basis,
    datum="north at the session's reference temperature, else at the mean temperature",
    source="instrument calibration practice: first-order coefficient about a reference",
    remedy="Let the instrument reach the temperature of the place; log the temperature.",
    symptom="north followed the temperature",
    separate_by="a run in which the temperature goes the other way",
    confusable_with=("midpoint_drift", "warm_up"),
    at_datum=reference_temperature,
)
