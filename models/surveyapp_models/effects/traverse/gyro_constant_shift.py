"""The instrument constant in the mine is not the one that was calibrated, or jumps on the way."""

from __future__ import annotations

import numpy as np

from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Coefficient, Column, Columns, Effect, GridParameter


def basis(columns: Columns, /, **grid: float) -> Floats:
    """1 for this gyro side and every later one with the same constant, else 0."""
    side, group = columns["gyro_side"], columns["gyro_group"]
    own = group[side == grid["first_side"]]
    same = (group == own[0]) & (side >= grid["first_side"]) if own.size else side < 0.0
    return np.asarray(same, dtype=np.float64)[:, None]


def first_sides(columns: Columns) -> Floats:
    """First side of every constant (all of them shift), and every later one but the last.

    A shift of the last side alone is a gross error of that side.
    """
    side, group = columns["gyro_side"], columns["gyro_group"]
    found = []
    for number in np.unique(group[group > 0.0]):
        own = np.sort(side[group == number])
        found += [float(own[0]), *[float(value) for value in own[1:-1]]]
    return np.array(found, dtype=np.float64)


EFFECT = Effect(
    id="gyro_constant_shift",
    title="Shift of the gyro's constant",
    subject="traverse",
    needs=(
        Column("gyro_side", "number of the gyro side, by constant and order, 0 elsewhere"),
        Column("gyro_group", "number of its constant, 0 elsewhere"),
    ),
    coefficients=(
        Coefficient(
            "shift",
            "arcsec",
            ARCSEC,
            -600.0,
            600.0,
            "gyro azimuth observed minus what its constant asks for",
        ),
    ),
    grid=(GridParameter("first_side", "gyro side", first_sides, "first side that is shifted"),),
    basis=basis,
    datum="the coordinates with the shifted gyro sides freed of the shift",
    source="change of the constant by transport, clamping or temperature between calibrations",
    remedy=(
        "Determine the constant again on the surface line before trusting the gyro sides; clamp "
        "for every transport."
    ),
    symptom="the gyro sides were all turned by the same amount against the constant",
    separate_by="a calibration after the work underground, or a gyro side measured twice",
    per="instrument",
    confusable_with=("angle_bias", "lateral_refraction", "gross_error"),
    event=True,
)
