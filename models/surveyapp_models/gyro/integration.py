"""The two-axis equation of motion of a suspended gyro, integrated for an ensemble of runs.

    J beta'' + H alpha' + (P + M) beta = H w sin(latitude)
    J_z alpha'' - H beta' + k alpha' + M sin(alpha) + D (alpha - tape) = torque

It has a fast mode (nutation, some 30 Hz) and a slow one (precession, minutes). The linear part,
with both modes, is propagated exactly; the rest (sine, damping, friction, follow-up, torques) is a
slow forcing integrated by the exponential Runge-Kutta scheme of fourth order of Cox & Matthews
(2002), J. Comput. Phys. 176:430, eqs 26-29. The step follows the slow mode alone and nothing is
made stiffer or softer to please the integrator. ``integrate_precession`` solves the slow equation
with J_eff by the classical Runge-Kutta method: the tests hold the two, the closed form, and a
brute-force integration with millisecond steps against each other.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from surveyapp_models.arrays import Floats
from surveyapp_models.gyro.moments import directive_moment, effective_inertia
from surveyapp_models.gyro.motion import Motion
from surveyapp_models.gyro.suspended import SuspendedGyro

InTime = Callable[[float], ArrayLike]
"""A quantity of each run at a time [s]: shape () or (runs,)."""


@dataclass(frozen=True, slots=True)
class TapeTop:
    """What the top of the tape does.

    Parameters
    ----------
    mode : {"tracking", "clamped"}
        The top follows the gyro, or is held.
    clamp : float or array of shape (runs,)
        Azimuth of the clamp from true north [rad]; clamped only.
    zero : callable
        Azimuth of the untwisted tape relative to the clamp or to the gyro, mu d(t) [rad].
    lag : float or array
        Tracking: the top trails the gyro by this angle in both directions of motion [rad].
    eastward_lag : float or array
        Tracking: trails only while the azimuth grows [rad].
    delay_s : float or array
        Tracking: trails in proportion to the rate of the gyro [s]: a servo of first order.
    """

    mode: Literal["tracking", "clamped"] = "tracking"
    clamp: ArrayLike = 0.0
    zero: InTime | None = None
    lag: ArrayLike = 0.0
    eastward_lag: ArrayLike = 0.0
    delay_s: ArrayLike = 0.0


@dataclass(frozen=True, slots=True)
class Disturbance:
    """Torques beside those of the simple model; every entry is () or (runs,) per run.

    Parameters
    ----------
    torque : callable
        External torque about the vertical, clockwise positive [N m].
    damping : callable
        Viscous coefficient in place of the gyro's own [N m s/rad].
    quadratic_drag : array
        c in c |alpha'| alpha' [N m s2/rad2].
    dry_friction : array or callable
        Torque against the motion, whatever its speed [N m].
    asymmetry : array
        e in the restoring torque e alpha^2 [N m/rad2]: stiffer on one side.
    """

    torque: InTime | None = None
    damping: InTime | None = None
    quadratic_drag: ArrayLike = 0.0
    dry_friction: ArrayLike | InTime = 0.0
    asymmetry: ArrayLike = 0.0


@dataclass(frozen=True, slots=True)
class Start:
    """Where the ensemble starts; nutation is at rest.

    Parameters
    ----------
    azimuth, velocity : ndarray, shape (runs,)
        [rad], [rad/s].
    time_s : float
        [s].
    """

    azimuth: Floats
    velocity: Floats
    time_s: float = 0.0


Forcing = Callable[[float, Floats, Floats, Floats], Floats]


def _forcing(
    gyro: SuspendedGyro, latitude: float, tape: TapeTop, disturbance: Disturbance
) -> Forcing:
    """Everything that the linear undamped part leaves out, as a torque (t, alpha, alpha', sign)."""
    moment = directive_moment(gyro, latitude)
    tracking = tape.mode == "tracking"
    drag = np.asarray(disturbance.quadratic_drag, dtype=np.float64)
    asymmetry = np.asarray(disturbance.asymmetry, dtype=np.float64)
    lag = np.asarray(tape.lag, dtype=np.float64)
    eastward = np.asarray(tape.eastward_lag, dtype=np.float64)
    viscous = gyro.torsion * np.asarray(tape.delay_s, dtype=np.float64) if tracking else 0.0
    trailing = gyro.torsion * (lag + 0.5 * eastward) if tracking else 0.0
    friction = disturbance.dry_friction
    one_way = 0.5 * gyro.torsion * eastward if tracking else 0.0
    held = 0.0 if tracking else gyro.torsion * np.asarray(tape.clamp, dtype=np.float64)

    def force(t: float, azimuth: Floats, rate: Floats, sign: Floats) -> Floats:
        given = gyro.damping if disturbance.damping is None else disturbance.damping(t)
        damping = np.asarray(given, dtype=np.float64)
        total = moment * (azimuth - np.sin(azimuth)) + held - one_way
        dry = np.asarray(friction(t) if callable(friction) else friction, dtype=np.float64)
        total = total - (damping + viscous + drag * np.abs(rate)) * rate - (dry + trailing) * sign
        total = total - asymmetry * azimuth**2
        if tape.zero is not None:
            total = total + gyro.torsion * np.asarray(tape.zero(t))
        if disturbance.torque is not None:
            total = total + np.asarray(disturbance.torque(t))
        return np.asarray(total, dtype=np.float64)

    return force


@dataclass(frozen=True, slots=True)
class _Propagator:
    """Exact linear step and the weights of the forcing, for one step width."""

    whole: Floats
    half: Floats
    half_weight: Floats
    first: Floats
    middle: Floats
    last: Floats


def _phi(z: NDArray[np.complex128]) -> tuple[NDArray[np.complex128], ...]:
    """phi_1, phi_2, phi_3 of the exponential integrators, by their series where z is small."""
    small = np.abs(z) < 1.0
    series = []
    for order in (1, 2, 3):
        total = np.zeros_like(z)
        for n in range(18, -1, -1):
            total = total + np.where(small, z, 0.0) ** n / math.factorial(n + order)
        series.append(total)
    big = np.where(small, 1.0, z)
    one = (np.exp(big) - 1.0) / big
    two = (one - 1.0) / big
    three = (two - 0.5) / big
    closed = (one, two, three)
    return tuple(np.where(small, s, c) for s, c in zip(series, closed, strict=True))


def _propagator(system: Floats, width: float, column: int, gain: float) -> _Propagator:
    """Build the step for u' = system u + gain F e_column."""
    rates, vectors = np.linalg.eig(system.astype(np.complex128))
    load = np.linalg.solve(vectors, np.eye(system.shape[0])[:, column] * gain)

    def matrix(values: NDArray[np.complex128]) -> Floats:
        return np.asarray(np.linalg.solve(vectors.T, (vectors * values).T).T.real)

    def weight(values: NDArray[np.complex128]) -> Floats:
        return np.asarray((vectors @ (values * load)).real)[:, None]

    exponents: NDArray[np.complex128] = np.asarray(rates * width, dtype=np.complex128)
    one, two, three = _phi(exponents)
    half_one = _phi(np.asarray(0.5 * exponents, dtype=np.complex128))[0]
    return _Propagator(
        whole=matrix(np.exp(rates * width)),
        half=matrix(np.exp(0.5 * rates * width)),
        half_weight=weight(0.5 * width * half_one),
        first=weight(width * (one - 3.0 * two + 4.0 * three)),
        middle=weight(width * (2.0 * two - 4.0 * three)),
        last=weight(width * (4.0 * three - two)),
    )


def _stiffness(gyro: SuspendedGyro, latitude: float, tape: TapeTop) -> float:
    """M, and D with it where the clamp is fixed [N m/rad]."""
    torsion = gyro.torsion if tape.mode == "clamped" else 0.0
    return directive_moment(gyro, latitude) + torsion


def _system(gyro: SuspendedGyro, latitude: float, stiffness: float) -> Floats:
    """The linear part for azimuth, its rate, elevation above the rest tilt, its rate."""
    spin, inertia, elevation = gyro.angular_momentum, gyro.vertical_inertia, gyro.elevation_inertia
    pendulum = gyro.pendulosity + directive_moment(gyro, latitude)
    return np.array(
        [
            [0.0, 1.0, 0.0, 0.0],
            [-stiffness / inertia, 0.0, 0.0, spin / inertia],
            [0.0, 0.0, 0.0, 1.0],
            [0.0, -spin / elevation, -pendulum / elevation, 0.0],
        ]
    )


def _at_start(start: Start) -> tuple[Floats, Floats]:
    """Azimuth and velocity of every run, both (runs,)."""
    azimuth, velocity = np.broadcast_arrays(
        np.atleast_1d(np.asarray(start.azimuth, dtype=np.float64)),
        np.asarray(start.velocity, dtype=np.float64),
    )
    return azimuth, velocity


def integrate(
    gyro: SuspendedGyro,
    latitude: float,
    start: Start,
    *,
    duration_s: float,
    step_s: float,
    tape: TapeTop | None = None,
    disturbance: Disturbance | None = None,
) -> Motion:
    """Integrate the two-axis equation for every run.

    Parameters
    ----------
    gyro : SuspendedGyro
    latitude : float
        [rad], not a pole.
    start : Start
        Nutation starts at rest: the elevation lies on the slow motion.
    duration_s, step_s : float
        [s]; about 1/100 of the period per step gives 0.001 arc-second over 20 turning points.
    tape : TapeTop, optional
        Ideal tracking if absent.
    disturbance : Disturbance, optional
        None if absent; the gyro's own viscous damping always acts.

    Returns
    -------
    Motion
        On a grid of ceil(duration/step) + 1 times.
    """
    tape = TapeTop() if tape is None else tape
    force = _forcing(gyro, latitude, tape, disturbance or Disturbance())
    stiffness = _stiffness(gyro, latitude, tape)
    step = _propagator(_system(gyro, latitude, stiffness), step_s, 1, 1.0 / gyro.vertical_inertia)
    slow = effective_inertia(gyro, latitude)
    to_rate = -(gyro.pendulosity + directive_moment(gyro, latitude)) / gyro.angular_momentum

    azimuth, velocity = _at_start(start)
    first = force(start.time_s, azimuth, velocity, np.sign(velocity))
    acceleration = (first - stiffness * azimuth) / slow
    state = np.array([azimuth, velocity, velocity / to_rate, acceleration / to_rate])

    count = math.ceil(duration_s / step_s - 1e-9) + 1
    times = start.time_s + step_s * np.arange(count, dtype=np.float64)
    record = np.empty((3, count, state.shape[1]))

    def load(t: float, u: Floats) -> Floats:
        return force(t, u[0], u[1], np.sign(to_rate * u[2]))

    for index in range(count):
        t = float(times[index])
        f1 = load(t, state)
        record[0, index] = state[0]
        record[1, index] = to_rate * state[2]
        record[2, index] = (f1 - stiffness * state[0]) / slow
        if index == count - 1:
            break
        half = step.half @ state
        a = half + step.half_weight * f1
        f2 = load(t + 0.5 * step_s, a)
        b = half + step.half_weight * f2
        f3 = load(t + 0.5 * step_s, b)
        c = step.half @ a + step.half_weight * (2.0 * f3 - f1)
        f4 = load(t + step_s, c)
        state = step.whole @ state + step.first * f1 + step.middle * (f2 + f3) + step.last * f4
    return Motion(times, record[0], record[1], record[2])


def integrate_precession(
    gyro: SuspendedGyro,
    latitude: float,
    start: Start,
    *,
    duration_s: float,
    step_s: float,
    tape: TapeTop | None = None,
    disturbance: Disturbance | None = None,
) -> Motion:
    """Integrate the slow equation J_eff alpha'' + ... = torque by the classical Runge-Kutta method.

    Parameters and result as of ``integrate``; the elevation is eliminated, so there is no
    nutation. It stands as an independent route to the same motion.

    ``latitude`` [rad].
    """
    tape = TapeTop() if tape is None else tape
    force = _forcing(gyro, latitude, tape, disturbance or Disturbance())
    stiffness = _stiffness(gyro, latitude, tape)
    inertia = effective_inertia(gyro, latitude)
    azimuth, velocity = _at_start(start)

    def slope(t: float, x: Floats, v: Floats) -> Floats:
        return np.asarray((force(t, x, v, np.sign(v)) - stiffness * x) / inertia)

    count = math.ceil(duration_s / step_s - 1e-9) + 1
    times = start.time_s + step_s * np.arange(count, dtype=np.float64)
    record = np.empty((3, count, azimuth.shape[0]))
    for index in range(count):
        t = float(times[index])
        a1 = slope(t, azimuth, velocity)
        record[:, index] = azimuth, velocity, a1
        v2 = velocity + 0.5 * step_s * a1
        a2 = slope(t + 0.5 * step_s, azimuth + 0.5 * step_s * velocity, v2)
        v3 = velocity + 0.5 * step_s * a2
        a3 = slope(t + 0.5 * step_s, azimuth + 0.5 * step_s * v2, v3)
        v4 = velocity + step_s * a3
        a4 = slope(t + step_s, azimuth + step_s * v3, v4)
        azimuth = azimuth + step_s / 6.0 * (velocity + 2.0 * v2 + 2.0 * v3 + v4)
        velocity = velocity + step_s / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4)
    return Motion(times, record[0], record[1], record[2])
