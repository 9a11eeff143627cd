"""A compass log with attitude and without place, in a room whose field changes with the place.

``SURVEYAPP_BENCH_RUNS`` records a line (24). "lifted": a carrier that stays near level is lifted by
.4 m for the middle of the record; "walked": one turned through every attitude, in a hand that
wanders. The gradient
has no sources and no currents; its size is the rms of what it changes. Named in a room is wrong; of
iron, a turn and a switch without a room the planted one is right. Then with the place: the room is
a dipole some way from the nearest end of the path, and any name but ``field_gradient`` is wrong.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from bench.sensor_loop import found_in, log_of
from surveyapp.core.simulate.specification import Effect
from surveyapp.diagnosis.sensors.records import rotation_matrices
from surveyapp.domain.sensor_log import SensorLog
from surveyapp_models.arrays import Floats
from surveyapp_models.compass.heading import level_field

RUNS = int(os.environ.get("SURVEYAPP_BENCH_RUNS", "24"))
PLANTED = (
    Effect("hard_iron", 1.5),
    Effect("soft_iron", 0.03),
    Effect("misalignment", np.radians(1.0)),
    Effect("interference_step", 3.0),
    Effect("interference_step", 6.0),
)


def lifted(seed: int) -> tuple[SensorLog, Floats]:
    """A carrier turned slowly about the vertical under tilts of up to 30 degrees, and its places.

    Lifted after three tenths of the record and put down: for a carrier that stays near level a
    change of the room's field is nearly one of its own axes.
    """
    rng = np.random.default_rng([seed, 8])
    time = np.arange(2400) / 20.0
    span = float(time[-1])
    turns = rng.uniform(1.5, 2.5)
    yaw = 2.0 * np.pi * turns * time / span
    pitch, roll = (0.5 * np.sin(2.0 * np.pi * time / rng.uniform(15.0, 30.0)) for _ in "12")
    half = np.stack([np.cos(0.5 * yaw), np.zeros_like(yaw), np.zeros_like(yaw), np.sin(0.5 * yaw)])
    for angle, axis in ((pitch, 2), (roll, 1)):
        c, s = np.cos(0.5 * angle), np.sin(0.5 * angle)
        w, x, y, z = half
        if axis == 2:
            half = np.stack([c * w - s * y, c * x - s * z, c * y + s * w, c * z + s * x])
        else:
            half = np.stack([c * w - s * x, c * x + s * w, c * y + s * z, c * z - s * y])
    attitude = rotation_matrices(half.T)
    field = level_field(np.zeros(1), size=50.0, dip=np.radians(65.0))[0]
    readings = np.einsum("nij,i->nj", attitude, field) + rng.normal(0.0, 0.3, (time.size, 3))
    columns = {"time_s": time}
    columns |= {f"mag_{a}_uT": readings[:, i] for i, a in enumerate("xyz")}
    columns |= {f"ref_q{a}": half[i] for i, a in enumerate("wxyz")}
    up = np.clip((time - 0.3 * span) / 2.0, 0.0, 1.0) - np.clip((time - 0.7 * span) / 2.0, 0.0, 1.0)
    log = SensorLog("compass", columns, dict.fromkeys(columns, "1"), time.size, rate_hz=20.0)
    return log, np.outer(up, [0.05, 0.05, 0.4])


def in_a_room(log: SensorLog, place: Floats, size: float, rng: np.random.Generator) -> SensorLog:
    """The log in a gradient that changes the field by ``size`` [uT, rms], its place left out."""
    columns = {k: v for k, v in log.columns.items() if not k.startswith("ref_p")}
    quaternion = log.quaternion()
    if size > 0.0 and quaternion is not None:
        shape = rng.normal(size=(3, 3))
        shape = 0.5 * (shape + shape.T)
        shape -= np.trace(shape) / 3.0 * np.eye(3)
        change = (place - place.mean(axis=0)) @ shape
        change *= size / np.sqrt(np.mean(np.sum(change**2, axis=1)))
        seen = np.einsum("nij,ni->nj", rotation_matrices(quaternion), change)
        for i, axis in enumerate("xyz"):
            columns[f"mag_{axis}_uT"] = columns[f"mag_{axis}_uT"] + seen[:, i]
    return replace(log, columns=columns)


def beside_a_dipole(motion: str, seed: int, size: float, distance: float) -> SensorLog:
    """A log with its place near a dipole that changes the field along the path by ``size``."""
    rng = np.random.default_rng([seed, 77])
    if motion == "lifted":
        log, place = lifted(seed)
    else:
        log, _ = log_of("compass", np.random.default_rng([seed, 9]))
        walked = log.vector("ref_p")
        place = np.zeros((log.size, 3)) if walked is None else walked - walked.mean(axis=0)
        place = place * 0.4 / np.sqrt(np.mean(np.sum(place**2, axis=1)))
    place = place - place.mean(axis=0)
    towards = rng.normal(size=3)
    towards /= np.linalg.norm(towards)
    moment = rng.normal(size=3)
    r = place - towards * (distance + float(np.max(place @ towards)))
    d = np.linalg.norm(r, axis=1)[:, None]
    change = 3.0 * (r @ moment)[:, None] * r / d**5 - moment / d**3
    change -= change.mean(axis=0)
    change *= size / np.sqrt(np.mean(np.sum(change**2, axis=1)))
    quaternion = log.quaternion()
    if quaternion is None:
        raise ValueError("a log without attitude")
    seen = np.einsum("nij,ni->nj", rotation_matrices(quaternion), change)
    columns = dict(log.columns)
    for i, axis in enumerate("xyz"):
        columns[f"mag_{axis}_uT"] = columns[f"mag_{axis}_uT"] + seen[:, i]
        columns[f"ref_p{axis}_m"] = place[:, i]
    return replace(log, columns=columns, units=dict.fromkeys(columns, "1"))


def named(log: SensorLog) -> set[str]:
    """What is named in one record."""
    return {item["effect"] for item in found_in(log, "compass").document["adopted"]}


def in_room(motion: str, size: float, seed: int) -> set[str]:
    """What is named in a room with nothing else."""
    if motion == "lifted":
        log, place = lifted(seed)
    else:
        log, _ = log_of("compass", np.random.default_rng([seed, 9]))
        walked = log.vector("ref_p")
        place = np.zeros((log.size, 3)) if walked is None else walked
    return named(in_a_room(log, place, size, np.random.default_rng([seed, 10])))


def planted(effect: Effect, seed: int) -> set[str]:
    """What is named of a planted effect without a room."""
    log, _ = log_of("compass", np.random.default_rng([seed, 9]), effect)
    return named(in_a_room(log, np.zeros((log.size, 3)), 0.0, np.random.default_rng(seed)))


def run() -> Iterator[str]:
    """Every line."""
    for motion in ("lifted", "walked"):
        for size in (0.7, 1.4, 2.1, 2.8):
            wrong = [bool(in_room(motion, size, seed)) for seed in range(RUNS)]
            yield f"room of {size} uT, {motion}: named {np.mean(wrong):.2f} of {RUNS}"
    for effect in PLANTED:
        found = [planted(effect, seed) for seed in range(RUNS)]
        right = np.mean([effect.id in names for names in found])
        other = np.mean([bool(names - {effect.id}) for names in found])
        yield f"no room, {effect.id} {effect.size:.3g}: named {right:.2f}, another {other:.2f}"
    for motion in ("lifted", "walked"):
        for size in (1.4, 4.0):
            for distance in (0.6, 1.5):
                names = [named(beside_a_dipole(motion, s, size, distance)) for s in range(RUNS)]
                wrong = [bool(found - {"field_gradient"}) for found in names]
                yield (
                    f"dipole at {distance} m, {size} uT, {motion}, with the place: "
                    f"wrongly named {np.mean(wrong):.2f} of {RUNS}"
                )
