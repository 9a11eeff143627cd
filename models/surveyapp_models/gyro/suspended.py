"""The physical parameters of a suspended gyro, and how they follow from its periods.

A value only: what the parameters mean for moments, periods and motion stands in the neighbouring
modules. Only ratios of the parameters can be observed from outside; the angular momentum sets the
scale of all torques and cancels from every angle and every time.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

from surveyapp_models.constants import EARTH_RATE

DEFAULT_ANGULAR_MOMENTUM: Final = 0.187
"""Angular momentum [kg m2/s] taken where none is known: it cancels from angles and times.

Source: recalled for the Wild GAK1, unconfirmed.
"""

DEFAULT_NUTATION_HZ: Final = 30.0
"""Order of the nutation frequency H/J [Hz] of a theodolite attachment, unconfirmed.

It only sets the elevation inertia, whose share of the slow period is below 1e-6.
"""


@dataclass(frozen=True, slots=True)
class SuspendedGyro:
    """A pendulous gyro on a tape.

    Parameters
    ----------
    angular_momentum : float
        H of the rotor [kg m2/s].
    pendulosity : float
        P = m g l [N m].
    vertical_inertia : float
        J_z about the vertical [kg m2].
    elevation_inertia : float
        J about the horizontal axis across the spin axis [kg m2].
    torsion : float
        D of the tape (with its leads) [N m/rad].
    damping : float
        Viscous coefficient k of the motion in azimuth [N m s/rad].

    Raises
    ------
    ValueError
        If a parameter that must be positive is not, or the damping is negative.
    """

    angular_momentum: float
    pendulosity: float
    vertical_inertia: float
    elevation_inertia: float
    torsion: float
    damping: float = 0.0

    def __post_init__(self) -> None:
        for name in ("angular_momentum", "pendulosity", "vertical_inertia", "elevation_inertia"):
            if not getattr(self, name) > 0.0:
                raise ValueError(f"{name} must be positive, found {getattr(self, name)!r}")
        for name in ("torsion", "damping"):
            if not getattr(self, name) >= 0.0:
                raise ValueError(f"{name} must not be negative, found {getattr(self, name)!r}")


def gyro_from_periods(
    *,
    tracking_s: float,
    clamped_s: float,
    unspun_s: float,
    latitude: float,
    angular_momentum: float = DEFAULT_ANGULAR_MOMENTUM,
    nutation_hz: float = DEFAULT_NUTATION_HZ,
    damping_ratio: float = 0.0,
) -> SuspendedGyro:
    """Find the parameters of a gyro whose three small-swing periods are known at one latitude.

    lambda = T1^2/T2^2 - 1, D = lambda M, J_z = D (T0/2 pi)^2, J_eff = M (T1/2 pi)^2 and
    P + M = H^2/(J_eff - J_z), with M = H w cos(latitude).

    Parameters
    ----------
    tracking_s, clamped_s, unspun_s : float
        T1, T2 and T0 [s], full periods of small swings.
    latitude : float
        Where they were measured [rad]; the sign does not matter.
    angular_momentum : float
        H [kg m2/s]; cancels from all angles and times.
    nutation_hz : float
        H/(2 pi J) [Hz]; sets the elevation inertia.
    damping_ratio : float
        zeta of the tracking swing [-]: k = 2 zeta sqrt(J_eff M).

    Returns
    -------
    SuspendedGyro

    Raises
    ------
    ValueError
        If T2 is not shorter than T1, if T0 is so long that J_z would exceed J_eff, or at a pole.

    Notes
    -----
    Source: the inverse of ``surveyapp_models.gyro.periods`` (derived; held against the integrated
    equation of motion in the tests).
    """
    if not clamped_s < tracking_s:
        raise ValueError(
            f"T2 = {clamped_s:g} s is not shorter than T1 = {tracking_s:g} s: "
            "the tape can only stiffen the swing. Are the two periods exchanged?"
        )
    moment = angular_momentum * EARTH_RATE * math.cos(latitude)
    if not moment > 1e-6 * angular_momentum * EARTH_RATE:
        raise ValueError("a gyro does not seek the meridian at a pole")
    effective = moment * (tracking_s / (2.0 * math.pi)) ** 2
    torsion = ((tracking_s / clamped_s) ** 2 - 1.0) * moment
    vertical = torsion * (unspun_s / (2.0 * math.pi)) ** 2
    if not 0.0 < vertical < effective:
        raise ValueError(
            f"T0 = {unspun_s:g} s does not fit T1 = {tracking_s:g} s and T2 = {clamped_s:g} s: "
            "the inertia about the vertical would exceed the effective one"
        )
    return SuspendedGyro(
        angular_momentum=angular_momentum,
        pendulosity=angular_momentum**2 / (effective - vertical) - moment,
        vertical_inertia=vertical,
        elevation_inertia=angular_momentum / (2.0 * math.pi * nutation_hz),
        torsion=torsion,
        damping=2.0 * damping_ratio * math.sqrt(effective * moment),
    )
