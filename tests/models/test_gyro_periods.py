"""Periods, lambda and C against the published table figures, each by its own computation."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Literal

import numpy as np
import pytest

from surveyapp_models.constants import EARTH_RATE
from surveyapp_models.gyro.coefficients import (
    check_torsion_ratio,
    check_transit_coefficient,
    torsion_ratio_from_clampings,
    torsion_ratio_from_periods,
    transfer_torsion_ratio,
    transfer_transit_coefficient,
    transit_coefficient_at_latitude,
    transit_coefficient_from_clampings,
    transit_coefficient_from_periods,
    transit_coefficient_latitude_slope,
    transit_coefficient_ratio,
)
from surveyapp_models.gyro.estimates import Estimate
from surveyapp_models.gyro.moments import (
    directive_moment,
    latitude_verdict,
    meridian_seeking_moment,
    north_shift_of_torque,
    rest_elevation,
    torsion_moment,
)
from surveyapp_models.gyro.periods import (
    clamped_period_s,
    clamped_period_spin_sensitivity,
    mode_rates,
    period_at_amplitude_s,
    period_with_damping_s,
    simple_clamped_period_s,
    simple_tracking_period_s,
    tracking_period_latitude_slope,
    tracking_period_s,
    tracking_period_spin_sensitivity,
    transfer_clamped_period,
    transfer_tracking_period,
    unspun_period_s,
)
from surveyapp_models.gyro.suspended import SuspendedGyro, gyro_from_periods

ARCSEC = math.pi / 648000.0


def rad(degrees: float) -> float:
    return math.radians(degrees)


def table_gyro(angular_momentum: float = 0.187) -> SuspendedGyro:
    """H = 0.187, P = 0.84, J_z = 2.4 % of H^2/P; lambda = 0.2 at 47 degrees."""
    torsion = 0.2 * 0.187 * 7.292115e-5 * math.cos(rad(47.0))
    return SuspendedGyro(angular_momentum, 0.84, 1.0e-3, 1.0e-3, torsion)


PERIOD_TABLE = [
    # latitude, T1, T1 simple, T2, lambda
    (0.0, 351.306, 347.16, 329.549, 0.1364),
    (30.0, 377.503, 373.05, 350.881, 0.1575),
    (47.0, 425.397, 420.38, 388.333, 0.2000),
    (60.0, 496.823, 490.96, 440.374, 0.2728),
    (75.0, 690.541, 682.40, 558.816, 0.5270),
]


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(("degrees", "tracking", "simple", "clamped", "ratio"), PERIOD_TABLE)
def test_periods_follow_the_table(
    degrees: float, tracking: float, simple: float, clamped: float, *, ratio: float, sign: float
) -> None:
    gyro, latitude = table_gyro(), rad(sign * degrees)
    assert tracking_period_s(gyro, latitude) == pytest.approx(tracking, abs=6e-4)
    assert simple_tracking_period_s(gyro, latitude) == pytest.approx(simple, abs=6e-3)
    assert clamped_period_s(gyro, latitude) == pytest.approx(clamped, abs=6e-4)
    assert gyro.torsion / directive_moment(gyro, latitude) == pytest.approx(ratio, abs=6e-5)


def test_periods_of_source_000_by_the_simple_form() -> None:
    """H = 0.4, mgl = 0.25, lambda 0.450 at the equator to 1.739 at 75 degrees."""
    torsion = 0.45 * 0.4 * EARTH_RATE
    gyro = SuspendedGyro(0.4, 0.25, 1e-9, 1e-3, torsion)
    assert simple_tracking_period_s(gyro, 0.0) == pytest.approx(930.71, abs=0.01)
    assert simple_clamped_period_s(gyro, 0.0) == pytest.approx(772.91, abs=0.02)
    assert simple_tracking_period_s(gyro, rad(75)) == pytest.approx(1829.43, abs=0.01)
    assert simple_clamped_period_s(gyro, rad(75)) == pytest.approx(1105.47, abs=0.02)
    assert torsion / directive_moment(gyro, rad(75)) == pytest.approx(1.739, abs=6e-4)


def test_moment_follows_cosine_of_latitude_and_sine_of_azimuth() -> None:
    gyro = table_gyro()
    assert directive_moment(gyro, rad(47)) == pytest.approx(9.3e-6, rel=2e-3)
    assert directive_moment(gyro, rad(75)) / directive_moment(gyro, 0.0) == pytest.approx(
        0.259, abs=5e-4
    )
    at = [meridian_seeking_moment(gyro, latitude=rad(35), azimuth=rad(a)) for a in (0, 30, 90, 150)]
    assert at[0] == 0.0
    assert at[2] == max(at)
    assert at[1] == pytest.approx(at[3])
    assert meridian_seeking_moment(gyro, latitude=rad(90), azimuth=1.0) == pytest.approx(
        0.0, abs=1e-20
    )
    assert torsion_moment(gyro, azimuth=0.02, tape_azimuth=0.01) == pytest.approx(
        0.01 * gyro.torsion
    )


def test_torque_for_one_arcsecond_and_rest_tilt() -> None:
    gyro = table_gyro()
    shift = north_shift_of_torque(gyro, latitude=rad(47), torque=4.5e-11)
    assert shift / ARCSEC == pytest.approx(1.0, rel=0.01)
    assert rest_elevation(gyro, rad(47)) / ARCSEC == pytest.approx(2.4, abs=0.05)
    assert rest_elevation(gyro, rad(-47)) == -rest_elevation(gyro, rad(47))


def test_latitude_verdicts() -> None:
    assert latitude_verdict(rad(70)) == "good"
    assert latitude_verdict(rad(-70.5)) == "warn"
    assert latitude_verdict(rad(75)) == "warn"
    assert latitude_verdict(rad(-80), beyond=True) == "warn"
    with pytest.raises(ValueError, match=r"75\.50 degrees exceeds 75\.00"):
        latitude_verdict(rad(-75.5))
    with pytest.raises(ValueError, match="pole"):
        latitude_verdict(rad(90), beyond=True)


def test_amplitude_correction_against_the_elliptic_integral() -> None:
    """A pendulum's period is T0/agm(1, cos(A/2)): independent of the series in A."""
    for degrees, seconds in ((5.0, 0.20), (10.0, None)):
        a, g = 1.0, math.cos(rad(degrees) / 2.0)
        for _ in range(8):
            a, g = 0.5 * (a + g), math.sqrt(a * g)
        corrected = period_at_amplitude_s(425.0, amplitude=rad(degrees), stiffness_share=1.0)
        assert corrected == pytest.approx(425.0 / a, rel=4e-6)
        if seconds is not None:
            assert corrected - 425.0 == pytest.approx(seconds, abs=0.005)


def test_damping_correction_is_that_of_the_damping_ratio() -> None:
    for zeta in (0.002, 0.01, 0.1):
        ratio = math.exp(-math.pi * zeta / math.sqrt(1.0 - zeta**2))
        period = period_with_damping_s(400.0, ratio_per_half_swing=ratio)
        assert period == pytest.approx(400.0 / math.sqrt(1.0 - zeta**2), rel=1e-12)


def test_slow_root_of_the_two_axis_equation_against_numpy_roots() -> None:
    gyro, latitude = table_gyro(), rad(-47)
    moment = directive_moment(gyro, latitude)
    for clamped, stiffness in ((False, moment), (True, moment + gyro.torsion)):
        rates = mode_rates(gyro, latitude, clamped=clamped)
        elevation = gyro.pendulosity + moment
        polynomial = [
            gyro.elevation_inertia * gyro.vertical_inertia,
            gyro.elevation_inertia * stiffness
            + gyro.vertical_inertia * elevation
            + gyro.angular_momentum**2,
            elevation * stiffness,
        ]
        # a quadratic in s^2; scaled so that both roots are of order one in turn
        product = rates.precession**2 * rates.nutation**2
        assert product == pytest.approx(polynomial[2] / polynomial[0], rel=1e-10)
        total = rates.precession**2 + rates.nutation**2
        assert total == pytest.approx(polynomial[1] / polynomial[0], rel=1e-10)
        period = (clamped_period_s if clamped else tracking_period_s)(gyro, latitude)
        assert 2.0 * math.pi / rates.precession == pytest.approx(period, rel=1e-6)
    assert mode_rates(gyro, latitude, clamped=False).nutation / (2 * math.pi) == pytest.approx(
        30.0, rel=0.02
    )


def test_spin_sensitivity_is_the_derivative() -> None:
    for degrees in (0.0, 47.0, 70.0):
        latitude = rad(degrees)
        for period, slope in (
            (tracking_period_s, tracking_period_spin_sensitivity),
            (clamped_period_s, clamped_period_spin_sensitivity),
        ):
            values = [math.log(period(table_gyro(0.187 * f), latitude)) for f in (0.999, 1.001)]
            numeric = (values[1] - values[0]) / math.log(1.001 / 0.999)
            assert slope(table_gyro(), latitude) == pytest.approx(numeric, rel=1e-5)
    assert tracking_period_spin_sensitivity(table_gyro(), rad(47)) == pytest.approx(0.48, abs=0.005)
    gain = tracking_period_s(table_gyro(0.187 * 1.01), rad(47)) - tracking_period_s(
        table_gyro(), rad(47)
    )
    assert gain == pytest.approx(2.0, abs=0.05)


@pytest.mark.parametrize(
    ("degrees", "percent"), [(30.0, 0.5), (47.0, 0.94), (60.0, 1.5), (70.0, 2.4)]
)
def test_period_slope_with_latitude(degrees: float, percent: float) -> None:
    slope = tracking_period_latitude_slope(425.0, rad(degrees))
    assert 100.0 * slope * rad(1.0) / 425.0 == pytest.approx(percent, abs=0.012)
    gyro, step = table_gyro(), 1e-5
    numeric = (
        tracking_period_s(gyro, rad(degrees) + step) - tracking_period_s(gyro, rad(degrees) - step)
    ) / (2 * step)
    slope = tracking_period_latitude_slope(tracking_period_s(gyro, rad(degrees)), rad(degrees))
    # M/P ~ 1e-5 makes J_eff depend on latitude by parts in 1e5, which the simple law leaves out
    assert slope == pytest.approx(numeric, rel=1e-4)


@pytest.mark.parametrize("to_degrees", [0.0, -26.0, 30.0, 63.0, 75.0])
def test_transfer_of_periods_meets_the_periods_there(to_degrees: float) -> None:
    gyro, here, there = table_gyro(), rad(47), rad(to_degrees)
    tracking = Estimate(tracking_period_s(gyro, here), 0.2)
    clamped = Estimate(clamped_period_s(gyro, here), 0.2)
    moved = transfer_tracking_period(tracking, latitude=here, to_latitude=there)
    assert moved.value == pytest.approx(tracking_period_s(gyro, there), rel=1e-5)
    moved = transfer_clamped_period(clamped, tracking, latitude=here, to_latitude=there)
    assert moved.value == pytest.approx(clamped_period_s(gyro, there), rel=1e-5)


def test_sigma_of_transferred_values_against_monte_carlo() -> None:
    rng = np.random.default_rng(20)
    here, there, runs = rad(47), rad(63), 4000
    t1 = 425.4 + 0.5 * rng.normal(size=runs)
    t2 = 388.3 + 0.5 * rng.normal(size=runs)
    first, second = Estimate(425.4, 0.5), Estimate(388.3, 0.5)

    def spread(function: Callable[[Estimate, Estimate], float]) -> float:
        return float(
            np.std([function(Estimate(a, 0), Estimate(b, 0)) for a, b in zip(t1, t2, strict=True)])
        )

    bound = 3.0 / math.sqrt(2 * runs)
    moved = transfer_clamped_period(second, first, latitude=here, to_latitude=there)
    sampled = spread(
        lambda a, b: transfer_clamped_period(b, a, latitude=here, to_latitude=there).value
    )
    assert moved.sigma == pytest.approx(sampled, rel=bound + 0.01)
    ratio = torsion_ratio_from_periods(first, second)
    assert ratio.sigma == pytest.approx(
        spread(lambda a, b: torsion_ratio_from_periods(a, b).value), rel=bound + 0.01
    )
    assert ratio.sigma == pytest.approx(
        2 * (1 + ratio.value) * math.hypot(0.5 / 425.4, 0.5 / 388.3), rel=1e-12
    )
    coefficient = transit_coefficient_from_periods(first, second, scale_value=600.0)
    sampled = spread(lambda a, b: transit_coefficient_from_periods(a, b, scale_value=600.0).value)
    assert coefficient.sigma == pytest.approx(sampled, rel=bound + 0.01)


def test_transit_coefficient_sigma_after_transfer_is_the_derivative() -> None:
    here, there = rad(47), rad(-63)
    coefficient, ratio = Estimate(2.91, 0.02), Estimate(0.2, 0.01)
    moved = transfer_transit_coefficient(coefficient, ratio, latitude=here, to_latitude=there)
    step = 1e-6
    by_ratio = (
        transit_coefficient_ratio(0.2 + step, latitude=here, to_latitude=there)
        - transit_coefficient_ratio(0.2 - step, latitude=here, to_latitude=there)
    ) / (2 * step)
    gain = transit_coefficient_ratio(0.2, latitude=here, to_latitude=there)
    assert moved.sigma == pytest.approx(math.hypot(gain * 0.02, 2.91 * by_ratio * 0.01), rel=1e-8)


def test_transit_coefficient_elsewhere_from_the_periods_here() -> None:
    gyro, here, there = table_gyro(), rad(47), rad(-63)
    periods = [f(gyro, here) for f in (tracking_period_s, clamped_period_s)]

    def value(t1: float, t2: float) -> float:
        return transit_coefficient_at_latitude(
            Estimate(t1, 0.0),
            Estimate(t2, 0.0),
            scale_value=600.0,
            latitude=here,
            to_latitude=there,
        ).value

    expected = transit_coefficient_from_periods(
        Estimate(tracking_period_s(gyro, there), 0),
        Estimate(clamped_period_s(gyro, there), 0),
        scale_value=600.0,
    ).value
    assert value(*periods) == pytest.approx(expected, rel=2e-5)
    step = 1e-4
    slopes = [
        (value(periods[0] + step, periods[1]) - value(periods[0] - step, periods[1])) / (2 * step),
        (value(periods[0], periods[1] + step) - value(periods[0], periods[1] - step)) / (2 * step),
    ]
    sigma = transit_coefficient_at_latitude(
        Estimate(periods[0], 0.3),
        Estimate(periods[1], 0.2),
        scale_value=600.0,
        latitude=here,
        to_latitude=there,
    ).sigma
    assert sigma == pytest.approx(math.hypot(0.3 * slopes[0], 0.2 * slopes[1]), rel=1e-7)


def test_unspun_period_identity() -> None:
    """lambda = (J_z/J_eff) (T1/T0)^2."""
    gyro, latitude = table_gyro(), rad(47)
    inertia = gyro.vertical_inertia + gyro.angular_momentum**2 / (
        gyro.pendulosity + directive_moment(gyro, latitude)
    )
    ratio = gyro.vertical_inertia / inertia
    square = (tracking_period_s(gyro, latitude) / unspun_period_s(gyro)) ** 2
    assert ratio * square == pytest.approx(0.2, rel=1e-9)


def test_gyro_from_periods_gives_the_periods_back() -> None:
    gyro = gyro_from_periods(
        tracking_s=425.4, clamped_s=388.3, unspun_s=146.0, latitude=rad(-47), damping_ratio=0.002
    )
    assert tracking_period_s(gyro, rad(47)) == pytest.approx(425.4, rel=1e-12)
    assert clamped_period_s(gyro, rad(47)) == pytest.approx(388.3, rel=1e-12)
    assert unspun_period_s(gyro) == pytest.approx(146.0, rel=1e-12)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"clamped_s": 430.0}, "exchanged"),
        ({"unspun_s": 4000.0}, "T0 = 4000 s"),
        ({"latitude": math.pi / 2}, "pole"),
    ],
)
def test_impossible_periods_are_refused(change: dict[str, float], message: str) -> None:
    good = {"tracking_s": 425.4, "clamped_s": 388.3, "unspun_s": 146.0, "latitude": 0.8}
    with pytest.raises(ValueError, match=message):
        gyro_from_periods(**(good | change))


RATIO_TABLE = {
    0.05: (1.184, 1.151, 1.110, 1.052, 1, 0.975, 0.929, 0.879, 0.822, 0.759, 0.689),
    0.2: (1.116, 1.094, 1.068, 1.031, 1, 0.986, 0.961, 0.935, 0.911, 0.891, 0.884),
    0.3: (1.080, 1.064, 1.045, 1.020, 1, 0.991, 0.978, 0.966, 0.960, 0.965, 0.996),
    0.5: (1.024, 1.017, 1.009, 1.002, 1, 1.001, 1.005, 1.017, 1.041, 1.088, 1.183),
    0.8: (0.963, 0.966, 0.971, 0.983, 1, 1.011, 1.035, 1.072, 1.130, 1.226, 1.398),
}
RATIO_LATITUDES = (0, 20, 30, 40, 47, 50, 55, 60, 65, 70, 75)


@pytest.mark.parametrize("ratio", RATIO_TABLE)
def test_transit_coefficient_against_latitude_by_the_periods(ratio: float) -> None:
    """Table of C/C(47): once by the formula, once by C = (pi/2) mu T1^2/T2^3 of a gyro there."""
    torsion = ratio * 0.187 * EARTH_RATE * math.cos(rad(47))
    gyro = SuspendedGyro(0.187, 0.84, 1e-3, 1e-3, torsion)

    def by_periods(degrees: float) -> float:
        first = Estimate(tracking_period_s(gyro, rad(degrees)), 0.0)
        second = Estimate(clamped_period_s(gyro, rad(degrees)), 0.0)
        return transit_coefficient_from_periods(first, second, scale_value=1.0).value

    for degrees, expected in zip(RATIO_LATITUDES, RATIO_TABLE[ratio], strict=True):
        value = transit_coefficient_ratio(ratio, latitude=rad(47), to_latitude=rad(-degrees))
        # the table is cut, not rounded, in its third decimal
        assert value == pytest.approx(expected, abs=1e-3)
        assert by_periods(degrees) / by_periods(47) == pytest.approx(value, rel=3e-5)


def test_transit_coefficient_slope_is_the_derivative_and_changes_sign_at_one_half() -> None:
    for ratio in (0.05, 0.2, 0.5, 0.8):
        latitude, step = rad(50), 1e-5
        values = [
            transit_coefficient_ratio(ratio, latitude=latitude, to_latitude=latitude + d)
            for d in (-step, step)
        ]
        numeric = (math.log(values[1]) - math.log(values[0])) / (2 * step)
        slope = transit_coefficient_latitude_slope(ratio, latitude)
        assert slope == pytest.approx(numeric, abs=1e-8)
    assert transit_coefficient_latitude_slope(0.5, rad(50)) == 0.0


def test_transit_coefficient_check_numbers() -> None:
    for (t1, t2), expected in (((425, 388), 2.91), ((480, 400), 3.39)):
        value = transit_coefficient_from_periods(
            Estimate(t1, 0), Estimate(t2, 0), scale_value=600.0
        ).value
        assert value == pytest.approx(expected, abs=0.006)


def test_transit_coefficient_of_source_000_against_latitude() -> None:
    """c/(pi/2) for mu = 1: .001876 .001875 .001910 .002072 .002477 at 0 35 50 65 75 degrees."""
    torsion = 0.45 * 0.4 * EARTH_RATE
    gyro = SuspendedGyro(0.4, 0.25, 1e-9, 1e-3, torsion)
    expected = (0.001876, 0.001875, 0.001910, 0.002072, 0.002477)
    for degrees, value in zip((0, 35, 50, 65, 75), expected, strict=True):
        t1 = Estimate(tracking_period_s(gyro, rad(degrees)), 0)
        t2 = Estimate(clamped_period_s(gyro, rad(degrees)), 0)
        c = transit_coefficient_from_periods(t1, t2, scale_value=1.0).value
        assert c / (math.pi / 2) == pytest.approx(value, abs=6e-7)


def test_two_clampings_recover_lambda_and_c() -> None:
    mu, ratio, north, zero = 600 * ARCSEC, 0.27, 0.4, 0.3
    clamps = [north + 700 * ARCSEC, north - 800 * ARCSEC]
    # north = clamp + (1 + lambda) mu B - lambda mu d
    centres = [(north - h + ratio * mu * zero) / ((1 + ratio) * mu) for h in clamps]
    found = torsion_ratio_from_clampings(
        (Estimate(clamps[0], ARCSEC), Estimate(clamps[1], ARCSEC)),
        (Estimate(centres[0], 0.01), Estimate(centres[1], 0.01)),
        scale_value=mu,
    )
    assert found.value == pytest.approx(ratio, rel=1e-10)
    span = 1500.0
    centre_part = (1 + ratio) * 600 * 0.01 * (1 + ratio) / span
    expected = math.sqrt(2) * math.hypot((1 + ratio) / span, centre_part)
    assert found.sigma == pytest.approx(expected, rel=1e-6)
    with pytest.raises(ValueError, match="scale reversed"):
        torsion_ratio_from_clampings(
            (Estimate(clamps[0], 0), Estimate(clamps[1], 0)),
            (Estimate(centres[1], 0), Estimate(centres[0], 0)),
            scale_value=mu,
        )
    coefficient = 2.9 * ARCSEC
    products = [(north - h) / coefficient for h in clamps]
    found = transit_coefficient_from_clampings(
        (Estimate(clamps[0], ARCSEC), Estimate(clamps[1], ARCSEC)),
        (Estimate(products[0], 1.0), Estimate(products[1], 1.0)),
    )
    assert found.value == pytest.approx(coefficient, rel=1e-10)
    assert found.sigma / ARCSEC == pytest.approx(
        math.sqrt(2) * math.hypot(1.0, 2.9) * 2.9 / 1500.0, rel=1e-9
    )


def test_card_values_are_held_against_the_periods() -> None:
    mu = 600 * ARCSEC
    check_torsion_ratio(0.205, tracking_s=425.4, clamped_s=388.3)
    with pytest.raises(ValueError, match=r"5\.0000 .*0\.2002"):
        check_torsion_ratio(5.0, tracking_s=425.4, clamped_s=388.3)
    check_transit_coefficient(2.95 * ARCSEC, scale_value=mu, tracking_s=425.4, clamped_s=388.3)
    for factor, words in ((1 / 60, "minutes of arc"), (2.0, "half swings"), (1 / 3.24, "mgon")):
        with pytest.raises(ValueError, match=rf"2\.913.*{words}"):
            check_transit_coefficient(
                2.913 * factor * ARCSEC, scale_value=mu, tracking_s=425.4, clamped_s=388.3
            )
    with pytest.raises(ValueError, match="exchanged"):
        torsion_ratio_from_periods(Estimate(388.3, 0), Estimate(425.4, 0))


def test_transferred_lambda_is_that_of_the_gyro_there() -> None:
    gyro = table_gyro()
    there = transfer_torsion_ratio(Estimate(0.2, 0.01), latitude=rad(47), to_latitude=rad(-60))
    assert there.value == pytest.approx(gyro.torsion / directive_moment(gyro, rad(60)), rel=1e-12)
    assert there.sigma / there.value == pytest.approx(0.05)
    # the figure of an unscaled lambda on a tape zero of half a division
    assert (there.value - 0.2) * 0.5 * 600.0 == pytest.approx(22.0, abs=0.3)


PERIODS: dict[Literal["tracking", "clamped"], Callable[[SuspendedGyro, float], float]] = {
    "tracking": tracking_period_s,
    "clamped": clamped_period_s,
}
