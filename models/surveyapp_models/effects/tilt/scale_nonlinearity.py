"""The reading bends at the ends of its range."""

from __future__ import annotations

import numpy as np

from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Coefficient, Columns, Effect
from surveyapp_models.effects.tilt import AXIS, OWN, by_axis


def basis(columns: Columns, /, **grid: float) -> Floats:
    """Cube of the tilt relative to the largest of its axis, shape (n, 2)."""
    del grid
    own = by_axis(columns, columns["reference"])
    span = np.abs(own).max(axis=0)
    return np.asarray((own / np.where(span > 0.0, span, 1.0)) ** 3)


EFFECT = Effect(
    id="scale_nonlinearity",
    title="Non-linear scale",
    subject="tilt",
    needs=(AXIS, OWN),
    coefficients=tuple(
        Coefficient(f"cubic_{a}", "arcsec", 1.0, -1e5, 1e5, f"bend at the end of the range of {a}")
        for a in ("along", "across")
    ),
    basis=basis,
    datum="scale in the middle of the range",
    source="IEEE Std 1293, third-order non-linearity",
    remedy="Keep to the middle of the range, or calibrate over a smaller one.",
    symptom="large tilts were shown too large or too small",
    separate_by="more tilts at the ends of the range",
    confusable_with=("cross_axis",),
)
