"""Something magnetic was brought near and taken away again, or switched on and off."""

from __future__ import annotations

import numpy as np

from surveyapp_models.arrays import Floats
from surveyapp_models.effects.compass import AXIS, TIME, own_axis
from surveyapp_models.effects.effect import Coefficient, Columns, Effect, GridParameter

COARSE = 24
"""Places at which the window may begin and end on the grid; the loop refines them to the row."""


def basis(columns: Columns, /, **grid: float) -> Floats:
    """1 in the rows of each axis from ``on_s`` up to ``off_s``, shape (n, 3)."""
    time = columns["time_s"]
    on = (time >= grid["on_s"]) & (time < grid["off_s"])
    return np.asarray(own_axis(columns) * on[:, None])


def begins(columns: Columns) -> Floats:
    """Times of rows in the first two thirds of the record."""
    times = np.unique(columns["time_s"])
    places = np.floor(_shares(1.0 / COARSE, 2.0 / 3.0) * (times.size - 1)).astype(np.intp)
    return np.asarray(times[np.unique(np.maximum(places, 1))])


def ends(columns: Columns) -> Floats:
    """Times of later rows, in the last third of the record."""
    times = np.unique(columns["time_s"])
    shares = _shares(2.0 / 3.0 + 1.0 / COARSE, 1.0)
    return np.asarray(times[np.unique(np.ceil(shares * (times.size - 1)).astype(np.intp))])


def _shares(low: float, high: float) -> Floats:
    """Even shares of the record, a place of the grid apart."""
    return np.linspace(low, high, round(COARSE * (high - low)) + 1)


EFFECT = Effect(
    id="interference_step",
    title="Interference that was switched on and off",
    subject="compass",
    needs=(AXIS, TIME),
    coefficients=tuple(
        Coefficient(f"step_{a}", "uT", 1.0, -1000.0, 1000.0, f"field along {a} while on")
        for a in "xyz"
    ),
    grid=(
        GridParameter("on_s", "s", begins, "when it came"),
        GridParameter("off_s", "s", ends, "when it went"),
    ),
    basis=basis,
    datum="field while it was off",
    source="BROAD, Laidig et al. 2021: records with an attached magnet",
    remedy="Find what was switched on and off at these times; leave that part out.",
    symptom="the field jumped and jumped back",
    separate_by="the same turns with everything switched off",
    confusable_with=("hard_iron", "field_gradient", "temperature"),
    event=True,
)
