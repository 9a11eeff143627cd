"""One turning point was misread or miswritten."""

from __future__ import annotations

import numpy as np

from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import HALF_SWING, Coefficient, Columns, Effect, GridParameter


def basis(columns: Columns, /, **grid: float) -> Floats:
    """1 at the faulty reading, else 0."""
    return (np.abs(columns["half_swing"] - grid["point"]) < 1e-6).astype(np.float64)[:, None]


def points(columns: Columns) -> Floats:
    """Every turning point."""
    return np.unique(columns["half_swing"])


EFFECT = Effect(
    id="gross_error",
    title="Gross error of a reading",
    subject="reversal_run",
    needs=(HALF_SWING,),
    coefficients=(
        Coefficient(
            "error", "arcsec", ARCSEC, -36000.0, 36000.0, "what stands in the book minus the truth"
        ),
    ),
    grid=(GridParameter("point", "half swing", points, "the faulty turning point"),),
    basis=basis,
    acts_on="observation",
    datum="north over the run without the faulty reading",
    source="Baarda 1968, data snooping",
    remedy="Look at the book: whole minutes or degrees off are a slip of the pen; else strike it.",
    symptom="single readings stand off while their neighbours agree",
    separate_by="the book itself, or a repeated run",
    confusable_with=("midpoint_step",),
    event=True,
)
