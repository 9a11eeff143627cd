"""Inertial path with zero-velocity updates, and whether the updates were at rest at all.

Strapdown integration with an error-state filter of position, velocity and attitude. While the gate
says rest, velocity is taken for zero. A gate that is too wide calls slow motion rest; the path may
still close, but the velocity that the filter has to throw away is larger than it can be: the share
of such innovations is the test, not the closure.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from surveyapp.core.sensors.rate.still import Mask
from surveyapp_models.arrays import Floats
from surveyapp_models.rate import quaternions

FORCE_WALK = 0.001
"""Least velocity error per square root of a second [m/s]; more where the samples are noisier."""
RATE_WALK = math.radians(0.01)
"""Attitude error per square root of a second [rad]."""
REST_SPEED = 0.001
"""Standard deviation of the velocity at rest: what hands and vibration do [m/s]."""
EVERY = 5
"""An update at every fifth sample at rest."""
BOUND = 11.345
"""99 % point of chi-square with three degrees of freedom."""
TOLERATED = 0.01
"""Share of innovations beyond the 99 % bound: the nominal one. By simulation (bench rate_motion):
drives with sensors of four grades, of vehicles that shake, have .000 to .003 with a right gate and
.10 to .17 with one that calls driving rest. The measured square: .000; fifty times too wide .003,
a hundred times .018, five hundred times .125."""


@dataclass(frozen=True, slots=True)
class InertialPath:
    """Path and test.

    Parameters
    ----------
    position : ndarray, shape (n, 3)
        In a level frame whose y axis is where the body's points at first [m].
    covariance : ndarray, shape (3, 3)
        Of the last position [m2].
    exceeding : float or None
        Share of velocity innovations beyond the 99 % bound; None without any.
    updates : int
    """

    position: Floats
    covariance: Floats
    exceeding: float | None
    updates: int

    @property
    def consistent(self) -> bool:
        """Whether the updates can have been at rest."""
        return self.exceeding is None or self.exceeding <= TOLERATED


def inertial_path(force: Floats, rate: Floats, still: Mask, *, interval_s: float) -> InertialPath:
    """Integrate with zero-velocity updates; bias, gravity and level from the first rest.

    Parameters
    ----------
    force, rate : ndarray, shape (n, 3)
        [m/s2], [rad/s]
    still : ndarray of bool, shape (n,)
        At rest at the beginning.
    interval_s : float
    """
    first = _first_rest(still)
    felt = force[first].mean(axis=0)
    bias = rate[first].mean(axis=0)
    gravity = np.array([0.0, 0.0, float(np.linalg.norm(felt))])
    q = _levelled(felt)
    turns = quaternions.from_rotation_vector((rate - bias) * interval_s)
    velocity, place = np.zeros(3), np.zeros(3)
    covariance = np.diag([1e-8] * 3 + [1e-6] * 3 + [1e-5, 1e-5, 1e-8])
    moving = ~still
    noises = (
        _noise(force[first], rate[first], interval_s),
        _noise(force[moving], rate[first], interval_s),
    )
    step = np.eye(9)
    step[0:3, 3:6] = np.eye(3) * interval_s
    positions = np.empty((force.shape[0], 3))
    beyond, updates = 0, 0
    for k in range(force.shape[0]):
        q = quaternions.multiply(q, turns[k])
        felt_level = quaternions.rotate(q, force[k])
        change = (felt_level - gravity) * interval_s
        place = place + (velocity + 0.5 * change) * interval_s
        velocity = velocity + change
        step[3:6, 6:9] = -_skew(felt_level) * interval_s
        covariance = step @ covariance @ step.T + noises[int(moving[k])]
        if still[k] and k % EVERY == 0:
            gain, size = _gain(covariance, velocity)
            correction = gain @ -velocity
            updates, beyond = updates + 1, beyond + (size > BOUND)
            place, velocity = place + correction[:3], velocity + correction[3:6]
            q = quaternions.multiply(quaternions.from_rotation_vector(correction[6:]), q)
            q = q / math.sqrt(float(q @ q))
            covariance = covariance - gain @ covariance[3:6]
            covariance = 0.5 * (covariance + covariance.T)
        positions[k] = place
    share = beyond / updates if updates else None
    return InertialPath(positions, covariance[:3, :3].copy(), share, updates)


def _noise(force: Floats, rate: Floats, interval_s: float) -> Floats:
    """What one sample adds to the covariance: white noise as these samples show it, shape (9, 9).

    While a unit moves it shakes, and what the samples miss of that is an error of the velocity.
    """
    walks = (
        max(FORCE_WALK, _white(force) * math.sqrt(interval_s)),
        max(RATE_WALK, _white(rate) * math.sqrt(interval_s)),
    )
    found = np.zeros((9, 9))
    found[3:6, 3:6] = np.eye(3) * walks[0] ** 2 * interval_s
    found[6:, 6:] = np.eye(3) * walks[1] ** 2 * interval_s
    return found


def _white(values: Floats) -> float:
    """Standard deviation of a sample at rest, the largest of three axes, drifts left out."""
    if values.shape[0] < 3:
        return 0.0
    return float(np.std(np.diff(values, axis=0), axis=0).max() / math.sqrt(2.0))


def _first_rest(still: Mask) -> slice:
    start = int(np.argmax(still)) if still.any() else 0
    stop = start + int(np.argmin(still[start:])) if not still[start:].all() else still.size
    return slice(start, max(stop, start + 1))


def _levelled(felt: Floats) -> Floats:
    """Attitude that brings the felt force upright, azimuth of the body's y axis zero."""
    up = felt / np.linalg.norm(felt)
    ahead = np.array([0.0, 1.0, 0.0])
    if abs(float(up[1])) > 0.99:
        ahead = np.array([0.0, 0.0, 1.0])
    ahead = ahead - up * float(up @ ahead)
    ahead /= np.linalg.norm(ahead)
    return quaternions.from_matrix(np.vstack([np.cross(ahead, up), ahead, up]))


def _skew(vector: Floats) -> Floats:
    x, y, z = vector.tolist()
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def _gain(covariance: Floats, velocity: Floats) -> tuple[Floats, float]:
    """Gain of a zero-velocity update, and the innovation squared in its own covariance."""
    spread = covariance[3:6, 3:6] + np.eye(3) * REST_SPEED**2
    inverse = np.linalg.inv(spread)
    return covariance[:, 3:6] @ inverse, float(velocity @ inverse @ velocity)
