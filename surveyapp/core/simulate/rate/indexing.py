"""Logs of a unit turned about one axis at rest, from attitudes and the rotation of the earth."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from surveyapp.core.simulate.rate.log import SimulatedLog, joined
from surveyapp.core.simulate.rate.table_programmes import DEG_H
from surveyapp_models.arrays import Floats
from surveyapp_models.rate import quaternions
from surveyapp_models.rate.attitude import attitude_matrix, axis_rotation, sensed
from surveyapp_models.rate.triad import Triad


@dataclass(frozen=True, slots=True)
class IndexingRun:
    """One stop of the vehicle, with several index positions.

    Parameters
    ----------
    latitude, heading, pitch, roll : float
        [rad]
    gyro, accelerometer : Triad
    index : sequence of float
        Angles, clockwise [rad].
    axis : int
    stop_s, interval_s, turn_s : float
        At each position, between samples, from one position to the next.
    index_error : float
        Error of the second and every further position [rad].
    """

    latitude: float
    heading: float
    pitch: float = 0.0
    roll: float = 0.0
    gyro: Triad = field(default_factory=Triad)
    accelerometer: Triad = field(default_factory=Triad)
    index: Sequence[float] = (0.0, math.pi / 2, math.pi, 1.5 * math.pi)
    axis: int = 2
    stop_s: float = 60.0
    interval_s: float = 0.1
    turn_s: float = 2.0
    index_error: float = 0.0


def indexing_log(run: IndexingRun, rng: np.random.Generator) -> SimulatedLog:
    """Rest at each index angle, turning in between."""
    body = attitude_matrix(heading=run.heading, pitch=run.pitch, roll=run.roll)
    angles, true = _index_angles(run)
    turned = np.array([body @ axis_rotation(run.axis, -a) for a in true])
    q = np.array([quaternions.from_matrix(m) for m in turned])
    earth, forces = sensed(q, latitude=run.latitude)
    own = np.zeros_like(earth)
    own[:, run.axis] = -np.gradient(true, run.interval_s)
    resting = np.abs(np.gradient(angles)) == 0.0
    own[resting] = 0.0
    gyro = run.gyro.output(earth + own, forces=forces, rng=rng)
    acc = run.accelerometer.output(forces, rng=rng)
    columns: dict[str, Floats] = {"time_s": np.asarray(np.arange(angles.size) * run.interval_s)}
    columns |= {f"gyr_{a}_rad_s": gyro[:, i] for i, a in enumerate("xyz")}
    columns |= {f"acc_{a}_m_s2": acc[:, i] for i, a in enumerate("xyz")}
    columns["index_angle_deg"] = np.rad2deg(angles) % 360.0
    return SimulatedLog(columns, {}, _truth(run, body))


def _index_angles(run: IndexingRun) -> tuple[Floats, Floats]:
    """Angles as shown and as they are, shape (n,) [rad]."""
    rest, move = round(run.stop_s / run.interval_s), round(run.turn_s / run.interval_s)
    shown, true = [], []
    for k, angle in enumerate(run.index):
        error = run.index_error if k else 0.0
        if k:
            steps = np.arange(1, move) / move
            before = run.index[k - 1]
            path = before + (angle - before) * steps
            shown.append(path)
            true.append(path + error * steps)
        shown.append(np.full(rest, angle))
        true.append(np.full(rest, angle + error))
    return np.concatenate(shown), np.concatenate(true)


def _truth(run: IndexingRun, body: Floats) -> dict[str, Any]:
    return {
        "latitude_deg": math.degrees(run.latitude),
        "heading_deg": math.degrees(run.heading),
        "pitch_deg": math.degrees(run.pitch),
        "roll_deg": math.degrees(run.roll),
        "attitude_quaternion": quaternions.from_matrix(body).tolist(),
        **{f"bias_{a}": float(run.gyro.bias[i]) / DEG_H for i, a in enumerate("xyz")},
    }


def indexing_sets(
    runs: Sequence[IndexingRun], rng: np.random.Generator, *, every_s: float
) -> SimulatedLog:
    """Several stops of the vehicle, numbered in ``set``, that many seconds apart."""
    parts, truths = [], []
    for number, run in enumerate(runs, start=1):
        part = indexing_log(run, rng)
        columns = dict(part.columns)
        columns["time_s"] = columns["time_s"] + (number - 1) * every_s
        columns["set"] = np.full(columns["time_s"].size, float(number))
        parts.append(SimulatedLog(columns))
        truths.append(part.truth)
    return joined(parts, dict(truths[-1]) | {"sets": truths})
