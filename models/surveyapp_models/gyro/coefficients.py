"""Torsion ratio lambda and proportional constant C: from periods, clampings, another latitude.

lambda = D/M = T1^2/T2^2 - 1 (never T1^2/(T2^2 - T1^2): T1 is the longer period). C is the factor
of the transit method, north = clamp + C a dt [rad/(div s)], with dt the difference of the times
east and west over a whole swing. C follows neither the cosine nor the secant of the latitude.
"""

from __future__ import annotations

import math
from typing import Final

from surveyapp_models.angles import RHO_ARCSEC
from surveyapp_models.gyro.estimates import Estimate, propagated

CONSISTENCY_LIMIT: Final = 0.05
"""Largest relative difference between a card's coefficient and that of its periods [-].

Unit and half-swing mix-ups change C by a factor of 2, 1.6 or 60; periods known to 0.2 s agree to
0.5 percent. Source: house rule, five percent lies far from both.
"""


def torsion_ratio_from_periods(tracking: Estimate, clamped: Estimate) -> Estimate:
    """Return lambda = T1^2/T2^2 - 1 with its sigma; ValueError if T2 is not shorter than T1."""
    if not 0.0 < clamped.value < tracking.value:
        raise ValueError(
            f"T2 = {clamped.value:g} s must be shorter than T1 = {tracking.value:g} s: "
            "are the two periods exchanged?"
        )
    one_plus = (tracking.value / clamped.value) ** 2
    return propagated(
        one_plus - 1.0,
        2.0 * one_plus * tracking.sigma / tracking.value,
        2.0 * one_plus * clamped.sigma / clamped.value,
    )


def torsion_ratio_from_clampings(
    clamps: tuple[Estimate, Estimate], centres_div: tuple[Estimate, Estimate], *, scale_value: float
) -> Estimate:
    """Find lambda from two clampings east and west of north, rotor spinning, same tape zero.

    Parameters
    ----------
    clamps : tuple of Estimate
        Circle readings H1, H2 of the clamped alidade [rad], less than half a circle apart.
    centres_div : tuple of Estimate
        Centres of swing B1, B2 on the scale [div].
    scale_value : float
        mu [rad/div], signed.

    Returns
    -------
    Estimate
        (H1 - H2)/(mu (B2 - B1)) - 1 [-].

    Raises
    ------
    ValueError
        If the two centres are equal, or if the result is negative (sign of the scale, or the two
        centres exchanged).
    """
    (first, second), (centre_1, centre_2) = clamps, centres_div
    span = scale_value * (centre_2.value - centre_1.value)
    if span == 0.0:
        raise ValueError("the two clampings have the same centre of swing: they say nothing")
    one_plus = math.remainder(first.value - second.value, 2.0 * math.pi) / span
    if not one_plus > 1.0:
        raise ValueError(
            f"two clampings give lambda = {one_plus - 1.0:.4f}, which must be positive: "
            "is the scale reversed, or are the centres exchanged?"
        )
    relative = scale_value / span
    return propagated(
        one_plus - 1.0,
        first.sigma / span,
        second.sigma / span,
        one_plus * relative * centre_1.sigma,
        one_plus * relative * centre_2.sigma,
    )


def transit_coefficient_from_periods(
    tracking: Estimate, clamped: Estimate, *, scale_value: float
) -> Estimate:
    """Return C = (pi/2) mu T1^2/T2^3 [rad/(div s)] with its sigma; ``scale_value`` is mu."""
    torsion_ratio_from_periods(tracking, clamped)  # refuses exchanged periods
    value = 0.5 * math.pi * scale_value * tracking.value**2 / clamped.value**3
    return propagated(
        value,
        2.0 * value * tracking.sigma / tracking.value,
        3.0 * value * clamped.sigma / clamped.value,
    )


def transit_coefficient_from_clampings(
    clamps: tuple[Estimate, Estimate], products_div_s: tuple[Estimate, Estimate]
) -> Estimate:
    """Find C from two clampings some 10 to 15 minutes east and west of north.

    Parameters
    ----------
    clamps : tuple of Estimate
        Circle readings N'1, N'2 [rad].
    products_div_s : tuple of Estimate
        a1 dt1 and a2 dt2, half amplitude times time difference [div s].

    Returns
    -------
    Estimate
        (N'2 - N'1)/(a1 dt1 - a2 dt2) [rad/(div s)].

    Raises
    ------
    ValueError
        If both products are equal.
    """
    (first, second), (product_1, product_2) = clamps, products_div_s
    span = product_1.value - product_2.value
    if span == 0.0:
        raise ValueError("the two clampings have equal products a dt: they say nothing")
    value = math.remainder(second.value - first.value, 2.0 * math.pi) / span
    return propagated(
        value,
        first.sigma / span,
        second.sigma / span,
        value * product_1.sigma / span,
        value * product_2.sigma / span,
    )


def transfer_torsion_ratio(ratio: Estimate, *, latitude: float, to_latitude: float) -> Estimate:
    """Carry lambda to another latitude [rad]: lambda cos(phi1)/cos(phi2), exact at equal spin."""
    factor = math.cos(latitude) / math.cos(to_latitude)
    return Estimate(ratio.value * factor, ratio.sigma * factor)


def transit_coefficient_ratio(ratio: float, *, latitude: float, to_latitude: float) -> float:
    """Return C(to_latitude)/C(latitude) for lambda = ``ratio`` at ``latitude``.

    sqrt(cos phi2/cos phi1) ((1 + lambda2)/(1 + lambda1))^(3/2): C falls with latitude where
    lambda < 1/2, stands still at 1/2 and rises above it.

    ``latitude``, ``to_latitude`` [rad].
    """
    fall = math.cos(to_latitude) / math.cos(latitude)
    stiffer = (1.0 + ratio / fall) / (1.0 + ratio)
    return math.sqrt(fall * stiffer) * stiffer


def transfer_transit_coefficient(
    coefficient: Estimate, ratio: Estimate, *, latitude: float, to_latitude: float
) -> Estimate:
    """Carry C to another latitude.

    Parameters
    ----------
    coefficient : Estimate
        C at ``latitude``, any unit.
    ratio : Estimate
        lambda at ``latitude``, independent of C; where both come from the same periods use
        ``transit_coefficient_at_latitude``.
    latitude, to_latitude : float
        [rad].

    Returns
    -------
    Estimate
        C at ``to_latitude`` in the same unit.
    """
    factor = transit_coefficient_ratio(ratio.value, latitude=latitude, to_latitude=to_latitude)
    rise = math.cos(latitude) / math.cos(to_latitude)
    by_ratio = 1.5 * (rise / (1.0 + ratio.value * rise) - 1.0 / (1.0 + ratio.value))
    value = coefficient.value * factor
    return propagated(value, coefficient.sigma * factor, value * by_ratio * ratio.sigma)


def transit_coefficient_at_latitude(
    tracking: Estimate,
    clamped: Estimate,
    *,
    scale_value: float,
    latitude: float,
    to_latitude: float,
) -> Estimate:
    """Find C at a latitude from the periods of another one.

    Parameters
    ----------
    tracking, clamped : Estimate
        T1 and T2 at ``latitude`` [s], independent.
    scale_value : float
        mu [rad/div].
    latitude, to_latitude : float
        [rad].

    Returns
    -------
    Estimate
        C at ``to_latitude`` [rad/(div s)]; the sigma is propagated from the two periods, through
        both of which lambda enters as well.
    """
    torsion_ratio_from_periods(tracking, clamped)  # refuses exchanged periods
    t1, t2 = tracking.value, clamped.value
    fall = math.cos(to_latitude) / math.cos(latitude)
    inverse = t2**-2 + (fall - 1.0) * t1**-2
    value = 0.5 * math.pi * scale_value * t1**2 / fall * inverse**1.5
    by_tracking = value * (2.0 / t1 - 3.0 * (fall - 1.0) / (t1**3 * inverse))
    by_clamped = -3.0 * value / (t2**3 * inverse)
    return propagated(value, by_tracking * tracking.sigma, by_clamped * clamped.sigma)


def transit_coefficient_latitude_slope(ratio: float, latitude: float) -> float:
    """Return d ln C/d latitude = -tan(phi) (1 - 2 lambda)/(2 (1 + lambda)) [1/rad]."""
    return -math.tan(latitude) * (1.0 - 2.0 * ratio) / (2.0 * (1.0 + ratio))


def north_error_of_spin_change(
    ratio: float, *, spin_change: float, scale_value: float, centre_div: float, zero_div: float
) -> float:
    """Return the error of north when the spin has changed and lambda is used as it was [rad].

    Parameters
    ----------
    ratio : float
        lambda at the spin of the calibration [-]; it goes with 1/H.
    spin_change : float
        Relative change of the spin since, 0.01 for one percent more.
    scale_value : float
        mu [rad/div].
    centre_div, zero_div : float
        Centre of swing B (0 for a tracked swing, whose scale is held on 0) and tape zero d [div].

    Returns
    -------
    float
        Computed minus true north, (lambda - lambda_now) mu (B - d).
    """
    now = ratio / (1.0 + spin_change)
    return (ratio - now) * scale_value * (centre_div - zero_div)


def check_torsion_ratio(ratio: float, *, tracking_s: float, clamped_s: float) -> None:
    """Hold a card's lambda against T1^2/T2^2 - 1 of the same latitude.

    Raises
    ------
    ValueError
        If the two differ by more than 5 percent: the message names both numbers.
    """
    from_periods = torsion_ratio_from_periods(
        Estimate(tracking_s, 0.0), Estimate(clamped_s, 0.0)
    ).value
    if abs(ratio - from_periods) > CONSISTENCY_LIMIT * abs(from_periods):
        raise ValueError(
            f"lambda = {ratio:.4f} is stated, but T1 = {tracking_s:g} s and T2 = {clamped_s:g} s "
            f"give T1^2/T2^2 - 1 = {from_periods:.4f}: more than 5 % apart. "
            "Is one of them 1/lambda, or from another latitude?"
        )


def check_transit_coefficient(
    coefficient: float, *, scale_value: float, tracking_s: float, clamped_s: float
) -> None:
    """Hold a card's C against (pi/2) mu T1^2/T2^3 of the same latitude.

    Parameters
    ----------
    coefficient : float
        C [rad/(div s)].
    scale_value : float
        mu [rad/div].
    tracking_s, clamped_s : float
        T1 and T2 [s].

    Raises
    ------
    ValueError
        If the two differ by more than 5 percent: the message names both numbers and, where one
        fits, the mix-up that would explain it.
    """
    expected = transit_coefficient_from_periods(
        Estimate(tracking_s, 0.0), Estimate(clamped_s, 0.0), scale_value=scale_value
    ).value
    if abs(coefficient - expected) <= CONSISTENCY_LIMIT * abs(expected):
        return
    raise ValueError(
        f'C = {coefficient * RHO_ARCSEC:.4g}"/(div s) is stated, but the scale value and '
        f"T1 = {tracking_s:g} s, T2 = {clamped_s:g} s give (pi/2) mu T1^2/T2^3 = "
        f'{expected * RHO_ARCSEC:.4g}"/(div s): more than 5 % apart. '
        + _mix_up(coefficient / expected)
    )


def _mix_up(factor: float) -> str:
    """Name the unit or definition that a factor between two values of C betrays."""
    known = (
        (1.0 / 60.0, "The stated value looks like minutes of arc."),
        (60.0, "The stated value looks like arc-seconds entered as minutes."),
        (1.0 / 3.24, "The stated value looks like mgon."),
        (2.0, "The stated value looks like one for half swings."),
        (0.5, "The stated value looks like one for both half swings together."),
        (-1.0, "The scale looks reversed."),
    )
    for expected, text in known:
        if abs(factor / expected - 1.0) <= CONSISTENCY_LIMIT:
            return text
    return "Check its unit, and whether it was defined for half swings."
