"""The constant depends on how long the rotor had been running."""

from __future__ import annotations

import numpy as np

from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats
from surveyapp_models.effects.datum import asymptote
from surveyapp_models.effects.effect import Coefficient, Column, Columns, Effect, GridParameter


def basis(columns: Columns, /, **grid: float) -> Floats:
    """exp(-running time / tau)."""
    return np.exp(-columns["running_s"] / grid["tau_s"])[:, None]


def taus(columns: Columns) -> Floats:
    """5, 7.5, 10, 15, 20 and 30 minutes."""
    del columns
    return 60.0 * np.array([5.0, 7.5, 10.0, 15.0, 20.0, 30.0])


EFFECT = Effect(
    id="warm_up",
    title="Warm-up after spin-up",
    subject="campaign",
    needs=(Column("running_s", "s since spin-up"),),
    coefficients=(
        Coefficient(
            "initial offset", "arcsec", ARCSEC, -300.0, 300.0, "constant at spin-up minus settled"
        ),
    ),
    grid=(GridParameter("tau_s", "s", taus, "time in which it falls to 1/e", continuous=True),),
    basis=basis,
    datum="the constant when the instrument has settled",
    source="exponential settling, time constants of 5 to 30 minutes",
    remedy="Let the rotor run until the constant has settled; always begin after the same time.",
    symptom="early determinations after spin-up stood off",
    separate_by="determinations in the opposite order after a longer running time",
    per="instrument",
    confusable_with=("temperature", "gyro_block"),
    at_datum=asymptote,
)
