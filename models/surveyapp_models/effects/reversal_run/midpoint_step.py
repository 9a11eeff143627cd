"""North jumps once: a touch, a re-clamped tape, a change of observer or of tracking."""

from __future__ import annotations

import numpy as np

from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats
from surveyapp_models.effects.datum import both_plateaus
from surveyapp_models.effects.effect import (
    DECAY,
    HALF_SWING,
    SIDE,
    Coefficient,
    Columns,
    Effect,
    GridParameter,
)

MID_SWING = 0.5
"""A step at meridian passage leaves the amplitude as it was."""


def basis(columns: Columns, /, **grid: float) -> Floats:
    """H(t - t0) (1 - s_k s_0 cos(pi f) exp(-k (t - t0))), f the phase of the step.

    A step between two turning points changes the amplitude too, by the share of the swing that is
    left at that moment; at meridian passage (f = 1/2) by nothing.
    """
    time, side = columns["half_swing"], columns["side"]
    last = grid["after_point"]
    after = (time > last + 1e-9).astype(np.float64)
    parity = np.where(np.round(last - time[0]) % 2 == 0, 1.0, -1.0)
    kick = side * side[0] * parity * np.cos(np.pi * grid["phase"])
    damped = np.exp(-columns["decay"] * np.maximum(time - last - grid["phase"], 0.0))
    return np.asarray(after * (1.0 - kick * damped))[:, None]


def midpoint(columns: Columns, /, **grid: float) -> Floats:
    """H(t - t0): what north itself does."""
    return (columns["half_swing"] > grid["after_point"] + 1e-9).astype(np.float64)[:, None]


def positions(columns: Columns) -> Floats:
    """Last turning point before the step; at least three points on either side."""
    return np.unique(columns["half_swing"])[2:-3]


def phases(columns: Columns) -> Floats:
    """Quarters of a half swing."""
    del columns
    return np.array([0.0, 0.25, MID_SWING, 0.75])


EFFECT = Effect(
    id="midpoint_step",
    title="Step of north",
    subject="reversal_run",
    needs=(HALF_SWING, SIDE, DECAY),
    coefficients=(
        Coefficient("step", "arcsec", ARCSEC, -600.0, 600.0, "north after minus north before"),
    ),
    grid=(
        GridParameter("after_point", "half swing", positions, "last turning point before the step"),
        GridParameter(
            "phase",
            "half swing",
            phases,
            "how long after it; 0.5 = meridian passage",
            neutral=MID_SWING,
        ),
    ),
    basis=basis,
    datum="both plateaus stand beside the mean over the run",
    source="equation of motion: a step at phase f changes the amplitude by -s d cos(pi f)",
    remedy="Ask what was touched; repeat the run, or keep the longer undisturbed part of it.",
    symptom="north jumped once",
    separate_by="a second run; sights and tape zero before and after tell which plateau is right",
    confusable_with=("midpoint_drift", "warm_up", "secondary_oscillation", "gross_error"),
    at_datum=both_plateaus,
    midpoint=midpoint,
    event=True,
)
