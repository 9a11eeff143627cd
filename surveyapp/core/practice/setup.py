"""Setting up the simulated instrument of the practice mode: what is drawn, and what is hidden."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from surveyapp.core.practice.simulated_instrument import (
    LEAD_S,
    AutomaticInstrument,
    Sights,
    SuspendedInstrument,
)
from surveyapp.core.simulate.specification import Effect, SessionSpec, SwingMethod, parse_effect
from surveyapp.core.simulate.turning_points import simulate_turning_points
from surveyapp.domain.project import Method
from surveyapp_models.angles import ARCSEC

POINTS: Final = 24
ROUND_SIGMA: Final = 6.0 * ARCSEC
"""Of one delivered azimuth [rad]."""
DISTURBANCES: Final = (
    "midpoint_step=90,at=5",
    "midpoint_step=-120,at=7",
    "damping_break=0.02,at=6",
    "midpoint_drift=6",
    "secondary_oscillation=40,period=10",
    "warm_up=120",
)
"""One of these is hidden, large enough to be found with a dozen turning points."""
CLAMPED_DISTURBANCES: Final = (
    "midpoint_step=240,at=5",
    "midpoint_step=-300,at=7",
    "damping_break=0.03,at=6",
    "midpoint_drift=20",
    "warm_up=300",
)
"""On the scale, which is read more coarsely."""
ROUND_DISTURBANCES: Final = ("midpoint_drift", "midpoint_step", "gross_error")
DRIFT, STEP, GROSS = 6.0 * ARCSEC, 45.0 * ARCSEC, 90.0 * ARCSEC
"""Of an automatic gyro: a round, from the fourth round on, and in one round [rad]."""


def simulate_instrument(
    rng: np.random.Generator, *, method: Method = "tracking", disturbed: bool | None
) -> SuspendedInstrument | AutomaticInstrument:
    """Set up an instrument with a hidden north and, if asked for, one hidden disturbance.

    Parameters
    ----------
    rng : numpy.random.Generator
    method : Method
    disturbed : bool or None
        None lets the lot decide.
    """
    hidden = bool(rng.random() < 0.5) if disturbed is None else disturbed
    if method == "automatic":
        return _automatic(rng, disturbed=hidden)
    return _suspended(rng, method, disturbed=hidden)


def _suspended(
    rng: np.random.Generator, method: SwingMethod, *, disturbed: bool
) -> SuspendedInstrument:
    choices = DISTURBANCES if method == "tracking" else CLAMPED_DISTURBANCES
    effects: tuple[Effect, ...] = ()
    if disturbed:
        effects = (parse_effect(choices[int(rng.integers(len(choices)))]),)
    spec = SessionSpec(
        method=method,
        points=POINTS,
        circle_of_north=float(rng.uniform(0.0, 2.0 * math.pi)),
        line_azimuth=float(rng.uniform(0.0, 2.0 * math.pi)),
        tape_zero_div=tuple(rng.uniform(-0.4, 0.4, size=2).tolist()),
        effects=effects,
    )
    points = simulate_turning_points(spec, 1, rng)
    moments = points.time_s[0] - points.time_s[0, 0] + LEAD_S
    middles = points.midpoint[0]
    if spec.clamped:
        middles = (middles - spec.circle_of_north - spec.constant - spec.clamp_offset) / (
            spec.scale_value
        )
    return SuspendedInstrument(
        spec=spec,
        readings=tuple(points.readings[0].tolist()),
        middles=tuple(middles.tolist()),
        offsets=tuple((points.motion[0] - middles).tolist()),
        moments_s=tuple(moments.tolist()),
        sights=_sights(rng, spec),
        norths=tuple(points.run_north[0].tolist()),
        effect=effects[0].id if effects else "",
    )


def _sights(rng: np.random.Generator, spec: SessionSpec) -> Sights:
    errors = rng.normal(scale=spec.noise.sight, size=100)
    line = spec.circle_of_north + spec.line_azimuth
    return Sights(line, spec.collimation, tuple(errors.tolist()))


def _automatic(rng: np.random.Generator, *, disturbed: bool) -> AutomaticInstrument:
    spec = SessionSpec(
        circle_of_north=float(rng.uniform(0.0, 2.0 * math.pi)),
        line_azimuth=float(rng.uniform(0.0, 2.0 * math.pi)),
    )
    effect = str(rng.choice(ROUND_DISTURBANCES)) if disturbed else ""
    rounds = np.arange(POINTS)
    truths = np.full(POINTS, spec.line_azimuth)
    errors = rng.normal(scale=ROUND_SIGMA, size=POINTS)
    if effect == "midpoint_drift":
        truths = truths + DRIFT * rounds
    elif effect == "midpoint_step":
        truths = truths + STEP * (rounds >= 3)
    elif effect == "gross_error":
        errors[int(rng.integers(1, 4))] += GROSS
    return AutomaticInstrument(
        azimuths=tuple((truths + errors).tolist()),
        truths=tuple(truths.tolist()),
        sights=_sights(rng, spec),
        latitude=spec.latitude,
        effect=effect,
    )
