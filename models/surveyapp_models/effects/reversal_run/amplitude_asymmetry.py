"""The midpoint depends on the size of the swing: a follow-up or scale that is not symmetric."""

from __future__ import annotations

import numpy as np

from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import RELATIVE_AMPLITUDE, Coefficient, Columns, Effect


def basis(columns: Columns, /, **grid: float) -> Floats:
    """(A_k / A_0)^2."""
    del grid
    return np.asarray(columns["relative_amplitude"] ** 2)[:, None]


EFFECT = Effect(
    id="amplitude_asymmetry",
    title="Midpoint depending on the amplitude",
    subject="reversal_run",
    needs=(RELATIVE_AMPLITUDE,),
    coefficients=(
        Coefficient(
            "asymmetry",
            "arcsec",
            ARCSEC,
            -30.0,
            30.0,
            "shift of the midpoint at the amplitude of the first point",
        ),
    ),
    basis=basis,
    datum="north averaged over the run, the asymmetry included",
    source=(
        "a one-sided follow-up lag eps shifts north by lambda eps / 2 (integrated equation of "
        "motion): 30 arcsec for lambda 0.2 and a lag of 5 arcmin bound the range"
    ),
    remedy="Begin with a small swing; follow evenly in both directions.",
    symptom="the midpoint moved as the swing became smaller",
    separate_by="a run begun with half the amplitude",
    confusable_with=("warm_up", "midpoint_drift"),
)
