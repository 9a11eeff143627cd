"""Heading, pitch and roll of a body, and what the earth does to its sensors.

Body X right, Y forward, Z up; navigation frame east, north, up. Heading clockwise from north,
pitch up positive, roll right side down positive: C = Rz(-heading) Rx(pitch) Ry(roll).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from surveyapp_models.angles import wrap_two_pi
from surveyapp_models.arrays import Floats
from surveyapp_models.constants import EARTH_RATE
from surveyapp_models.rate import quaternions

STANDARD_GRAVITY = 9.80665
"""[m/s2] One g. Source: 3rd General Conference on Weights and Measures, 1901."""

EULER_LIMIT = math.radians(85.0)
"""Pitch from which on heading and roll of a body are not told apart any more [rad]: there a
tilt error is multiplied by more than tan 85 = 11."""


class Euler(NamedTuple):
    """Heading, pitch and roll [rad]."""

    heading: float
    pitch: float
    roll: float


def earth_rate(latitude: float) -> Floats:
    """Rotation of the earth in east, north, up [rad/s], shape (3,); latitude in rad."""
    return EARTH_RATE * np.array([0.0, math.cos(latitude), math.sin(latitude)])


def axis_rotation(axis: int, angle: float) -> Floats:
    """Right-handed rotation about a coordinate axis (0, 1, 2) by an angle [rad], shape (3, 3)."""
    i, j = (axis + 1) % 3, (axis + 2) % 3
    c, s = math.cos(angle), math.sin(angle)
    matrix = np.eye(3)
    matrix[i, i] = matrix[j, j] = c
    matrix[i, j], matrix[j, i] = -s, s
    return matrix


def attitude_matrix(*, heading: float, pitch: float = 0.0, roll: float = 0.0) -> Floats:
    """Body to east, north, up, shape (3, 3); angles in rad.

    ``heading``, ``pitch``, ``roll`` [rad].
    """
    level = axis_rotation(2, -heading) @ axis_rotation(0, pitch)
    return np.asarray(level @ axis_rotation(1, roll))


def attitude_quaternion(*, heading: float, pitch: float = 0.0, roll: float = 0.0) -> Floats:
    """The same as a quaternion, shape (4,).

    ``heading``, ``pitch``, ``roll`` [rad].
    """
    return quaternions.from_matrix(attitude_matrix(heading=heading, pitch=pitch, roll=roll))


def euler_angles(matrix: Floats) -> Euler:
    """Heading, pitch and roll of an attitude, shape (3, 3).

    Near pitch 90 degrees heading and roll are one angle: ask ``abs(pitch) > EULER_LIMIT`` first.
    """
    m = np.asarray(matrix)
    pitch = math.asin(min(1.0, max(-1.0, float(m[2, 1]))))
    heading = wrap_two_pi(math.atan2(float(m[0, 1]), float(m[1, 1])))
    return Euler(heading, pitch, math.atan2(-float(m[2, 0]), float(m[2, 2])))


def azimuth_of(vector: Floats) -> float:
    """Azimuth [rad, 0 to 2 pi] of a vector in east, north, up."""
    return wrap_two_pi(math.atan2(float(vector[0]), float(vector[1])))


def sensed(
    q: Floats, *, latitude: float, gravity: float = STANDARD_GRAVITY
) -> tuple[Floats, Floats]:
    """Earth rate and specific force in a body at rest.

    Parameters
    ----------
    q : ndarray, shape (..., 4)
        Body to east, north, up.
    latitude : float
        [rad]
    gravity : float
        [m/s2]

    Returns
    -------
    rates : ndarray, shape (..., 3)
        [rad/s]
    forces : ndarray, shape (..., 3)
        [m/s2]; an axis that points up reads +g.
    """
    rates = quaternions.rotate_back(q, earth_rate(latitude))
    return rates, quaternions.rotate_back(q, np.array([0.0, 0.0, gravity]))
