"""The damping changes once during the run: two exponential regimes."""

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
    GridParameter,
)


def law(
    half_swing: Floats,
    first_amplitude: Floats,
    decay: Floats,
    coefficient: Floats,
    /,
    **grid: float | Floats,
) -> Floats:
    """A exp(-k t - dk max(0, t - t0))."""
    late = np.maximum(half_swing - grid["position"], 0.0)
    return np.asarray(first_amplitude * np.exp(-decay * half_swing - coefficient * late))


def basis(columns: Columns, /, **grid: float) -> Floats:
    """-s_k A_k max(0, t - t0)."""
    late = np.maximum(columns["half_swing"] - grid["position"], 0.0)
    amplitude = columns["first_amplitude"] * columns["relative_amplitude"]
    return np.asarray(-columns["side"] * amplitude * late)[:, None]


def positions(columns: Columns) -> Floats:
    """Turning points with at least two others on either side."""
    return np.unique(columns["half_swing"])[2:-2]


EFFECT = Effect(
    id="damping_break",
    title="Change of damping during the run",
    subject="reversal_run",
    needs=(HALF_SWING, SIDE, RELATIVE_AMPLITUDE, FIRST_AMPLITUDE, DECAY),
    coefficients=(
        Coefficient(
            "change of damping", "1/half swing", 1.0, -0.2, 0.2, "positive: more loss afterwards"
        ),
    ),
    grid=(
        GridParameter(
            "position", "half swing", positions, "turning point at which the damping changes"
        ),
    ),
    basis=basis,
    law=law,
    acts_on="amplitude",
    datum="north stays the mean over the run",
    source="Williams & Belling 1967 (the run of p. 273); integrated equation of motion",
    remedy=(
        "Follow the gyro evenly; where the tracking or the damping was changed on purpose, note it "
        "and observe at least five turning points after it."
    ),
    symptom="the swing lost a different share of its amplitude per half swing after one point",
    separate_by="more turning points after the change, or a second run without it",
    confusable_with=("quadratic_drag", "dry_friction", "midpoint_step"),
    event=True,
)
