"""A point that is held fixed does not lie where its coordinates say."""

from __future__ import annotations

import numpy as np

from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Coefficient, Column, Columns, Effect, GridParameter

ROLES = ("station", "target", "backsight")
"""What a point may be to an observation."""


def basis(columns: Columns, /, **grid: float) -> Floats:
    """What a shift of the point does to everything that touches it, east and north."""
    point = grid["point"]
    found = []
    for axis in ("east", "north"):
        parts = [
            np.where(columns[role] == point, columns[f"by_{role}_{axis}"], 0.0) for role in ROLES
        ]
        found.append(np.sum(parts, axis=0))
    return np.column_stack(found)


def fixed_points(columns: Columns) -> Floats:
    """Every fixed point that an observation touches."""
    names = [columns[role][columns[f"{role}_fixed"] > 0.0] for role in ROLES]
    return np.unique(np.concatenate(names))


EFFECT = Effect(
    id="fixed_point",
    title="Coordinates of a fixed point",
    subject="traverse",
    needs=tuple(
        column
        for role in ROLES
        for column in (
            Column(role, "number of the point, 0 = none"),
            Column(f"{role}_fixed", "1 where that point is held fixed, else 0"),
            Column(f"by_{role}_east", "change of the observation per metre east, rad/m or 1"),
            Column(f"by_{role}_north", "change of the observation per metre north, rad/m or 1"),
        )
    ),
    coefficients=(
        Coefficient("east", "mm", 1e-3, -1000.0, 1000.0, "the mark east of its coordinates"),
        Coefficient("north", "mm", 1e-3, -1000.0, 1000.0, "the mark north of its coordinates"),
    ),
    grid=(GridParameter("point", "number", fixed_points, "the point that moved"),),
    basis=basis,
    datum="the coordinates with that point free",
    source="Baarda 1968, A testing procedure for use in geodetic networks (tests of given points)",
    remedy="Check the mark and its coordinates; connect to another known point.",
    symptom="a point that is held fixed did not lie where its coordinates say",
    separate_by="a further fixed point, or a gyro side beside the suspected one",
    confusable_with=("distance_scale", "gyro_constant_shift", "station_centring", "gross_error"),
)
