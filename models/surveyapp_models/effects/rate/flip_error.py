"""In one position the unit sits crookedly on the table."""

from __future__ import annotations

import numpy as np

from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Coefficient, Columns, Effect, GridParameter
from surveyapp_models.effects.rate import AXIS, INPUTS, PLACE


def basis(columns: Columns, /, **grid: float) -> Floats:
    """Small rotation times known rate in the rows of one position, shape (n, 3) [rad/s]."""
    here = columns["place"] == grid["place"]
    rate = np.column_stack([columns[f"input_{a}"] for a in "xyz"])
    axis = columns["axis"].astype(np.intp)
    found = np.zeros((rate.shape[0], 3))
    for k in range(3):
        turned = np.cross(np.eye(3)[k], rate)
        found[:, k] = turned[np.arange(axis.size), axis] * here
    return found


def places(columns: Columns) -> Floats:
    """Every position of the record."""
    return np.unique(columns["place"])


EFFECT = Effect(
    id="flip_error",
    title="Crooked seat in one position",
    subject="rate",
    needs=(AXIS, PLACE, *INPUTS),
    coefficients=tuple(
        Coefficient(a, "arcsec", ARCSEC, -36000.0, 36000.0, f"turn about {a}") for a in "xyz"
    ),
    basis=basis,
    grid=(GridParameter("place", "number", places, "the position"),),
    datum="matrix and biases without this position's seat",
    source="error analysis of two-axis six-position calibration, sensors.md 2b",
    remedy="Seat the unit again in this position and repeat it.",
    symptom="one position stood off in the gyros across its axis",
    separate_by="the same position seated and turned once more",
    confusable_with=("gross_error",),
    event=True,
)
