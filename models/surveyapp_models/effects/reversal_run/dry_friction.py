"""The same loss every half swing: dry friction, or a follow-up that lags both ways."""

from __future__ import annotations

import numpy as np

from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import (
    DECAY,
    FIRST_AMPLITUDE,
    HALF_SWING,
    RELATIVE_AMPLITUDE,
    SIDE,
    Coefficient,
    Columns,
    Effect,
    mean_loss_time,
)


def law(
    half_swing: Floats,
    first_amplitude: Floats,
    decay: Floats,
    coefficient: Floats,
    /,
    **grid: float | Floats,
) -> Floats:
    """Solution of a' = -k a - c: A exp(-k t) - c (1 - exp(-k t)) / k, at rest at 0."""
    del grid
    loss = coefficient * mean_loss_time(half_swing, decay)
    left = np.abs(first_amplitude) * np.exp(-decay * half_swing) - loss
    return np.asarray(np.sign(first_amplitude) * np.maximum(left, 0.0))


def basis(columns: Columns, /, **grid: float) -> Floats:
    """-s_k (1 - exp(-k t)) / k, with the sign of the swing."""
    del grid
    time = mean_loss_time(columns["half_swing"], columns["decay"])
    return np.asarray(-columns["side"] * np.sign(columns["first_amplitude"]) * time)[:, None]


EFFECT = Effect(
    id="dry_friction",
    title="Dry friction or follow-up lag",
    subject="reversal_run",
    needs=(HALF_SWING, SIDE, RELATIVE_AMPLITUDE, FIRST_AMPLITUDE, DECAY),
    coefficients=(
        Coefficient(
            "loss",
            "arcsec/half swing",
            ARCSEC,
            0.0,
            20000.0,
            "the amplitude loses this much each half swing, whatever its size; a gyro loses at "
            "most some 400, the wide range serves any pendulum",
        ),
    ),
    basis=basis,
    law=law,
    acts_on="amplitude",
    one_sided=True,
    datum="north stays the mean over the run; a lag both ways does not shift it",
    source="integrated equation of motion: a lag of eps both ways costs 2 lambda eps a half swing",
    remedy=(
        "Follow the gyro without lag (hold the mark on the scale zero); check the tape zero and "
        "the lead-in ribbons for touching."
    ),
    symptom="the turning points lost the same amount each swing, as a follow-up lag would do",
    separate_by="more turning points, down to a small amplitude, or a run followed by a motor",
    confusable_with=("quadratic_drag", "damping_break"),
)
