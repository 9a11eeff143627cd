"""Drag that grows with the square of the amplitude (air, oil)."""

from __future__ import annotations

import numpy as np

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
    """Solution of a' = -k a - b a^2: A exp(-k t) / (1 + b A (1 - exp(-k t)) / k)."""
    del grid
    loss = coefficient * np.abs(first_amplitude) * mean_loss_time(half_swing, decay)
    return np.asarray(first_amplitude * np.exp(-decay * half_swing) / np.maximum(1.0 + loss, 1e-3))


def basis(columns: Columns, /, **grid: float) -> Floats:
    """-s_k A_k A (1 - exp(-k t)) / k."""
    del grid
    first = columns["first_amplitude"]
    time = mean_loss_time(columns["half_swing"], columns["decay"])
    return np.asarray(
        -columns["side"] * first * columns["relative_amplitude"] * np.abs(first) * time
    )[:, None]


EFFECT = Effect(
    id="quadratic_drag",
    title="Drag growing with the square of the amplitude",
    subject="reversal_run",
    needs=(HALF_SWING, SIDE, RELATIVE_AMPLITUDE, FIRST_AMPLITUDE, DECAY),
    coefficients=(
        Coefficient(
            "drag", "1/(rad half swing)", 1.0, 0.0, 10.0, "loss of amplitude = drag x amplitude^2"
        ),
    ),
    basis=basis,
    law=law,
    acts_on="amplitude",
    one_sided=True,
    datum="north stays the mean over the run",
    source="closed solution of a' = -k a - b a^2; equation of motion with a v|v| moment",
    remedy="Begin with a smaller swing (the trade advises at most 3 degrees of range).",
    symptom="large swings lost relatively more than small ones",
    separate_by="a run begun with half the amplitude, or more turning points",
    confusable_with=("dry_friction", "damping_break"),
)
