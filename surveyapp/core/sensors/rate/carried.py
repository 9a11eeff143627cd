"""A heading carried through a rotation: quaternions of the rates, the earth's own rate taken out.

At rest a gyro shows its bias and the earth's rate in its axes. Where the latitude is known the two
are told apart by the attitude of the rest, and the earth's rate is followed through the rotation;
else the rest is taken out whole, which is right as long as the vertical stays where it was in the
unit, and what it may be wrong by is counted.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from surveyapp_models.arrays import Floats
from surveyapp_models.constants import EARTH_RATE
from surveyapp_models.rate import quaternions
from surveyapp_models.rate.attitude import (
    EULER_LIMIT,
    attitude_matrix,
    azimuth_of,
    earth_rate,
    euler_angles,
)

AT_REST_SIGMAS = 6.0
"""Samples whose rates lie within this of the rest belong to it still."""
LEAST_TILT = math.radians(0.2)
"""The unit was turned between levelling and run where gravity moved by more than this [rad]."""
REST_S = 0.5
"""Of the beginning of the run, for its tilt."""


@dataclass(frozen=True, slots=True)
class Rest:
    """The rest before the run.

    Parameters
    ----------
    mean, sigma, sample : ndarray, shape (3,)
        Rate, how well it is known, standard deviation of a sample [rad/s].
    tilt : tuple of float
        Pitch and roll [rad].
    force_sample : float
        Standard deviation of a sample of the accelerometers [m/s2].
    """

    mean: Floats
    sigma: Floats
    sample: Floats
    tilt: tuple[float, float]
    force_sample: float


@dataclass(frozen=True, slots=True)
class Run:
    """Samples of the rotation.

    Parameters
    ----------
    rates, forces : ndarray, shape (n, 3)
        [rad/s], [m/s2]
    intervals : ndarray, shape (n,)
        Until the next sample [s].
    """

    rates: Floats
    forces: Floats
    intervals: Floats


@dataclass(frozen=True, slots=True)
class Carried:
    """Where the unit points after the run.

    Parameters
    ----------
    heading : float
        Of Y, or of Z where the unit stands upright [rad].
    sigma : float
        Of the heading, from rest, noise and what of the earth's rate is not followed [rad].
    quaternion : ndarray, shape (4,)
        Body to east, north, up.
    vertical : bool
    turned : float
        Of the heading, clockwise [rad].
    """

    heading: float
    sigma: float
    quaternion: Floats
    vertical: bool
    turned: float


def carry(run: Run, rest: Rest, *, heading: float, latitude: float | None) -> Carried:
    """Attitude after the run.

    The rates are summed in a frame that does not turn with the earth, and the earth's turn during
    the run is taken out at the end: exact for rates that are constant within a sample.

    Parameters
    ----------
    run : Run
    rest : Rest
    heading : float
        At the beginning of the run, true where it is known [rad].
    latitude : float or None
        [rad]
    """
    pitch, roll = tilt_at_start(run, rest)
    before = attitude_matrix(heading=heading, pitch=rest.tilt[0], roll=rest.tilt[1])
    start = attitude_matrix(heading=heading, pitch=pitch, roll=roll)
    earth = np.zeros(3) if latitude is None else earth_rate(latitude)
    rates = run.rates - (rest.mean - before.T @ earth)
    q = quaternions.integrate(
        rates * run.intervals[:, None], interval_s=1.0, start=quaternions.from_matrix(start)
    )
    seconds = float(run.intervals.sum())
    back = quaternions.from_rotation_vector(-earth * seconds)
    last = quaternions.multiply(back, q[-1])
    attitude = quaternions.to_matrix(last)
    vertical = abs(euler_angles(attitude).pitch) > EULER_LIMIT
    axis = 2 if vertical else 1
    found = azimuth_of(attitude[:, axis])
    return Carried(
        found,
        _sigma(q[:-1], run, rest, followed=latitude is not None),
        last,
        vertical,
        found - azimuth_of(start[:, axis]),
    )


def tilt_at_start(run: Run, rest: Rest) -> tuple[float, float]:
    """Pitch and roll where the run begins: those of the levelling, unless the unit was moved."""
    count = max(round(REST_S / float(np.median(run.intervals))), 3)
    off = np.abs(run.rates[:count] - rest.mean) > AT_REST_SIGMAS * rest.sample + 1e-9
    moving = np.flatnonzero(off.any(axis=1))
    still = int(moving[0]) if moving.size else min(count, run.rates.shape[0])
    here = tilt_of(run.forces[: max(still, 1)].mean(axis=0))
    size = float(np.linalg.norm(run.forces[0]))
    noise = 4.0 * rest.force_sample / size / math.sqrt(max(still, 1))
    apart = max(abs(a - b) for a, b in zip(here, rest.tilt, strict=True))
    return here if apart > max(noise, LEAST_TILT) else rest.tilt


def tilt_of(force: Floats) -> tuple[float, float]:
    """Pitch and roll [rad] from what the accelerometers feel at rest, shape (3,)."""
    up = force / float(np.linalg.norm(force))
    pitch = math.asin(min(1.0, max(-1.0, float(up[1]))))
    return pitch, math.atan2(-float(up[0]), float(up[2]))


def _sigma(q: Floats, run: Run, rest: Rest, *, followed: bool) -> float:
    """Standard deviation of the heading [rad].

    An error of a rate turns the heading by its part about the vertical. Without a latitude the
    earth's rate in the unit is taken for that of the rest: the vertical of the rest and that of
    the run see a different part of it, whose direction is not known.
    """
    up = quaternions.rotate_back(q, np.array([0.0, 0.0, 1.0])) * run.intervals[:, None]
    variance = float(np.sum((up.sum(axis=0) * rest.sigma) ** 2))
    variance += float(np.sum(up**2 @ rest.sample**2))
    if not followed:
        first = quaternions.rotate(q[0], quaternions.rotate_back(q, np.array([0.0, 0.0, 1.0])))
        moved = (first - np.array([0.0, 0.0, 1.0])) * run.intervals[:, None]
        variance += float(np.sum(moved.sum(axis=0) ** 2)) * EARTH_RATE**2 / 3.0
    return math.sqrt(variance)
