"""One output of one stop is wrong: a bump, a slip of the table, motion inside the stop."""

from __future__ import annotations

import numpy as np

from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Coefficient, Columns, Effect, GridParameter
from surveyapp_models.effects.rate import AXIS, DEG_S, STOP


def basis(columns: Columns, /, **grid: float) -> Floats:
    """1 in the faulty row, else 0, shape (n, 1)."""
    number = 3.0 * (columns["stop"] - 1.0) + columns["axis"] + 1.0
    return np.asarray(number == grid["row"], dtype=np.float64)[:, None]


def rows(columns: Columns) -> Floats:
    """Number of every row: three times the stop, and the axis."""
    return np.asarray(3.0 * (columns["stop"] - 1.0) + columns["axis"] + 1.0)


EFFECT = Effect(
    id="gross_error",
    title="Gross error of a stop",
    subject="rate",
    needs=(AXIS, STOP),
    coefficients=(Coefficient("error", "deg/s", DEG_S, -500.0, 500.0, "output too large by"),),
    grid=(GridParameter("row", "number", rows, "three times (stop - 1) + axis + 1"),),
    basis=basis,
    acts_on="observation",
    datum="biases without this output",
    source="Baarda 1968, data snooping",
    remedy="Look at this stop in the record: was the unit at rest? Else repeat it.",
    symptom="single stops stood off while the others agree",
    separate_by="the same stop once more",
    confusable_with=("g_sensitivity", "temperature", "bias_ramp", "flip_error"),
    event=True,
)
