"""One block of determinations (one spin-up, one day) stands off as a whole."""

from __future__ import annotations

import numpy as np

from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Coefficient, Column, Columns, Effect, GridParameter


def basis(columns: Columns, /, **grid: float) -> Floats:
    """1 in the block, else 0."""
    return np.asarray(columns["block"] == grid["block"], dtype=np.float64)[:, None]


def blocks(columns: Columns) -> Floats:
    """Inner blocks of at least two determinations; the first and last would be a step."""
    different, counts = np.unique(columns["block"], return_counts=True)
    inner = (counts >= 2) & (different != different[0]) & (different != different[-1])
    return np.asarray(different[inner], dtype=np.float64)


EFFECT = Effect(
    id="gyro_block",
    title="One block of determinations stands off",
    subject="campaign",
    needs=(Column("block", "number of the block, in order of time"),),
    coefficients=(
        Coefficient(
            "offset", "arcsec", ARCSEC, -300.0, 300.0, "constant in this block minus others"
        ),
    ),
    grid=(GridParameter("block", "number of the block", blocks, "the block that stands off"),),
    basis=basis,
    datum="the constant averaged over the determinations as observed",
    source="rotor stopped between rounds: clamping and spin-up move the rest position as a whole",
    remedy="Repeat the block; stop the rotor 10 to 15 minutes between rounds.",
    symptom="the determinations of one day or one spin-up stood off together",
    separate_by="a repetition of the block on the same line",
    per="session",
    confusable_with=("transport_step", "line_offset"),
    event=True,
)
