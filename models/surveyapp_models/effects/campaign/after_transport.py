"""The constant settles after transport."""

from __future__ import annotations

import numpy as np

from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats
from surveyapp_models.effects.datum import asymptote
from surveyapp_models.effects.effect import Coefficient, Column, Columns, Effect, GridParameter


def basis(columns: Columns, /, **grid: float) -> Floats:
    """exp(-time since transport / tau)."""
    return np.exp(-columns["transport_h"] / grid["tau_h"])[:, None]


def taus(columns: Columns) -> Floats:
    """2, 6 and 24 hours."""
    del columns
    return np.array([2.0, 6.0, 24.0])


EFFECT = Effect(
    id="after_transport",
    title="Settling after transport",
    subject="campaign",
    needs=(Column("transport_h", "h since transport"),),
    coefficients=(
        Coefficient(
            "initial offset", "arcsec", ARCSEC, -300.0, 300.0, "constant on arrival minus settled"
        ),
    ),
    grid=(GridParameter("tau_h", "h", taus, "time in which it falls to 1/e", continuous=True),),
    basis=basis,
    datum="the constant when the instrument has settled",
    source="creep of the band after shocks and tilts; exponential settling",
    remedy="Let the instrument stand in its place, upright and unclamped as its maker says.",
    symptom="the constant stood off after transport and settled",
    separate_by="determinations repeated at one station some hours and a day after arrival",
    per="instrument",
    at_datum=asymptote,
)
