"""Periods of a suspended gyro: tracked (T1), clamped (T2) and unspun (T0), against latitude.

All periods are full ones (two half swings) in seconds. What a period says about latitude and spin
is computed here; what it says about lambda and C stands in ``coefficients``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from surveyapp_models.constants import EARTH_RATE
from surveyapp_models.gyro.estimates import Estimate, propagated
from surveyapp_models.gyro.moments import directive_moment, effective_inertia
from surveyapp_models.gyro.suspended import SuspendedGyro


def tracking_period_s(gyro: SuspendedGyro, latitude: float) -> float:
    """Return T1 = 2 pi sqrt(J_eff/M) of small undamped swings with an untwisted tape [s]."""
    inertia = effective_inertia(gyro, latitude)
    return 2.0 * math.pi * math.sqrt(inertia / directive_moment(gyro, latitude))


def clamped_period_s(gyro: SuspendedGyro, latitude: float) -> float:
    """Return T2 = 2 pi sqrt(J_eff/(M + D)) of small undamped swings with the clamp fixed [s]."""
    stiffness = directive_moment(gyro, latitude) + gyro.torsion
    return 2.0 * math.pi * math.sqrt(effective_inertia(gyro, latitude) / stiffness)


def unspun_period_s(gyro: SuspendedGyro) -> float:
    """Return T0 = 2 pi sqrt(J_z/D) of the rotor at rest [s]; ValueError without torsion."""
    if gyro.torsion <= 0.0:
        raise ValueError("a gyro without torsion does not swing when its rotor stands still")
    return 2.0 * math.pi * math.sqrt(gyro.vertical_inertia / gyro.torsion)


def simple_tracking_period_s(gyro: SuspendedGyro, latitude: float) -> float:
    """Return T1 = 2 pi sqrt(H/(P w cos latitude)) [s]: J_z is dropped, about 1 percent short."""
    rate = gyro.pendulosity * EARTH_RATE * math.cos(latitude)
    return 2.0 * math.pi * math.sqrt(gyro.angular_momentum / rate)


def simple_clamped_period_s(gyro: SuspendedGyro, latitude: float) -> float:
    """Return T2 = 2 pi sqrt(H^2/(P (M + D))) [s]: J_z is dropped, about 1 percent short."""
    stiffness = gyro.pendulosity * (directive_moment(gyro, latitude) + gyro.torsion)
    return 2.0 * math.pi * gyro.angular_momentum / math.sqrt(stiffness)


@dataclass(frozen=True, slots=True)
class ModeRates:
    """Angular frequencies of the two modes of the linear two-axis equation [rad/s]."""

    precession: float
    nutation: float


def mode_rates(gyro: SuspendedGyro, latitude: float, *, clamped: bool) -> ModeRates:
    """Return the exact angular frequencies of precession and nutation, undamped.

    The roots of J J_z s^4 + [J K + J_z (P + M) + H^2] s^2 + (P + M) K = 0, with K = M + D where
    the clamp is fixed and K = M where the tape follows. The slow one differs from 2 pi/T1 or
    2 pi/T2 by parts in 10^7: that is what eliminating the elevation costs.

    ``latitude`` [rad].
    """
    moment = directive_moment(gyro, latitude)
    stiffness = moment + (gyro.torsion if clamped else 0.0)
    elevation = gyro.pendulosity + moment
    quartic = gyro.elevation_inertia * gyro.vertical_inertia
    square = (
        gyro.elevation_inertia * stiffness
        + gyro.vertical_inertia * elevation
        + gyro.angular_momentum**2
    )
    constant = elevation * stiffness
    root = math.sqrt(square**2 - 4.0 * quartic * constant)
    return ModeRates(
        precession=math.sqrt(2.0 * constant / (square + root)),
        nutation=math.sqrt((square + root) / (2.0 * quartic)),
    )


def period_at_amplitude_s(period_s: float, *, amplitude: float, stiffness_share: float) -> float:
    """Lengthen a small-swing period for its amplitude.

    Parameters
    ----------
    period_s : float
        Period of small swings [s].
    amplitude : float
        Angular amplitude A [rad].
    stiffness_share : float
        M/(M + D), the share of the stiffness that follows a sine: 1 tracked, 1/(1 + lambda)
        clamped.

    Returns
    -------
    float
        T (1 + share A^2/16) [s]; the next term is 3e-6 at 10 degrees.
    """
    return period_s * (1.0 + stiffness_share * amplitude**2 / 16.0)


def period_with_damping_s(period_s: float, *, ratio_per_half_swing: float) -> float:
    """Lengthen an undamped period for viscous damping.

    Parameters
    ----------
    period_s : float
        Undamped period [s].
    ratio_per_half_swing : float
        q, amplitude ratio of successive half swings, 0 < q <= 1.

    Returns
    -------
    float
        T/sqrt(1 - zeta^2) = T sqrt(1 + (ln q/pi)^2) [s].
    """
    return period_s * math.hypot(1.0, math.log(ratio_per_half_swing) / math.pi)


def tracking_period_spin_sensitivity(gyro: SuspendedGyro, latitude: float) -> float:
    """Return d ln T1/d ln H, about +0.48: one percent of spin is half a percent of period.

    ``latitude`` [rad].
    """
    precession = effective_inertia(gyro, latitude) - gyro.vertical_inertia
    moment = directive_moment(gyro, latitude)
    own = 2.0 - moment / (gyro.pendulosity + moment)
    return 0.5 * (own * precession / (precession + gyro.vertical_inertia) - 1.0)


def clamped_period_spin_sensitivity(gyro: SuspendedGyro, latitude: float) -> float:
    """Return d ln T2/d ln H; larger than that of T1, since the tape does not lose stiffness.

    ``latitude`` [rad].
    """
    moment = directive_moment(gyro, latitude)
    share = moment / (moment + gyro.torsion)
    return tracking_period_spin_sensitivity(gyro, latitude) + 0.5 * (1.0 - share)


def tracking_period_latitude_slope(period_s: float, latitude: float) -> float:
    """Return dT1/dlatitude = T1 tan(latitude)/2 [s/rad]."""
    return 0.5 * period_s * math.tan(latitude)


def transfer_tracking_period(period: Estimate, *, latitude: float, to_latitude: float) -> Estimate:
    """Carry T1 [s] from one latitude to another [rad]: T1 sqrt(cos phi1/cos phi2)."""
    factor = math.sqrt(math.cos(latitude) / math.cos(to_latitude))
    return Estimate(period.value * factor, period.sigma * factor)


def transfer_clamped_period(
    clamped: Estimate, tracking: Estimate, *, latitude: float, to_latitude: float
) -> Estimate:
    """Carry T2 from one latitude to another; needs T1 measured at the same place.

    Parameters
    ----------
    clamped, tracking : Estimate
        T2 and T1 at ``latitude`` [s], independent.
    latitude, to_latitude : float
        [rad].

    Returns
    -------
    Estimate
        T2 at ``to_latitude`` [s]: 1/T2^2 + (cos phi2/cos phi1 - 1)/T1^2 is its inverse square; the
        sigma is propagated from both periods.

    Raises
    ------
    ValueError
        If T2 is not shorter than T1.
    """
    if not clamped.value < tracking.value:
        raise ValueError(
            f"T2 = {clamped.value:g} s is not shorter than T1 = {tracking.value:g} s: "
            "are the two periods exchanged?"
        )
    change = math.cos(to_latitude) / math.cos(latitude) - 1.0
    value = (clamped.value**-2 + change * tracking.value**-2) ** -0.5
    by_clamped = (value / clamped.value) ** 3
    by_tracking = change * (value / tracking.value) ** 3
    return propagated(value, by_clamped * clamped.sigma, by_tracking * tracking.sigma)
