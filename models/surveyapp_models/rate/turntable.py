"""A rate table and a body on it: where the body points at every moment.

The table turns clockwise as seen from above its axis, so the body turns by minus that rate about
the axis. The axis may be tilted; how the body sits on the table is a rotation that may be a
little wrong (the flip error).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surveyapp_models.arrays import Floats
from surveyapp_models.rate import quaternions
from surveyapp_models.rate.attitude import attitude_matrix, axis_rotation, sensed

POSITIONS = ("x+", "x-", "y+", "y-", "z+", "z-")
"""The body axis that points along the table's axis, and whether up or down."""


def seat(position: str) -> Floats:
    """Rotation of the body on the table, body to table, shape (3, 3).

    The named axis points along the table's axis (up for +), the two others lie in its plane.
    """
    axis, up = "xyz".index(position[0]), position[1] == "+"
    matrix = np.zeros((3, 3))
    matrix[2, axis] = 1.0
    matrix[0, (axis + 1) % 3] = 1.0
    matrix[1, (axis + 2) % 3] = 1.0
    return matrix if up else np.asarray(axis_rotation(0, np.pi) @ matrix)


@dataclass(frozen=True, slots=True)
class Table:
    """A rate table as it stands.

    Parameters
    ----------
    latitude : float
        [rad]
    azimuth : float
        Of the table's zero [rad].
    tilt_along, tilt_across : float
        Of its axis [rad].
    """

    latitude: float
    azimuth: float = 0.0
    tilt_along: float = 0.0
    tilt_across: float = 0.0

    def attitudes(self, angles: Floats, *, mount: Floats) -> Floats:
        """Body to east, north, up, shape (n, 4).

        Parameters
        ----------
        angles : ndarray, shape (n,)
            Of the table, clockwise from above [rad]; not wrapped.
        mount : ndarray, shape (3, 3)
            Body to table.
        """
        base = attitude_matrix(heading=self.azimuth, pitch=self.tilt_along, roll=self.tilt_across)
        vectors = np.zeros((angles.size, 3))
        vectors[:, 2] = -angles
        turned = quaternions.multiply(
            quaternions.from_matrix(base), quaternions.from_rotation_vector(vectors)
        )
        return quaternions.multiply(turned, quaternions.from_matrix(mount))

    def motion(self, angles: Floats, *, interval_s: float, mount: Floats) -> tuple[Floats, Floats]:
        """Rates in inertial space and specific forces of the body between successive angles.

        Parameters
        ----------
        angles : ndarray, shape (n + 1,)
            [rad]
        interval_s : float
        mount : ndarray, shape (3, 3)

        Returns
        -------
        rates, forces : ndarray, shape (n, 3)
            [rad/s], [m/s2], at the middle of each interval.
        """
        q = self.attitudes(angles, mount=mount)
        middle = self.attitudes(0.5 * (angles[1:] + angles[:-1]), mount=mount)
        earth, forces = sensed(middle, latitude=self.latitude)
        return quaternions.body_rates(q, interval_s=interval_s) + earth, forces


def profile(rates: Floats, *, interval_s: float, start: float = 0.0) -> Floats:
    """Angles [rad] of a table after each interval of the given rates [rad/s], shape (n + 1,)."""
    return np.concatenate([[start], start + np.cumsum(rates) * interval_s])


def trapezoid(
    rate: float, *, turning_s: float, ramp_s: float, pause_s: float, interval_s: float
) -> Floats:
    """Rates of a pause, run-up, steady turning, run-down and pause, shape (n,).

    ``rate`` and result in one unit of rate.
    """
    ramp = np.linspace(0.0, rate, max(round(ramp_s / interval_s), 1), endpoint=False)
    pause = np.zeros(round(pause_s / interval_s))
    steady = np.full(round(turning_s / interval_s), rate)
    return np.concatenate([pause, ramp, steady, ramp[::-1], pause])
