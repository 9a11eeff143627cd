"""In one position the unit sits crookedly on the table."""

from __future__ import annotations

import numpy as np

from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Coefficient, Columns, Effect, GridParameter
from surveyapp_models.effects.rate import AXIS, INPUTS, PLACE

SEAT_SD = "seat_sd"
"""Coefficient where every position sits crookedly: standard deviation about either axis."""


def basis(columns: Columns, /, **grid: float) -> Floats:
    """Small rotations across the table's axis times known rate in the rows of one position.

    Shape (n, 2) [rad/s]. A turn about the table's axis itself is no error of the seat.
    """
    here = columns["place"] == grid["place"]
    rate = np.column_stack([columns[f"input_{a}"] for a in "xyz"])
    axis = columns["axis"].astype(np.intp)
    own = int(np.argmax(np.abs(rate[here]).sum(axis=0)))
    found = np.zeros((rate.shape[0], 2))
    for k in range(2):
        turned = np.cross(np.eye(3)[(own + 1 + k) % 3], rate)
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
        Coefficient(name, "arcsec", ARCSEC, -36000.0, 36000.0, f"turn about {meaning}")
        for name, meaning in (
            ("next", "the axis after that of the position: y for x, z for y, x for z"),
            ("after_next", "the one after: z for x, x for y, y for z"),
        )
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
