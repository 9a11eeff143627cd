"""The rest position wanders evenly: tape creep, tripod twist, slowly changing torque."""

from __future__ import annotations

import numpy as np

from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import HALF_SWING, Coefficient, Columns, Effect


def basis(columns: Columns, /, **grid: float) -> Floats:
    """T - mean(t)."""
    del grid
    time = columns["half_swing"]
    return np.asarray(time - time.mean())[:, None]


EFFECT = Effect(
    id="midpoint_drift",
    title="Even drift of north",
    subject="reversal_run",
    needs=(HALF_SWING,),
    coefficients=(
        Coefficient(
            "drift", "arcsec/half swing", ARCSEC, -20.0, 20.0, "positive: north moves clockwise"
        ),
    ),
    basis=basis,
    datum="north in the middle of the run",
    source="a symmetric scheme of turning points returns north at mid-time under an even drift",
    remedy=(
        "Observe the tape zero before and after; sight the target before and after (tripod twist); "
        "keep the supply voltage constant."
    ),
    symptom="north moved by the same amount each half swing",
    separate_by="tape zeros and sights before and after, or more turning points",
    confusable_with=("warm_up", "midpoint_step", "amplitude_asymmetry", "temperature"),
)
