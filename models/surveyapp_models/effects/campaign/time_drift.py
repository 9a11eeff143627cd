"""The constant ages evenly: band, bearings, lamp and mirror of the autocollimator."""

from __future__ import annotations

import numpy as np

from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats
from surveyapp_models.effects.datum import at_mean_date
from surveyapp_models.effects.effect import Coefficient, Column, Columns, Effect


def basis(columns: Columns, /, **grid: float) -> Floats:
    """T - mean(t)."""
    del grid
    time = columns["elapsed_days"]
    return np.asarray(time - time.mean())[:, None]


EFFECT = Effect(
    id="time_drift",
    title="Even drift of the instrument constant",
    subject="campaign",
    needs=(Column("elapsed_days", "d"),),
    coefficients=(
        Coefficient("drift", "arcsec/d", ARCSEC, -20.0, 20.0, "change of the constant per day"),
    ),
    basis=basis,
    datum="the constant at the mean date of the campaign",
    source="the 3-2-3 programme: Delta(t) linear between the calibrations before and after",
    remedy="Calibrate before and after each use and interpolate in time.",
    symptom="the constant moved by the same amount each day",
    separate_by="one more determination on the first line",
    per="instrument",
    confusable_with=("transport_step", "temperature", "line_offset", "latitude"),
    reference=at_mean_date,
)
