"""North approaches its final value exponentially: warming, creep after unclamping."""

from __future__ import annotations

import numpy as np

from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats
from surveyapp_models.effects.datum import asymptote
from surveyapp_models.effects.effect import HALF_SWING, Coefficient, Columns, Effect, GridParameter


def basis(columns: Columns, /, **grid: float) -> Floats:
    """exp(-t / tau)."""
    return np.exp(-columns["half_swing"] / grid["tau"])[:, None]


def taus(columns: Columns) -> Floats:
    """From 1.4 to 8.5 half swings (5 to 30 minutes)."""
    del columns
    return np.array([1.4, 1.8, 2.3, 2.9, 3.4, 4.0, 5.0, 6.0, 7.0, 8.5])


EFFECT = Effect(
    id="warm_up",
    title="Warm-up or creep at the beginning of the run",
    subject="reversal_run",
    needs=(HALF_SWING,),
    coefficients=(
        Coefficient(
            "initial offset", "arcsec", ARCSEC, -400.0, 400.0, "north at the first point minus end"
        ),
    ),
    grid=(
        GridParameter(
            "tau", "half swing", taus, "half swings in which it falls to 1/e", continuous=True
        ),
    ),
    basis=basis,
    datum="the asymptote: north when the instrument has settled",
    source="exponential settling, time constants of 5 to 30 minutes",
    remedy="Let the rotor run 10 to 15 minutes more before the first turning point.",
    symptom="north settled towards a final value",
    separate_by="more turning points at the end, or a second run directly after this one",
    confusable_with=("midpoint_drift", "midpoint_step", "amplitude_asymmetry"),
    at_datum=asymptote,
)
