"""One line stands off: its known azimuth, centring on a short sight, deflection of the vertical."""

from __future__ import annotations

import numpy as np

from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Coefficient, Column, Columns, Effect, GridParameter


def basis(columns: Columns, /, **grid: float) -> Floats:
    """1 on the line, else 0."""
    return np.asarray(columns["line"] == grid["line"], dtype=np.float64)[:, None]


def lines(columns: Columns) -> Floats:
    """Every line; of two lines the second."""
    different = np.unique(columns["line"])
    if different.size < 2:
        return np.zeros(0)
    return different[1:] if different.size == 2 else different


EFFECT = Effect(
    id="line_offset",
    title="One line stands off",
    subject="campaign",
    needs=(Column("line", "number of the line"),),
    coefficients=(
        Coefficient(
            "offset", "arcsec", ARCSEC, -300.0, 300.0, "constant on this line minus others"
        ),
    ),
    grid=(GridParameter("line", "number of the line", lines, "the line that stands off"),),
    basis=basis,
    datum="the constant averaged over the lines as observed",
    source="1 mm of centring on 50 m is 4.1 arcsec; deflection enters as eta tan(phi)",
    remedy=(
        "Check the known azimuth and the centring of this line; use a longer line; where the "
        "difference is the line's own, take for each mine its own control line."
    ),
    symptom="one line gave another constant than the others",
    separate_by="a second visit of both lines in the opposite order",
    per="line",
    confusable_with=("transport_step", "time_drift", "latitude", "circle_eccentricity"),
)
