"""Columns of a drive that are not what they are taken for: how often told, and how often wrongly.

Drives of one to four ways from stop to stop on roads that rise, fall and lean, with sensors of
three grades, shaking or smooth, with turns and without any. Each is judged as it is and with its
columns wrong in seven ways, with an odometer and without. A line gives, of all drives: told when
nothing is wrong (stated: .001), then of each fault told rightly, and told as another.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from bench.rate import as_read
from surveyapp.core.sensors.rate.motion_axes import axes_doubts
from surveyapp.core.sensors.rate.motion_pieces import states_of
from surveyapp.core.simulate.rate.log import SimulatedLog
from surveyapp.domain.sensor_log import SensorLog
from surveyapp_models.arrays import Floats
from surveyapp_models.rate import quaternions
from surveyapp_models.rate.attitude import sensed
from surveyapp_models.rate.triad import Triad

RUNS = int(os.environ.get("SURVEYAPP_BENCH_RUNS", "20"))
CLEAN = 5 * RUNS
HZ = 50.0
LATITUDE = math.radians(45.0)


@dataclass(frozen=True, slots=True)
class Road:
    """What kind of drives.

    Parameters
    ----------
    turns : bool
    hills : float
        Standard deviation of pitch and roll at the places between which they change [rad].
    gyro, force : float
        Noise of a sample [rad/s], [m/s2].
    shake : float
        [m/s2]
    """

    turns: bool = True
    hills: float = 0.0
    gyro: float = 0.001
    force: float = 0.02
    shake: float = 0.15


ROADS: Mapping[str, Road] = {
    "level": Road(),
    "hills of 3 degrees": Road(hills=math.radians(3.0)),
    "level, no turn": Road(turns=False),
    "hills, no turn": Road(turns=False, hills=math.radians(3.0)),
    "noisy gyro, smooth": Road(gyro=0.03, force=0.01, shake=0.03),
    "noisy gyro, smooth, no turn": Road(turns=False, gyro=0.03, force=0.01, shake=0.03),
    "hard shaking": Road(shake=1.0, hills=math.radians(2.0)),
}

FAULTS = (
    "axes_exchanged",
    "axes_turned",
    "turning_reversed",
    "rates_in_degrees",
    "rates_too_small",
    "looks_back",
)


def _wave(points: Floats, knots: Floats, values: Floats) -> Floats:
    """Values at knots joined by halves of cosines: they stand still at the knots."""
    low = np.clip(np.searchsorted(knots, points, side="right") - 1, 0, knots.size - 2)
    share = np.clip((points - knots[low]) / (knots[low + 1] - knots[low]), 0.0, 1.0)
    return np.asarray(
        values[low] + (values[low + 1] - values[low]) * 0.5 * (1.0 - np.cos(np.pi * share))
    )


def drive(road: Road, rng: np.random.Generator) -> SensorLog:
    """Ways of 15 to 40 s at .5 to 3 m/s between stops of 6 s."""
    pushes, turns = [np.zeros(round(8 * HZ))], [np.zeros(round(8 * HZ))]
    for _ in range(int(rng.integers(1, 5))):
        start, cruise = round(rng.uniform(2.0, 5.0) * HZ), round(rng.uniform(10.0, 30.0) * HZ)
        push = rng.uniform(0.5, 3.0) / (start / HZ)
        turn = np.zeros(2 * start + cruise)
        if road.turns:
            length = round(rng.uniform(3.0, 8.0) * HZ)
            first = start + int(rng.integers(0, cruise - length))
            angle = float(rng.choice([-1.0, 1.0]) * rng.uniform(0.4, 2.0))
            shape = 1.0 - np.cos(2.0 * np.pi * (np.arange(length) + 0.5) / length)
            turn[first : first + length] = angle * shape / (length / HZ)
        pushes += [np.repeat([push, 0.0, -push], [start, cruise, start]), np.zeros(round(6 * HZ))]
        turns += [turn, np.zeros(round(6 * HZ))]
    return _sensed(road, np.concatenate(pushes), np.concatenate(turns), rng)


def _sensed(road: Road, push: Floats, turn: Floats, rng: np.random.Generator) -> SensorLog:
    speed = np.maximum(np.cumsum(push) / HZ, 0.0)
    speed[speed < 1e-6] = 0.0
    moving = (speed > 0.0) | (push != 0.0)
    gone = np.append(0.0, np.cumsum(speed) / HZ)
    knots = np.arange(0.0, gone[-1] + 24.0, 12.0)
    pitch, roll = (
        _wave(gone, knots, road.hills * rng.standard_normal(knots.size)) for _ in range(2)
    )
    heading = float(rng.uniform(0.0, 6.28)) + np.append(0.0, np.cumsum(turn) / HZ)
    zero = np.zeros_like(gone)
    parts = ((zero, zero, -heading), (pitch, zero, zero), (zero, roll, zero))
    about_z, about_x, about_y = (
        quaternions.from_rotation_vector(np.column_stack(part)) for part in parts
    )
    q = quaternions.multiply(quaternions.multiply(about_z, about_x), about_y)
    earth, force = sensed(q[:-1], latitude=LATITUDE)
    force = force + np.column_stack([speed * turn, push, np.zeros_like(push)])
    shaken = moving[:, None] * rng.standard_normal(force.shape)
    rate = quaternions.body_rates(q, interval_s=1.0 / HZ) + earth
    rate = rate + 0.02 * road.shake * moving[:, None] * rng.standard_normal(rate.shape)
    unit = Triad(bias=0.005 * rng.standard_normal(3), noise=road.gyro)
    rates = unit.output(rate, forces=force, rng=rng)
    level = Triad(bias=0.05 * rng.standard_normal(3), noise=road.force)
    forces = level.output(force + road.shake * shaken, rng=rng)
    columns: dict[str, Floats] = {"time_s": np.arange(push.size) / HZ}
    columns |= {f"acc_{a}_m_s2": forces[:, i] for i, a in enumerate("xyz")}
    columns |= {f"gyr_{a}_rad_s": rates[:, i] for i, a in enumerate("xyz")}
    columns["odometer_m"] = np.round(gone[1:], 2)
    return as_read(SimulatedLog(columns))


def spoilt(log: SensorLog, fault: str) -> SensorLog:
    """A log whose columns are wrong in one way."""
    c = dict(log.columns)
    ax, ay = "acc_x_m_s2", "acc_y_m_s2"
    gx, gy, gz = (f"gyr_{a}_rad_s" for a in "xyz")
    if fault == "axes_exchanged":
        c[ax], c[ay] = c[ay], c[ax]
    elif fault == "axes_turned":
        c[ax], c[ay], c[gx], c[gy] = c[ay], -c[ax], c[gy], -c[gx]
    elif fault == "looks_back":
        c |= {name: -c[name] for name in (ax, ay, gx, gy)}
    elif fault == "turning_reversed":
        c[gz] = -c[gz]
    elif fault == "rates_in_degrees":
        c |= {name: np.rad2deg(c[name]) for name in (gx, gy, gz)}
    elif fault == "rates_too_small":
        c |= {name: np.deg2rad(c[name]) for name in (gx, gy, gz)}
    return replace(log, columns=c)


def told(log: SensorLog, *, odometer: bool) -> str:
    """The code of what is told, or nothing."""
    if not odometer:
        log = replace(log, columns={k: v for k, v in log.columns.items() if k != "odometer_m"})
    found = axes_doubts(log, states_of(log, false_alarm=0.01).rests)
    return found[0].code if found else ""


def run() -> Iterator[str]:
    """A line for each road, with an odometer and without."""
    for number, (name, road) in enumerate(ROADS.items()):
        for odometer in (True, False):
            logs = [drive(road, np.random.default_rng([number, k])) for k in range(CLEAN)]
            alarms = sum(told(log, odometer=odometer) != "" for log in logs)
            parts = [f"clean {alarms} of {CLEAN}"]
            for fault in FAULTS:
                codes = [told(spoilt(log, fault), odometer=odometer) for log in logs[:RUNS]]
                named = "forward_is_x" if fault.startswith("axes") else fault
                right = np.mean([code == named for code in codes])
                other = np.mean([code not in ("", named) for code in codes])
                parts.append(f"{fault} {right:.2f}/{other:.2f}")
            way = "odometer" if odometer else "no odometer"
            yield f"{name}, {way}: " + ", ".join(parts)
