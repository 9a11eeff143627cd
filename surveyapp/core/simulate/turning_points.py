"""Turning points and passages of an ensemble of runs, from the integrated equation of motion.

Everything is in one array operation per integration step, so that hundreds of runs cost little
more than one. What is returned beside the readings is the truth: it goes into truth files and
tests, never into an estimator.
"""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surveyapp.core.simulate.disturbing import (
    Disturbed,
    RunDesign,
    damped_gyro,
    disturb,
    tape_top,
    total_size,
    tripod_twist,
)
from surveyapp.core.simulate.specification import SessionSpec
from surveyapp_models.arrays import Floats
from surveyapp_models.gyro.integration import Start, integrate
from surveyapp_models.gyro.moments import directive_moment
from surveyapp_models.gyro.motion import Events, Motion, passages, turning_points
from surveyapp_models.gyro.periods import clamped_period_s, tracking_period_s, unspun_period_s

STEPS_PER_HALF_SWING = 48
"""Integration steps; 0.001 arc-second at 2 degrees of amplitude."""
LEAD = 0.25
"""The motion starts this many half swings before the first turning point."""
CHUNK = 500
"""Runs that are integrated together: more would only cost memory."""


@dataclass(frozen=True, slots=True)
class SimulatedPoints:
    """Readings of an ensemble with their truth; n turning points, p passages of each line.

    Parameters
    ----------
    readings : ndarray, shape (runs, n)
        Circle [rad] (tracking), not wrapped, or scale [div] (clamped), as read.
    motion : ndarray, shape (runs, n)
        The same without noise, rounding and gross errors.
    time_s : ndarray, shape (runs, n)
        True moments, 0 near the first turning point [s].
    midpoint : ndarray, shape (runs, n)
        Circle reading of the quasi-static equilibrium [rad], tape torsion included.
    swing_centre : ndarray, shape (runs, n)
        The same with what an asymmetric restoring torque or follow-up adds between turning points.
    gyro_north : ndarray, shape (runs, n)
        Circle reading of gyro north freed from the tape [rad]: what the instrument seeks.
    run_north : ndarray, shape (runs, n)
        The same as the turning points show it, with what an asymmetry adds to their middle [rad];
        its mean is north averaged over the run.
    temperature_c : ndarray, shape (runs, n)
        As read.
    passage_time_s : ndarray, shape (runs, lines, p)
        Timed passages as read [s]; (runs, 0, 0) where nothing is timed.
    passage_eastward : ndarray of bool, shape (runs, lines, p)
        The scale reading grows.
    drawn : dict
        Places, phases and the like that were drawn, (runs,) each.
    """

    readings: Floats
    motion: Floats
    time_s: Floats
    midpoint: Floats
    swing_centre: Floats
    gyro_north: Floats
    run_north: Floats
    temperature_c: Floats
    passage_time_s: Floats
    passage_eastward: NDArray[np.bool_]
    drawn: dict[str, Floats]


@dataclass(frozen=True, slots=True)
class Timetable:
    """When things happen, in seconds from the first turning point.

    Parameters
    ----------
    half_swing_s : float
        Of the method in force.
    unspun_half_swing_s : float
    last_s : float
        Nominal last turning point.
    zero_before_s, zero_after_s : float
        Middle of the tape zeros.
    """

    half_swing_s: float
    unspun_half_swing_s: float
    last_s: float
    zero_before_s: float
    zero_after_s: float


def timetable(spec: SessionSpec) -> Timetable:
    """Lay out a session: tape zero, run-up, swing, run-down, tape zero."""
    gyro = damped_gyro(spec)
    period = clamped_period_s if spec.clamped else tracking_period_s
    half = 0.5 * period(gyro, spec.latitude)
    unspun = 0.5 * unspun_period_s(gyro)
    last = (spec.turns - 1) * half
    reach = 0.5 * max(spec.tape_zero_points - 1, 0) * unspun
    return Timetable(half, unspun, last, -600.0 - reach, last + 600.0 + reach)


def tape_zero_div(spec: SessionSpec, time_s: Floats, table: Timetable | None = None) -> Floats:
    """Return the true tape zero [div] at times from the first turning point [s].

    Whoever asks at every step of an integration hands over the ``table`` of the session.
    """
    table = timetable(spec) if table is None else table
    share = (time_s - table.zero_before_s) / (table.zero_after_s - table.zero_before_s)
    before, after = spec.tape_zero_div
    return np.asarray(before + (after - before) * share)


def simulate_turning_points(
    spec: SessionSpec, runs: int, rng: np.random.Generator
) -> SimulatedPoints:
    """Simulate an ensemble of runs of one session.

    Parameters
    ----------
    spec : SessionSpec
    runs : int
        Each draws its own noise, paths, places and phases.
    rng : numpy.random.Generator

    Returns
    -------
    SimulatedPoints
    """
    parts = []
    for first in range(0, runs, CHUNK):
        design = RunDesign(min(CHUNK, runs - first), timetable(spec).half_swing_s, spec.turns)
        parts.append(_simulate(spec, design, rng))
    return parts[0] if len(parts) == 1 else _joined(parts)


def _joined(parts: list[SimulatedPoints]) -> SimulatedPoints:
    """One ensemble of several."""

    def stack(name: str) -> NDArray[Any]:
        return np.concatenate([getattr(part, name) for part in parts])

    names = [field.name for field in dataclasses.fields(SimulatedPoints) if field.name != "drawn"]
    drawn = {key: np.concatenate([part.drawn[key] for part in parts]) for key in parts[0].drawn}
    return SimulatedPoints(**{name: stack(name) for name in names}, drawn=drawn)


def _simulate(spec: SessionSpec, design: RunDesign, rng: np.random.Generator) -> SimulatedPoints:
    disturbed = disturb(spec, design, rng)
    turns, lines = _integrate(spec, disturbed, design)
    ratio = disturbed.gyro.torsion / directive_moment(disturbed.gyro, spec.latitude)
    shift = disturbed.north_shift(turns.time_s)
    twist = tripod_twist(spec, turns.time_s, design.length_s)
    equilibrium = _equilibrium(spec, ratio, shift, turns.time_s) - twist
    origin = spec.circle_of_north + spec.constant
    swing = np.abs(turns.azimuth - equilibrium)
    centre = disturbed.asymmetry * swing**2 - 0.5 * ratio * disturbed.eastward_lag
    if spec.clamped:
        motion = (turns.azimuth - spec.clamp_offset) / spec.scale_value
    else:
        motion = origin + turns.azimuth
    temperature = disturbed.temperature_c(turns.time_s)
    noise, shape = spec.noise, motion.shape
    read = motion + _gross(spec, shape, rng) + _reading_sigma(spec) * rng.normal(size=shape)
    warmth = temperature + noise.temperature_c * rng.normal(size=shape)
    passed = lines.time_s + noise.time_s * rng.normal(size=lines.time_s.shape)
    return SimulatedPoints(
        readings=_rounded(
            read, noise.scale_resolution_div if spec.clamped else noise.reading_resolution
        ),
        motion=motion,
        time_s=turns.time_s,
        midpoint=origin + equilibrium,
        swing_centre=origin + equilibrium + centre,
        gyro_north=origin + shift - twist,
        run_north=origin + shift - twist + centre * (1.0 + ratio if spec.clamped else 1.0),
        temperature_c=_rounded(warmth, noise.temperature_resolution_c),
        passage_time_s=_rounded(passed, noise.time_resolution_s),
        passage_eastward=lines.rising if spec.scale_value > 0.0 else ~lines.rising,
        drawn=disturbed.drawn,
    )


def _reading_sigma(spec: SessionSpec) -> float:
    return spec.noise.scale_div if spec.clamped else spec.noise.reading


def _equilibrium(spec: SessionSpec, ratio: float, shift: Floats, time_s: Floats) -> Floats:
    """Azimuth at which the gyro would rest, from its own undisturbed north [rad]."""
    zero = spec.scale_value * tape_zero_div(spec, time_s)
    if spec.clamped:
        zero = zero + tripod_twist(spec, time_s, timetable(spec).last_s)
        return np.asarray((ratio * (spec.clamp_offset + zero) + shift) / (1.0 + ratio))
    return np.asarray(shift + ratio * zero)


def _integrate(spec: SessionSpec, disturbed: Disturbed, design: RunDesign) -> tuple[Events, Events]:
    """Turning points (runs, n) and passages (runs, lines, p) of the ensemble."""
    gyro, half = disturbed.gyro, design.half_swing_s
    table = timetable(spec)
    lead = np.asarray(-LEAD * half)
    ratio = gyro.torsion / directive_moment(gyro, spec.latitude)
    centre = _equilibrium(spec, ratio, disturbed.north_shift(lead)[:, 0], lead)
    phase = LEAD * math.pi
    amplitude = spec.first_amplitude if spec.first_east else -spec.first_amplitude
    start = Start(
        azimuth=centre + amplitude * math.cos(phase),
        velocity=np.full(design.runs, amplitude * math.sin(phase) * math.pi / half),
        time_s=float(lead),
    )
    motion = integrate(
        gyro,
        spec.latitude,
        start,
        duration_s=(design.points + LEAD) * half,
        step_s=half / STEPS_PER_HALF_SWING,
        tape=tape_top(spec, disturbed, lambda t: tape_zero_div(spec, t, table), design.length_s),
        disturbance=disturbed.disturbance,
    )
    motion = _from_the_tripod(spec, motion, design)
    return turning_points(motion, design.points), _passages(spec, motion, design)


def _from_the_tripod(spec: SessionSpec, motion: Motion, design: RunDesign) -> Motion:
    """The motion as circle and scale show it, which turn with the tripod."""
    turn = tripod_twist(spec, motion.time_s, design.length_s)
    rate = total_size(spec, "tripod_twist") / design.length_s
    return dataclasses.replace(
        motion, azimuth=motion.azimuth - turn[:, None], velocity=motion.velocity - rate
    )


def _passages(spec: SessionSpec, motion: Motion, design: RunDesign) -> Events:
    """Passages of the timed lines after the first turning point."""
    if not spec.timed:
        empty = np.empty((design.runs, 0, 0))
        return Events(empty, empty, np.empty((design.runs, 0, 0), dtype=np.bool_))
    seen = motion.time_s >= 0.05 * design.half_swing_s
    after = Motion(
        motion.time_s[seen], motion.azimuth[seen], motion.velocity[seen], motion.acceleration[seen]
    )
    found = [
        passages(after, spec.clamp_offset + line * spec.scale_value, spec.points)
        for line in spec.lines_div
    ]
    return Events(
        np.stack([events.time_s for events in found], axis=1),
        np.stack([events.azimuth for events in found], axis=1),
        np.stack([events.rising for events in found], axis=1),
    )


def _gross(spec: SessionSpec, shape: tuple[int, ...], rng: np.random.Generator) -> Floats:
    """Gross errors of readings: the size as given for the first of each run, then either sign."""
    result = np.zeros(shape)
    for effect in spec.effects:
        if effect.id != "gross_error":
            continue
        count = int(effect.option("count") or 1)
        size = effect.size / (abs(spec.scale_value) if spec.clamped else 1.0)
        places = rng.permuted(np.tile(np.arange(shape[1]), (shape[0], 1)), axis=1)[:, :count]
        signs = rng.choice([-1.0, 1.0], size=places.shape)
        signs[:, 0] = 1.0
        np.put_along_axis(result, places, size * signs, axis=1)
    return result


def _rounded(values: Floats, resolution: float) -> Floats:
    return values if resolution <= 0.0 else np.round(values / resolution) * resolution
