"""One observation of the traverse was misread, miswritten or belongs to another point."""

from __future__ import annotations

import numpy as np

from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Coefficient, Column, Columns, Effect, GridParameter


def basis(columns: Columns, /, **grid: float) -> Floats:
    """Its own standard deviation at the faulty observation, else 0."""
    here = columns["observation"] == grid["observation"]
    return np.where(here, columns["own_sigma"], 0.0)[:, None]


def observations(columns: Columns) -> Floats:
    """Every observation; a constant known beforehand has the sigma 0 here and is none."""
    return np.asarray(columns["observation"][columns["own_sigma"] > 0.0], dtype=np.float64)


EFFECT = Effect(
    id="gross_error",
    title="Gross error of an observation",
    subject="traverse",
    needs=(
        Column("observation", "number in the order of the book, from 1"),
        Column("own_sigma", "stated standard deviation, rad or m"),
    ),
    coefficients=(
        Coefficient("error", "sigma", 1.0, -1e6, 1e6, "observed minus true, in its own sigmas"),
    ),
    grid=(GridParameter("observation", "number", observations, "the faulty observation"),),
    basis=basis,
    acts_on="observation",
    datum="the coordinates without the faulty observation",
    source="Baarda 1968, data snooping",
    remedy="Look at the book: whole degrees, minutes or metres off are a slip; else observe again.",
    symptom="single observations stood off while the others agree",
    separate_by="the book itself, or the observation repeated",
    confusable_with=(
        "distance_scale",
        "distance_constant",
        "distance_cyclic",
        "angle_bias",
        "lateral_refraction",
        "gyro_constant_shift",
    ),
    event=True,
)
