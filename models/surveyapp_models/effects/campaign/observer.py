"""One observer differs from the others."""

from __future__ import annotations

import numpy as np

from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Coefficient, Column, Columns, Effect, GridParameter


def basis(columns: Columns, /, **grid: float) -> Floats:
    """1 where this observer observed, else 0."""
    return np.asarray(columns["observer"] == grid["observer"], dtype=np.float64)[:, None]


def observers(columns: Columns) -> Floats:
    """Every observer; of two the second."""
    different = np.unique(columns["observer"])
    if different.size < 2:
        return np.zeros(0)
    return different[1:] if different.size == 2 else different


EFFECT = Effect(
    id="observer",
    title="One observer differs",
    subject="campaign",
    needs=(Column("observer", "number of the observer"),),
    coefficients=(
        Coefficient("offset", "arcsec", ARCSEC, -120.0, 120.0, "constant of this observer"),
    ),
    grid=(GridParameter("observer", "number of the observer", observers, "who differs"),),
    basis=basis,
    datum="the constant averaged over the observers as they observed",
    source="personal equation in setting on the moving mark; one observer's difference in budgets",
    remedy=(
        "Let the observer who orients the mine determine the constant too, or let both observe in "
        "turns."
    ),
    symptom="one observer got another constant than the others",
    separate_by="both observers on one day and line, in turns",
    per="instrument",
    confusable_with=("gyro_block", "line_offset"),
)
