"""Records of a vehicle that stops, drives off, turns and brakes, and of a unit turned by hand."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from surveyapp.core.simulate.rate.log import SimulatedLog
from surveyapp.core.simulate.rate.table_programmes import DEG_H, accelerometer_truth, gyro_truth
from surveyapp_models.arrays import Floats
from surveyapp_models.rate import quaternions
from surveyapp_models.rate.attitude import STANDARD_GRAVITY, attitude_quaternion, sensed
from surveyapp_models.rate.triad import Triad


@dataclass(frozen=True, slots=True)
class Leg:
    """A piece of a drive: how long, forward acceleration [m/s2], clockwise turn rate [rad/s]."""

    state: str
    seconds: float
    acceleration: float = 0.0
    turn: float = 0.0


def usual_drive(rounds: int = 2) -> tuple[Leg, ...]:
    """Rest, drive off, go on, turn, go on, brake, rest; several times."""
    once = (
        Leg("stationary", 10.0),
        Leg("accelerating", 4.0, acceleration=0.5),
        Leg("steady", 8.0),
        Leg("turning", 6.0, turn=math.radians(15.0)),
        Leg("steady", 8.0),
        Leg("braking", 4.0, acceleration=-0.5),
    )
    return once * rounds + (Leg("stationary", 10.0),)


@dataclass(frozen=True, slots=True)
class VehicleRun:
    """A drive.

    Parameters
    ----------
    legs : sequence of Leg
    latitude, heading : float
        [rad]
    gyro, accelerometer : Triad
    shake : float
        Vibration while moving, standard deviation [m/s2].
    interval_s : float
    power_cycle_after : int or None
        Number of the rest (from 0) after which the unit was switched off and on.
    """

    legs: Sequence[Leg]
    latitude: float = math.radians(35.0)
    heading: float = 0.0
    gyro: Triad = field(default_factory=Triad)
    accelerometer: Triad = field(default_factory=Triad)
    shake: float = 0.15
    interval_s: float = 0.01
    power_cycle_after: int | None = None


def vehicle_log(run: VehicleRun, rng: np.random.Generator) -> SimulatedLog:
    """Sensors and odometer of a level drive."""
    dt = run.interval_s
    counts = [round(leg.seconds / dt) for leg in run.legs]
    acceleration = np.concatenate([np.full(n, leg.acceleration) for n, leg in _with(counts, run)])
    turn = np.concatenate([np.full(n, leg.turn) for n, leg in _with(counts, run)])
    states = [leg.state for n, leg in _with(counts, run) for _ in range(n)]
    moving = np.array([s != "stationary" for s in states])
    speed = np.maximum(np.cumsum(acceleration) * dt, 0.0)
    speed[~moving] = 0.0
    heading = run.heading + np.concatenate([[0.0], np.cumsum(turn)]) * dt
    q = _yawed(heading)
    earth, forces = sensed(q[:-1], latitude=run.latitude)
    rates = quaternions.body_rates(q, interval_s=dt) + earth
    forces = forces.copy()
    forces[:, 1] += acceleration
    forces[:, 0] += speed * turn  # clockwise: the centre lies to the right, along body x
    forces = forces + moving[:, None] * rng.normal(0.0, run.shake, forces.shape)
    shaken = rates + moving[:, None] * rng.normal(0.0, 0.02 * run.shake, rates.shape)
    gyro = run.gyro.output(shaken, forces=forces, rng=rng)
    acc = run.accelerometer.output(forces, rng=rng)
    columns: dict[str, Floats] = {"time_s": np.asarray(np.arange(turn.size) * dt)}
    columns |= {f"gyr_{a}_rad_s": gyro[:, i] for i, a in enumerate("xyz")}
    columns |= {f"acc_{a}_m_s2": acc[:, i] for i, a in enumerate("xyz")}
    columns["odometer_m"] = np.cumsum(speed) * dt
    columns["power_cycle"] = _cycles(run, moving)
    middle = 0.5 * (heading[1:] + heading[:-1])
    place = np.cumsum(
        (speed * dt)[:, None] * np.column_stack([np.sin(middle), np.cos(middle)]), axis=0
    )
    return SimulatedLog(columns, {}, _truth(run, heading, place))


def _with(counts: Sequence[int], run: VehicleRun) -> list[tuple[int, Leg]]:
    return list(zip(counts, run.legs, strict=True))


def _yawed(heading: Floats) -> Floats:
    vectors = np.zeros((heading.size, 3))
    vectors[:, 2] = -heading
    return quaternions.from_rotation_vector(vectors)


def _cycles(run: VehicleRun, moving: np.ndarray) -> Floats:
    """Number of the power cycle of each row."""
    if run.power_cycle_after is None:
        return np.zeros(moving.size)
    starts = np.flatnonzero(np.diff(np.concatenate([[1], (~moving).astype(np.int8)])) == 1)
    ends = np.flatnonzero(np.diff(np.concatenate([(~moving).astype(np.int8), [0]])) == -1)
    rests = list(zip(starts.tolist(), ends.tolist(), strict=False)) or [(0, 0)]
    first, last = rests[min(run.power_cycle_after, len(rests) - 1)]
    return np.asarray((np.arange(moving.size) >= (first + last) // 2).astype(np.float64))


def _truth(run: VehicleRun, heading: Floats, place: Floats) -> dict[str, Any]:
    begin, segments = 0.0, []
    for leg in run.legs:
        segments.append({"start_s": begin, "end_s": begin + leg.seconds, "state": leg.state})
        begin += leg.seconds
    return {
        "latitude_deg": math.degrees(run.latitude),
        "segments": segments,
        "heading_start_deg": math.degrees(run.heading),
        "heading_end_deg": math.degrees(float(heading[-1])) % 360.0,
        "end_m": place[-1].tolist(),
        **{f"bias_{a}": float(run.gyro.bias[i]) / DEG_H for i, a in enumerate("xyz")},
    }


@dataclass(frozen=True, slots=True)
class HandRun:
    """A unit that is laid down and turned by hand.

    Parameters
    ----------
    gyro, accelerometer : Triad
    stops : int
    latitude : float
        [rad]
    stop_s, turn_s, interval_s : float
    ramp, temperature, warmth : float
        Drift of every bias [rad/s per s], per kelvin [rad/s], and how much it warms up [K].
    walk : float
        Between stops, standard deviation of each bias [rad/s].
    random_walk : float
        Per stop, of each bias [rad/s].
    gross : float
        By how much one gyro is off at one stop [rad/s].
    one_axis : bool
        Whether every turn is about body z: attitudes that do not tell everything.
    """

    gyro: Triad
    accelerometer: Triad
    stops: int = 18
    latitude: float = math.radians(35.0)
    stop_s: float = 4.0
    turn_s: float = 2.0
    interval_s: float = 0.01
    ramp: float = 0.0
    temperature: float = 0.0
    warmth: float = 5.0
    walk: float = 0.0
    random_walk: float = 0.0
    gross: float = 0.0
    one_axis: bool = False


def hand_held_log(run: HandRun, rng: np.random.Generator) -> SimulatedLog:
    """Stops in random attitudes with smooth turns of about 90 degrees between them."""
    dt = run.interval_s
    q = attitude_quaternion(heading=rng.uniform(0, 6.28), pitch=0.1, roll=0.1)
    pieces: list[Floats] = []
    rest, move = round(run.stop_s / dt), round(run.turn_s / dt)
    shape = 1.0 - np.cos(2.0 * np.pi * (np.arange(move) + 0.5) / move)
    for k in range(run.stops):
        pieces.append(np.zeros((rest, 3)))
        if k + 1 < run.stops:
            axis = np.array([0.0, 0.0, 1.0]) if run.one_axis else rng.normal(0.0, 1.0, 3)
            axis = axis / np.linalg.norm(axis)
            pieces.append(shape[:, None] * axis * (rng.uniform(1.2, 2.0) / (move * dt)))
    own = np.concatenate(pieces)
    attitude = quaternions.integrate(own, interval_s=dt, start=q)
    earth, forces = sensed(attitude[:-1], latitude=run.latitude)
    time = np.arange(own.shape[0]) * dt
    warmth = run.warmth * (1.0 - np.exp(-time / (0.4 * float(time[-1]))))
    stop = np.minimum((time / (run.stop_s + run.turn_s)).astype(np.intp), run.stops - 1)
    each = rng.normal(0.0, 1.0, (run.stops, 3)) * run.walk
    each = each + np.cumsum(rng.normal(0.0, 1.0, (run.stops, 3)), axis=0) * run.random_walk
    if run.gross:
        each[int(rng.integers(1, run.stops - 1)), int(rng.integers(3))] += run.gross
    gyro = run.gyro.output(own + earth, forces=forces, rng=rng) + each[stop]
    gyro = gyro + (run.ramp * time + run.temperature * warmth)[:, None]
    acc = run.accelerometer.output(forces, rng=rng)
    columns: dict[str, Floats] = {"time_s": np.asarray(time)}
    columns |= {f"gyr_{a}_rad_s": gyro[:, i] for i, a in enumerate("xyz")}
    columns |= {f"acc_{a}_m_s2": acc[:, i] for i, a in enumerate("xyz")}
    columns["temperature_c"] = 20.0 + warmth + rng.normal(0.0, 0.02, time.size)
    truth = {"latitude_deg": math.degrees(run.latitude), "stops": run.stops}
    truth["gravity_m_s2"] = STANDARD_GRAVITY
    return SimulatedLog(
        columns, {}, truth | gyro_truth(run.gyro) | accelerometer_truth(run.accelerometer)
    )
