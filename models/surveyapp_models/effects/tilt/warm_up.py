"""After power on the zeros settle exponentially."""

from __future__ import annotations

import numpy as np

from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Coefficient, Columns, Effect, GridParameter
from surveyapp_models.effects.tilt import AXIS, TIME, by_axis

SHARES = (0.03, 0.06, 0.12, 0.2, 0.3)
"""Time constants as shares of the record."""


def basis(columns: Columns, /, **grid: float) -> Floats:
    """exp(-t / tau) in the rows of each axis, shape (n, 2)."""
    time = columns["time_s"]
    return by_axis(columns, np.exp(-(time - time.min()) / grid["tau_s"]))


def time_constants(columns: Columns) -> Floats:
    """Shares of the record's length [s]."""
    span = float(np.ptp(columns["time_s"])) or 1.0
    return np.asarray(SHARES) * span


EFFECT = Effect(
    id="warm_up",
    title="Warm-up of the zeros",
    subject="tilt",
    needs=(AXIS, TIME),
    coefficients=tuple(
        Coefficient(f"warm_up_{a}", "arcsec", 1.0, -1e5, 1e5, f"zero at the beginning, {a}")
        for a in ("along", "across")
    ),
    grid=(GridParameter("tau_s", "s", time_constants, "time constant"),),
    basis=basis,
    datum="zeros of the warm sensor",
    source="JJF 1427-2013 asks for ten minutes of power before a test",
    remedy="Power the sensor ten minutes before the test.",
    symptom="the zero crept and came to rest",
    separate_by="the same tilts again an hour later",
    confusable_with=("temperature",),
)
