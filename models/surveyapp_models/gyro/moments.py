"""The moments that act on a suspended gyro about the vertical, against latitude.

Angles are clockwise from north. Only cos(latitude) enters the meridian-seeking moment, so there is
no southern case; the rest tilt of the spin axis is the one quantity here whose sign flips.
"""

from __future__ import annotations

import math
from typing import Final, Literal

from surveyapp_models.constants import EARTH_RATE
from surveyapp_models.gyro.suspended import SuspendedGyro

LATITUDE_WARN: Final = math.radians(70.0)
"""Above this latitude a session is warned about. Source: house rule below the maker's limit."""
LATITUDE_LIMIT: Final = math.radians(75.0)
"""Makers' limit of use: M falls to 0.26 of its value at the equator. It is no singularity."""


def directive_moment(gyro: SuspendedGyro, latitude: float) -> float:
    """Return M = H w cos(latitude), the stiffness of the meridian-seeking moment [N m/rad]."""
    return gyro.angular_momentum * EARTH_RATE * math.cos(latitude)


def meridian_seeking_moment(gyro: SuspendedGyro, *, latitude: float, azimuth: float) -> float:
    """Return the moment that drives the spin axis towards the meridian [N m].

    Parameters
    ----------
    gyro : SuspendedGyro
    latitude : float
        [rad].
    azimuth : float
        Azimuth of the spin axis from north [rad].

    Returns
    -------
    float
        H w cos(latitude) sin(azimuth) [N m]: zero on the meridian, largest at 90 degrees, zero
        again (and unstable) at 180 degrees. It acts against the azimuth.
    """
    return directive_moment(gyro, latitude) * math.sin(azimuth)


def torsion_moment(gyro: SuspendedGyro, *, azimuth: float, tape_azimuth: float) -> float:
    """Return the moment D (azimuth - tape_azimuth) of the twisted tape [N m], angles [rad]."""
    return gyro.torsion * (azimuth - tape_azimuth)


def effective_inertia(gyro: SuspendedGyro, latitude: float) -> float:
    """Return J_eff = J_z + H^2/(P + M), the inertia of the slow precession [kg m2]."""
    stiffness = gyro.pendulosity + directive_moment(gyro, latitude)
    return gyro.vertical_inertia + gyro.angular_momentum**2 / stiffness


def rest_elevation(gyro: SuspendedGyro, latitude: float) -> float:
    """Return the rest tilt of the spin axis H w sin(latitude)/(P + M) [rad], nose up northward."""
    vertical = gyro.angular_momentum * EARTH_RATE * math.sin(latitude)
    return vertical / (gyro.pendulosity + directive_moment(gyro, latitude))


def north_shift_of_torque(gyro: SuspendedGyro, *, latitude: float, torque: float) -> float:
    """Return the shift of a tracked gyro's rest position by a constant torque [rad].

    tau/(H w cos latitude): this part of the error budget, and only this, grows with the secant of
    the latitude.
    """
    return torque / directive_moment(gyro, latitude)


def latitude_verdict(
    latitude: float, *, limit: float = LATITUDE_LIMIT, beyond: bool = False
) -> Literal["good", "warn"]:
    """Judge a latitude for work with a suspended gyro.

    Parameters
    ----------
    latitude : float
        [rad], either hemisphere.
    limit : float
        Refused above this, absolute [rad].
    beyond : bool
        True where the user has asked for work beyond the limit: it is then only warned about.

    Returns
    -------
    {"good", "warn"}

    Raises
    ------
    ValueError
        Above the limit unless ``beyond``; at 90 degrees always, since nothing seeks north there.
    """
    degrees, bound = math.degrees(abs(latitude)), math.degrees(limit)
    if degrees > 90.0 - 1e-6:
        raise ValueError(f"latitude {degrees:.4f} degrees: a gyro does not seek north at a pole")
    if degrees > bound + 1e-9 and not beyond:
        raise ValueError(
            f"latitude {degrees:.2f} degrees exceeds {bound:.2f} degrees, the limit of this kind "
            f"of instrument: its directive moment is {math.cos(latitude):.2f} of the equator's"
        )
    return "warn" if degrees > min(bound, math.degrees(LATITUDE_WARN)) + 1e-9 else "good"
