"""The constant jumped once: transport, a knock, a repair, a new band."""

from __future__ import annotations

import numpy as np

from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats
from surveyapp_models.effects.datum import at_last_date, both_plateaus
from surveyapp_models.effects.effect import Coefficient, Column, Columns, Effect, GridParameter

FEW = 6
"""Below this number of dates a plateau may consist of one determination."""


def basis(columns: Columns, /, **grid: float) -> Floats:
    """H(t - t0)."""
    return (columns["elapsed_days"] > grid["after_day"] + 1e-9).astype(np.float64)[:, None]


def positions(columns: Columns) -> Floats:
    """Last date before the step, two determinations on either side (one where there are few)."""
    dates = np.sort(columns["elapsed_days"])
    margin = 2 if dates.size >= FEW else 1
    inner = dates[margin - 1 : dates.size - margin]
    return np.unique(inner[inner < dates[-margin]])


EFFECT = Effect(
    id="transport_step",
    title="Step of the instrument constant",
    subject="campaign",
    needs=(Column("elapsed_days", "d"),),
    coefficients=(
        Coefficient("step", "arcsec", ARCSEC, -300.0, 300.0, "constant after minus before"),
    ),
    grid=(GridParameter("after_day", "d", positions, "last determination before the step"),),
    basis=basis,
    datum="the constant after the step counts for later work",
    source="the 3-2-3 programme: stability of the constant before and after",
    remedy="Use only the determinations after the step; look for its cause.",
    symptom="the constant jumped once",
    separate_by="repeat the determination on the first line",
    per="instrument",
    confusable_with=("time_drift", "line_offset", "gyro_block"),
    at_datum=both_plateaus,
    reference=at_last_date,
    event=True,
)
