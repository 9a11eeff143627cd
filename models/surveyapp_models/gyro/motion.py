"""The swing of a suspended gyro in closed form, and what is read from a recorded motion.

The closed form is that of small swings with viscous damping, with the tape following (tracking)
or clamped. Everything that is not viscous, not small or not constant in time is the business of
``integration``, which is held against this module.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from surveyapp_models.arrays import Floats
from surveyapp_models.gyro.moments import directive_moment, effective_inertia
from surveyapp_models.gyro.suspended import SuspendedGyro


@dataclass(frozen=True, slots=True)
class DampedSwing:
    """x(t) = centre + amplitude exp(-decay t) cos(rate t + phase).

    Parameters
    ----------
    centre : float
        Centre of the swing, in the unit of x.
    amplitude : float
        Amplitude at t = 0 of the envelope, in the unit of x.
    decay : float
        k [1/s].
    rate : float
        Damped angular frequency [rad/s].
    phase : float
        [rad].
    """

    centre: float
    amplitude: float
    decay: float
    rate: float
    phase: float

    @property
    def period_s(self) -> float:
        """Full damped period [s]."""
        return 2.0 * math.pi / self.rate

    @property
    def ratio_per_half_swing(self) -> float:
        """Amplitude ratio q = exp(-k T/2) of successive turning points [-]."""
        return math.exp(-self.decay * math.pi / self.rate)


def swing_position(swing: DampedSwing, time_s: ArrayLike) -> Floats:
    """Return x at the given times [s], any shape."""
    time = np.asarray(time_s, dtype=np.float64)
    envelope = swing.amplitude * np.exp(-swing.decay * time)
    return np.asarray(swing.centre + envelope * np.cos(swing.rate * time + swing.phase))


def swing_velocity(swing: DampedSwing, time_s: ArrayLike) -> Floats:
    """Return dx/dt at the given times [s], any shape."""
    time = np.asarray(time_s, dtype=np.float64)
    envelope = swing.amplitude * np.exp(-swing.decay * time)
    angle = swing.rate * time + swing.phase
    return np.asarray(-envelope * (swing.decay * np.cos(angle) + swing.rate * np.sin(angle)))


def turning_times_s(swing: DampedSwing, count: int, *, after_s: float = 0.0) -> Floats:
    """Return the first ``count`` times after ``after_s`` at which dx/dt = 0 [s]."""
    lead = math.atan2(swing.decay, swing.rate)
    first = math.ceil((swing.rate * after_s + swing.phase + lead) / math.pi)
    order = np.arange(first, first + count, dtype=np.float64)
    return np.asarray((order * math.pi - swing.phase - lead) / swing.rate, dtype=np.float64)


def passage_times_s(swing: DampedSwing, line: float, count: int, *, after_s: float = 0.0) -> Floats:
    """Return the first ``count`` times after ``after_s`` at which x passes ``line``.

    Parameters
    ----------
    swing : DampedSwing
    line : float
        In the unit of x.
    count : int
    after_s : float
        [s].

    Returns
    -------
    ndarray, shape (count,)
        Times [s], to 1e-12 of the period, found between turning points by bisection.

    Raises
    ------
    ValueError
        If the swing does not reach the line that often.
    """
    found: list[float] = []
    turns = turning_times_s(swing, 2 * count + 2, after_s=after_s)
    for low, high in zip(np.concatenate(([after_s], turns[:-1])), turns, strict=True):
        start = float(swing_position(swing, low)) - line
        if start * (float(swing_position(swing, high)) - line) > 0.0 or start == 0.0:
            continue
        left, right = float(low), float(high)
        for _ in range(60):
            middle = 0.5 * (left + right)
            if (float(swing_position(swing, middle)) - line) * start > 0.0:
                left = middle
            else:
                right = middle
        found.append(0.5 * (left + right))
        if len(found) == count:
            return np.array(found)
    raise ValueError(f"the swing passes {line:g} only {len(found)} times, {count} are asked for")


def _small_swing(
    gyro: SuspendedGyro, latitude: float, stiffness: float, swing: tuple[float, float, float]
) -> DampedSwing:
    inertia = effective_inertia(gyro, latitude)
    centre, amplitude, phase = swing
    decay = 0.5 * gyro.damping / inertia
    square = stiffness / inertia - decay**2
    if square <= 0.0:
        raise ValueError("the damping is beyond the critical one: there is no swing")
    return DampedSwing(centre, amplitude, decay, math.sqrt(square), phase)


def tracking_swing(
    gyro: SuspendedGyro,
    latitude: float,
    *,
    amplitude: float,
    phase: float = 0.0,
    tape_offset: float = 0.0,
) -> DampedSwing:
    """Return the motion with the tape top following the gyro.

    Parameters
    ----------
    gyro : SuspendedGyro
    latitude : float
        [rad].
    amplitude, phase : float
        [rad].
    tape_offset : float
        Constant azimuth of the tape top relative to the spin axis (mu d for a tape zero d) [rad].

    Returns
    -------
    DampedSwing
        Azimuth against true north [rad]; its centre is lambda ``tape_offset``.
    """
    moment = directive_moment(gyro, latitude)
    centre = gyro.torsion * tape_offset / moment
    return _small_swing(gyro, latitude, moment, (centre, amplitude, phase))


def clamped_swing(
    gyro: SuspendedGyro,
    latitude: float,
    *,
    tape_azimuth: float,
    amplitude: float,
    phase: float = 0.0,
) -> DampedSwing:
    """Return the motion with the tape top held.

    Parameters
    ----------
    gyro : SuspendedGyro
    latitude : float
        [rad].
    tape_azimuth : float
        Azimuth in which the tape is free of torsion: clamp plus mu d [rad].
    amplitude, phase : float
        [rad].

    Returns
    -------
    DampedSwing
        Azimuth against true north [rad]; its centre is lambda/(1 + lambda) ``tape_azimuth``.
    """
    stiffness = directive_moment(gyro, latitude) + gyro.torsion
    centre = gyro.torsion * tape_azimuth / stiffness
    return _small_swing(gyro, latitude, stiffness, (centre, amplitude, phase))


def unspun_swing(
    gyro: SuspendedGyro, *, rest: float, amplitude: float, phase: float = 0.0, decay: float = 0.0
) -> DampedSwing:
    """Return the motion of the gyro with its rotor at rest about the untwisted tape.

    Parameters
    ----------
    gyro : SuspendedGyro
    rest, amplitude : float
        In any one unit, usually divisions of the scale.
    phase : float
        [rad].
    decay : float
        k [1/s]; the damping of the unspun swing is its own.
    """
    square = gyro.torsion / gyro.vertical_inertia - decay**2
    if square <= 0.0:
        raise ValueError("there is no unspun swing: no torsion, or damped beyond the critical")
    return DampedSwing(rest, amplitude, decay, math.sqrt(square), phase)


@dataclass(frozen=True, slots=True)
class Motion:
    """A recorded motion of an ensemble of gyros on one grid of times.

    Parameters
    ----------
    time_s : ndarray, shape (steps,)
        Equally spaced times [s].
    azimuth, velocity, acceleration : ndarray, shape (steps, runs)
        Azimuth of the spin axis from true north [rad], and its slow rate [rad/s] and acceleration
        [rad/s2]: nutation is not in the latter two, so that they change sign once per swing.
    """

    time_s: Floats
    azimuth: Floats
    velocity: Floats
    acceleration: Floats


@dataclass(frozen=True, slots=True)
class Events:
    """Turning points or passages of an ensemble.

    Parameters
    ----------
    time_s : ndarray, shape (runs, count)
        [s].
    azimuth : ndarray, shape (runs, count)
        [rad].
    rising : ndarray of bool, shape (runs, count)
        Passages: the azimuth grows. Turning points: it is the eastern one.
    """

    time_s: Floats
    azimuth: Floats
    rising: NDArray[np.bool_]


def turning_points(motion: Motion, count: int) -> Events:
    """Find the first ``count`` turning points of each run.

    The slow velocity changes sign in a step; its zero and the azimuth there come from the cubic
    through both ends of the step (error below 0.001 arc-second at 48 steps per half swing).

    Raises
    ------
    ValueError
        If a run has fewer.
    """
    step, run = _sign_changes(motion.velocity, count, "turning points")
    time_s, share = _hermite_root(motion.time_s, motion.velocity, motion.acceleration, (step, run))
    azimuth = _hermite(motion, (step, run), share)
    eastern = motion.velocity[step, run] > 0.0
    return Events(time_s, azimuth, np.asarray(eastern, dtype=np.bool_))


def passages(motion: Motion, line: ArrayLike, count: int) -> Events:
    """Find the first ``count`` passages of each run through an azimuth.

    Parameters
    ----------
    motion : Motion
    line : array_like, shape () or (runs,)
        [rad].
    count : int

    Raises
    ------
    ValueError
        If a run passes it less often.
    """
    height = motion.azimuth - np.asarray(line, dtype=np.float64)
    step, run = _sign_changes(height, count, "passages")
    time_s, share = _hermite_root(motion.time_s, height, motion.velocity, (step, run))
    azimuth = _hermite(motion, (step, run), share)
    rising = motion.velocity[step, run] + motion.velocity[step + 1, run] > 0.0
    return Events(time_s, azimuth, np.asarray(rising, dtype=np.bool_))


def _sign_changes(
    values: Floats, count: int, what: str
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Steps in which each run's value changes sign, (runs, count), with the runs beside them."""
    positive = values > 0.0
    changed = positive[1:] != positive[:-1]
    available = changed.sum(axis=0)
    if int(available.min()) < count:
        raise ValueError(
            f"the record holds {int(available.min())} {what} of a run, {count} are asked for"
        )
    order = np.argsort(~changed, axis=0, kind="stable")[:count].T
    runs = np.broadcast_to(np.arange(values.shape[1])[:, None], order.shape)
    return order, runs


def _hermite_root(
    time_s: Floats,
    values: Floats,
    slopes: Floats,
    where: tuple[NDArray[np.intp], NDArray[np.intp]],
) -> tuple[Floats, Floats]:
    """Root of the cubic through values and slopes of one step: (time, share of the step)."""
    step, run = where
    width = float(time_s[1] - time_s[0])
    ends = (values[step, run], values[step + 1, run])
    rates = (width * slopes[step, run], width * slopes[step + 1, run])
    share = np.clip(ends[0] / np.where(ends[0] == ends[1], 1.0, ends[0] - ends[1]), 0.0, 1.0)
    for _ in range(6):
        value = _cubic(ends, rates, share)
        rise = _cubic_slope(ends, rates, share)
        flat = np.abs(rise) < 1e-300
        share = np.clip(share - np.where(flat, 0.0, value / np.where(flat, 1.0, rise)), 0.0, 1.0)
    return time_s[step] + share * width, share


def _hermite(
    motion: Motion, where: tuple[NDArray[np.intp], NDArray[np.intp]], share: Floats
) -> Floats:
    step, run = where
    width = float(motion.time_s[1] - motion.time_s[0])
    return _cubic(
        (motion.azimuth[step, run], motion.azimuth[step + 1, run]),
        (width * motion.velocity[step, run], width * motion.velocity[step + 1, run]),
        share,
    )


Pair = tuple[Floats, Floats]


def _cubic(ends: Pair, rates: Pair, share: Floats) -> Floats:
    rest = 1.0 - share
    return np.asarray(
        ends[0] * (1.0 + 2.0 * share) * rest**2
        + rates[0] * share * rest**2
        + ends[1] * (3.0 - 2.0 * share) * share**2
        - rates[1] * rest * share**2
    )


def _cubic_slope(ends: Pair, rates: Pair, share: Floats) -> Floats:
    rest = 1.0 - share
    return np.asarray(
        6.0 * (ends[1] - ends[0]) * share * rest
        + rates[0] * rest * (1.0 - 3.0 * share)
        + rates[1] * share * (3.0 * share - 2.0)
    )
