"""Single rows of the log are wrong: a spark, a lost bit, a knock."""

from __future__ import annotations

import numpy as np

from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Coefficient, Column, Columns, Effect, GridParameter

ROW = Column("row", "number of the log's row, from 1")


def basis(columns: Columns, /, **grid: float) -> Floats:
    """1 in the faulty row, else 0, shape (n, 1)."""
    return np.asarray(columns["row"] == grid["row"], dtype=np.float64)[:, None]


def rows(columns: Columns) -> Floats:
    """Number of every row."""
    return np.unique(columns["row"])


EFFECT = Effect(
    id="gross_error",
    title="Gross errors of single rows",
    subject="tilt",
    needs=(ROW,),
    coefficients=(Coefficient("error", "arcsec", 1.0, -1e6, 1e6, "reading too large by"),),
    grid=(GridParameter("row", "number", rows, "of the log"),),
    basis=basis,
    acts_on="observation",
    datum="record without these rows",
    source="Baarda 1968, data snooping",
    remedy="Look at these rows of the log; leave them out.",
    symptom="single rows stood off from their neighbours",
    separate_by="the same record once more",
    confusable_with=("scale_nonlinearity",),
    event=True,
)
