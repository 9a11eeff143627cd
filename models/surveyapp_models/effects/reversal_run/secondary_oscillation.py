"""A second slow oscillation of the rest position, the "high-low" pattern."""

from __future__ import annotations

import numpy as np

from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import HALF_SWING, Coefficient, Columns, Effect, GridParameter

SHORTEST = 4.0
"""Shortest period [half swings] that turning points can tell from the swing itself."""
OVERSAMPLING = 4.0
"""Frequencies per independent frequency, so that no peak falls between two of them."""


def basis(columns: Columns, /, **grid: float) -> Floats:
    """Cos and sin of 2 pi t / P."""
    phase = 2.0 * np.pi * columns["half_swing"] / grid["period"]
    return np.column_stack([np.cos(phase), np.sin(phase)])


def periods(columns: Columns) -> Floats:
    """From 4 half swings to the length of the run / 1.5, evenly in frequency."""
    length = float(np.ptp(columns["half_swing"])) + 1.0
    longest = length / 1.5
    if longest <= SHORTEST:
        return np.zeros(0)
    count = 1 + int(np.ceil(OVERSAMPLING * length * (1.0 / SHORTEST - 1.0 / longest)))
    return 1.0 / np.linspace(1.0 / longest, 1.0 / SHORTEST, count)


EFFECT = Effect(
    id="secondary_oscillation",
    title="Second slow oscillation of north",
    subject="reversal_run",
    needs=(HALF_SWING,),
    coefficients=(
        Coefficient("cosine", "arcsec", ARCSEC, -200.0, 200.0, "cosine part at the first point"),
        Coefficient("sine", "arcsec", ARCSEC, -200.0, 200.0, "sine part at the first point"),
    ),
    grid=(
        GridParameter(
            "period", "half swing", periods, "period of the second oscillation", continuous=True
        ),
    ),
    basis=basis,
    datum="north averaged over the run",
    source="Williams & Belling 1967: period about 15 half swings in 45 points",
    remedy="Observe whole periods of it; shield the instrument from drafts and machinery.",
    symptom="north went to and fro slowly",
    separate_by="a run of at least twice the period",
    confusable_with=("midpoint_step", "warm_up", "midpoint_drift"),
)
