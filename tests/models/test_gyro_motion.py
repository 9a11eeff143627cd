"""The motion: closed form, two-axis and slow equation and brute force against each other."""

from __future__ import annotations

import dataclasses
import math
from typing import Literal

import numpy as np
import pytest

from surveyapp_models.gyro.coefficients import (
    north_error_of_spin_change,
    torsion_ratio_from_clampings,
    transit_coefficient_from_clampings,
    transit_coefficient_from_periods,
)
from surveyapp_models.gyro.estimates import Estimate
from surveyapp_models.gyro.integration import (
    Disturbance,
    Start,
    TapeTop,
    integrate,
    integrate_precession,
)
from surveyapp_models.gyro.moments import directive_moment, effective_inertia
from surveyapp_models.gyro.motion import (
    DampedSwing,
    Motion,
    clamped_swing,
    passage_times_s,
    passages,
    swing_position,
    swing_velocity,
    tracking_swing,
    turning_points,
    turning_times_s,
)
from surveyapp_models.gyro.periods import (
    clamped_period_s,
    mode_rates,
    period_at_amplitude_s,
    tracking_period_s,
)
from surveyapp_models.gyro.suspended import SuspendedGyro

ARCSEC = math.pi / 648000.0
LATITUDES = [0.0, 30.0, 47.0, 60.0, 75.0, -26.0, -75.0]


def rad(degrees: float) -> float:
    return math.radians(degrees)


def table_gyro(damping: float = 0.0) -> SuspendedGyro:
    torsion = 0.2 * 0.187 * 7.292115e-5 * math.cos(rad(47.0))
    return SuspendedGyro(0.187, 0.84, 1.0e-3, 1.0e-3, torsion, damping)


def start_of(swing: DampedSwing, time_s: float = 0.0) -> Start:
    position = np.atleast_1d(swing_position(swing, time_s))
    return Start(position, np.atleast_1d(swing_velocity(swing, time_s)), time_s)


@pytest.mark.parametrize("degrees", LATITUDES)
@pytest.mark.parametrize("mode", ["tracking", "clamped"])
def test_closed_form_and_integration_agree(
    degrees: float, mode: Literal["tracking", "clamped"]
) -> None:
    """Small swing (10'), damped: positions over five periods to 0.02", passages to 5 ms."""
    gyro, latitude = table_gyro(damping=3e-7), rad(degrees)
    amplitude, offset = 600 * ARCSEC, 300 * ARCSEC
    if mode == "tracking":
        swing = tracking_swing(gyro, latitude, amplitude=amplitude, phase=-0.7, tape_offset=offset)
        tape = TapeTop("tracking", zero=lambda t: offset)
    else:
        swing = clamped_swing(gyro, latitude, tape_azimuth=offset, amplitude=amplitude, phase=-0.7)
        tape = TapeTop("clamped", clamp=0.6 * offset, zero=lambda t: 0.4 * offset)
    motion = integrate(
        gyro,
        latitude,
        start_of(swing),
        duration_s=5 * swing.period_s,
        step_s=swing.period_s / 96,
        tape=tape,
    )
    error = motion.azimuth[:, 0] - swing_position(swing, motion.time_s)
    assert np.max(np.abs(error)) < 0.02 * ARCSEC
    found = turning_points(motion, 9)
    assert np.allclose(found.time_s[0], turning_times_s(swing, 9), atol=5e-3)
    assert np.allclose(
        found.azimuth[0], swing_position(swing, turning_times_s(swing, 9)), atol=0.02 * ARCSEC
    )
    assert list(found.rising[0]) == [k % 2 == 0 for k in range(9)]
    line = swing.centre + 100 * ARCSEC
    crossed = passages(motion, line, 8)
    assert np.allclose(crossed.time_s[0], passage_times_s(swing, line, 8), atol=5e-3)


SIMULATED_PERIODS = [
    # latitude, T1 at 2 degrees of amplitude, T2: physics table from another integration
    (0.0, 351.333, 329.550),
    (30.0, 377.532, 350.882),
    (47.0, 425.430, 388.334),
    (60.0, 496.861, 440.376),
    (75.0, 690.594, 558.818),
]


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(("degrees", "tracking", "clamped"), SIMULATED_PERIODS)
def test_periods_of_the_integrated_motion(
    degrees: float, tracking: float, clamped: float, sign: float
) -> None:
    gyro, latitude = table_gyro(), rad(sign * degrees)
    for mode, expected, formula, amplitude in (
        ("tracking", tracking, tracking_period_s, rad(2.0)),
        ("clamped", clamped, clamped_period_s, rad(0.25)),
    ):
        period = formula(gyro, latitude)
        motion = integrate(
            gyro,
            latitude,
            Start(np.array([amplitude]), np.array([0.0])),
            duration_s=4.6 * period,
            step_s=period / 96,
            tape=TapeTop("tracking" if mode == "tracking" else "clamped"),
        )
        times = turning_points(motion, 9).time_s[0]
        measured = (times[-1] - times[0]) / 4.0
        assert measured == pytest.approx(expected, abs=2e-3)
        moment = directive_moment(gyro, latitude)
        share = 1.0 if mode == "tracking" else moment / (moment + gyro.torsion)
        corrected = period_at_amplitude_s(period, amplitude=amplitude, stiffness_share=share)
        assert measured == pytest.approx(corrected, rel=4e-7)


def test_two_axis_and_slow_equation_agree_with_every_disturbance() -> None:
    gyro, latitude = table_gyro(damping=2e-6), rad(-47)
    moment = directive_moment(gyro, latitude)
    inertia = effective_inertia(gyro, latitude)
    disturbance = Disturbance(
        torque=lambda t: moment * 60 * ARCSEC * (math.cos(t / 700.0) + t / 3000.0),
        damping=lambda t: 2e-6 + 1e-6 * math.tanh((t - 900.0) / 200.0),
        quadratic_drag=0.01 * inertia,
        dry_friction=0.5 * moment * 20 * ARCSEC,
        asymmetry=moment * 0.02,
    )
    start = Start(np.array([rad(2.0), rad(1.0)]), np.zeros(2))
    period = tracking_period_s(gyro, latitude)
    for tape in (
        TapeTop("tracking", lag=30 * ARCSEC, eastward_lag=20 * ARCSEC, delay_s=2.0),
        TapeTop("clamped", clamp=300 * ARCSEC, zero=lambda t: 0.01 * ARCSEC * t),
    ):
        both = [
            turning_points(
                solve(
                    gyro,
                    latitude,
                    start,
                    duration_s=5 * period,
                    step_s=period / 200,
                    tape=tape,
                    disturbance=disturbance,
                ),
                8,
            )
            for solve in (integrate, integrate_precession)
        ]
        difference = both[0].azimuth - both[1].azimuth
        assert np.max(np.abs(difference)) < 0.1 * ARCSEC
        assert np.max(np.abs(both[0].time_s - both[1].time_s)) < 0.02


def test_exponential_step_against_brute_force_with_nutation() -> None:
    """A third of a swing by the classical method in 1 ms steps of the whole equation, sine and all.

    Nutation at 30 Hz takes 30 steps; the exponential step of 4 s spans 120 of its periods.
    """
    gyro, latitude = table_gyro(damping=2e-6), rad(60)
    moment = directive_moment(gyro, latitude)
    inertia, elevation = gyro.vertical_inertia, gyro.elevation_inertia
    spin, stiffness = gyro.angular_momentum, gyro.pendulosity + moment

    def slope(a: float, v: float, b: float, u: float) -> tuple[float, float, float, float]:
        return (
            v,
            (spin * u - gyro.damping * v - moment * math.sin(a)) / inertia,
            u,
            (-spin * v - stiffness * b) / elevation,
        )

    a, v = rad(2.0), 1.0e-5
    slow = effective_inertia(gyro, latitude)
    b = -spin * v / stiffness
    u = -spin / stiffness * (-moment * a - gyro.damping * v + moment * (a - math.sin(a))) / slow
    h, count = 1.0e-3, 120_000
    state = (a, v, b, u)
    for _ in range(count):
        k1 = slope(*state)
        k2 = slope(*(x + 0.5 * h * k for x, k in zip(state, k1, strict=True)))
        k3 = slope(*(x + 0.5 * h * k for x, k in zip(state, k2, strict=True)))
        k4 = slope(*(x + h * k for x, k in zip(state, k3, strict=True)))
        steps = zip(state, k1, k2, k3, k4, strict=True)
        first, second, third, fourth = (
            x + h / 6 * (p + 2 * q + 2 * r + s) for x, p, q, r, s in steps
        )
        state = (first, second, third, fourth)
    motion = integrate(
        gyro, latitude, Start(np.array([a]), np.array([v])), duration_s=120.0, step_s=4.0
    )
    assert motion.time_s[-1] == pytest.approx(120.0)
    assert motion.azimuth[-1, 0] == pytest.approx(state[0], abs=1e-3 * ARCSEC)


def test_step_width_converges() -> None:
    gyro, latitude = table_gyro(damping=2e-6), rad(47)
    period = tracking_period_s(gyro, latitude)
    start = Start(np.array([rad(5.0)]), np.zeros(1))
    fine, coarse = (
        turning_points(
            integrate(gyro, latitude, start, duration_s=10.6 * period, step_s=period / n),
            20,
        ).azimuth
        for n in (384, 96)
    )
    assert np.max(np.abs(fine - coarse)) < 5e-3 * ARCSEC


def test_nutation_rate_stays_out_of_the_slow_velocity() -> None:
    """A torque switched on at once excites nutation; turning points must not multiply."""
    gyro, latitude = table_gyro(), rad(47)
    moment, period = directive_moment(gyro, latitude), tracking_period_s(gyro, latitude)
    kick = Disturbance(torque=lambda t: moment * 600 * ARCSEC * (t > 1.25 * period))
    motion = integrate(
        gyro,
        latitude,
        Start(np.array([rad(1.0)]), np.zeros(1)),
        duration_s=4.2 * period,
        step_s=period / 96,
        disturbance=kick,
    )
    times = turning_points(motion, 8).time_s[0]
    gaps = np.diff(times)
    # the change comes at a passage: that half swing is as long as the others but for the kick
    assert np.all(np.abs(gaps - 0.5 * period) < 0.06 * period)
    assert mode_rates(gyro, latitude, clamped=False).nutation > 1e4 * math.pi / period


# --- table 1.4: transit, tape zero -------------------------------------------------------------


def clamped_run(
    clamp: float, amplitude_div: float, zero_div: float = 0.0
) -> tuple[SuspendedGyro, float, Motion, float, float]:
    gyro, latitude = table_gyro(), rad(47)
    period, mu = clamped_period_s(gyro, latitude), 600 * ARCSEC
    tape = TapeTop("clamped", clamp=clamp, zero=lambda t: mu * zero_div)
    ratio = gyro.torsion / directive_moment(gyro, latitude)
    centre = ratio / (1 + ratio) * (clamp + mu * zero_div)
    start = Start(np.array([centre + amplitude_div * mu]), np.zeros(1), 0.0)
    motion = integrate(gyro, latitude, start, duration_s=3 * period, step_s=period / 192, tape=tape)
    return gyro, latitude, motion, mu, ratio


def test_transit_linearisation_and_arcsine() -> None:
    """Clamp 10' off, a = 7.2 div, lambda = 0.2: linear 601.3", exact sine 600.0"."""
    gyro, latitude, motion, mu, ratio = clamped_run(-600 * ARCSEC, 7.2)
    t1, t2 = tracking_period_s(gyro, latitude), clamped_period_s(gyro, latitude)
    times = passages(motion, -600 * ARCSEC, 3)
    first, second = np.diff(times.time_s[0])
    difference = first - second if times.rising[0, 0] else second - first  # east minus west
    scale = (turning_points(motion, 4).azimuth[0] + 600 * ARCSEC) / mu
    amplitude = np.mean(np.abs(np.diff(scale))) / 2
    assert amplitude == pytest.approx(7.2, abs=1e-3)
    c = transit_coefficient_from_periods(Estimate(t1, 0), Estimate(t2, 0), scale_value=mu).value
    linear = c * amplitude * difference / ARCSEC
    sine = (1 + ratio) * mu * amplitude * math.sin(math.pi * difference / (2 * t2)) / ARCSEC
    assert linear == pytest.approx(601.3, abs=0.15)
    assert sine == pytest.approx(600.0, abs=0.05)
    share = (math.pi * difference / (2 * t2)) ** 2 / 6
    assert linear / sine - 1 == pytest.approx(share, rel=0.02)


def test_transit_against_offset_of_source_000() -> None:
    """Offsets 60" to 1800": the linear formula grows wrong, the arcsine form does not."""
    gyro = SuspendedGyro(0.4, 0.25, 1e-7, 1e-3, 0.45 * 0.4 * 7.292115e-5)
    latitude, mu = rad(35), 60 * ARCSEC
    t2 = clamped_period_s(gyro, latitude)
    ratio = gyro.torsion / directive_moment(gyro, latitude)
    for offset, tolerance in ((60, 0.02), (300, 0.02), (900, 0.05), (1800, 0.1)):
        clamp = -offset * ARCSEC
        centre = ratio / (1 + ratio) * clamp
        start = Start(np.array([centre + 60 * mu]), np.zeros(1))
        motion = integrate(
            gyro,
            latitude,
            start,
            duration_s=3 * t2,
            step_s=t2 / 192,
            tape=TapeTop("clamped", clamp=clamp),
        )
        crossed = passages(motion, clamp, 3)
        first, second = np.diff(crossed.time_s[0])
        difference = (first - second) * (1 if crossed.rising[0, 0] else -1)
        angle = math.pi * difference / (2 * t2)
        sine = (1 + ratio) * 60 * mu * math.sin(angle) / ARCSEC
        assert sine == pytest.approx(offset, abs=tolerance)
        assert (1 + ratio) * 60 * mu * angle / ARCSEC > sine


def test_tape_zero_check_numbers() -> None:
    """d = +0.4 div, clamp 8' off: non-tracking formula 480.00"; tracking +48.01" = lambda mu d."""
    _, _, motion, mu, ratio = clamped_run(-480 * ARCSEC, 3.0, zero_div=0.4)
    turns = turning_points(motion, 4).azimuth[0]
    scale = (turns + 480 * ARCSEC) / mu
    centre = (scale[0] + 3 * scale[1] + 3 * scale[2] + scale[3]) / 8
    found = (1 + ratio) * mu * centre - ratio * mu * 0.4
    assert found / ARCSEC == pytest.approx(480.00, abs=0.01)

    gyro, latitude = table_gyro(), rad(47)
    period = tracking_period_s(gyro, latitude)
    tracked = integrate(
        gyro,
        latitude,
        Start(np.array([rad(2.0)]), np.zeros(1)),
        duration_s=3 * period,
        step_s=period / 96,
        tape=TapeTop("tracking", zero=lambda t: 0.4 * 600 * ARCSEC),
    )
    turns = turning_points(tracked, 4).azimuth[0]
    mean = (turns[0] + 3 * turns[1] + 3 * turns[2] + turns[3]) / 8
    assert mean / ARCSEC == pytest.approx(48.01, abs=0.01)


def clamped_centre(
    gyro: SuspendedGyro, latitude: float, clamp: float, zero: float
) -> tuple[float, float]:
    """Centre of swing [div] and a dt [div s] of a clamping, from its motion; zero in rad."""
    period, mu = clamped_period_s(gyro, latitude), 600 * ARCSEC
    motion = integrate(
        gyro,
        latitude,
        Start(np.array([clamp + 7 * mu]), np.zeros(1)),
        duration_s=3 * period,
        step_s=period / 192,
        tape=TapeTop("clamped", clamp=clamp, zero=lambda t: zero),
    )
    x = (turning_points(motion, 4).azimuth[0] - clamp) / mu
    crossed = passages(motion, clamp, 3)
    first, second = np.diff(crossed.time_s[0])
    difference = first - second if crossed.rising[0, 0] else second - first
    return float((x[0] + 3 * x[1] + 3 * x[2] + x[3]) / 8), float(np.ptp(x[1:3]) / 2 * difference)


def test_two_clampings_of_the_integrated_motion_give_lambda_and_c() -> None:
    """12' east and 12' west with a tape zero: lambda of the tape, C of the periods."""
    gyro, latitude, mu = table_gyro(), rad(-60), 600 * ARCSEC
    clamps = (720 * ARCSEC, -720 * ARCSEC)
    (b1, p1), (b2, p2) = (clamped_centre(gyro, latitude, c, 0.3 * mu) for c in clamps)
    exact = [Estimate(c, 0.0) for c in clamps]
    found = torsion_ratio_from_clampings(
        (exact[0], exact[1]), (Estimate(b1, 0.0), Estimate(b2, 0.0)), scale_value=mu
    )
    true = gyro.torsion / directive_moment(gyro, latitude)
    # the sine softens M by A^2/8 at 70' of amplitude: 5e-5 of 1 + lambda
    assert found.value == pytest.approx(true, abs=6e-5)
    c = transit_coefficient_from_clampings(
        (exact[0], exact[1]), (Estimate(p1, 0.0), Estimate(p2, 0.0))
    )
    t1, t2 = tracking_period_s(gyro, latitude), clamped_period_s(gyro, latitude)
    expected = transit_coefficient_from_periods(Estimate(t1, 0), Estimate(t2, 0), scale_value=mu)
    # the linear form is (pi dt/2 T2)^2/6 off at 12'
    assert c.value == pytest.approx(expected.value, rel=4e-3)


def test_change_of_spin_moves_north_by_the_share_of_the_torsion() -> None:
    """One percent more spin, lambda as before: from the integrated motion and by formula."""
    mu, zero, clamp, latitude = 600 * ARCSEC, 0.4 * 600 * ARCSEC, 480 * ARCSEC, rad(47)
    base = table_gyro()
    faster = dataclasses.replace(base, angular_momentum=1.01 * base.angular_momentum)
    centre, _ = clamped_centre(faster, latitude, clamp, zero)
    north = clamp + 1.2 * mu * centre - 0.2 * zero
    expected = north_error_of_spin_change(
        0.2, spin_change=0.01, scale_value=mu, centre_div=centre, zero_div=0.4
    )
    assert north / ARCSEC == pytest.approx(expected / ARCSEC, abs=0.02)
    assert abs(expected) > 1.0 * ARCSEC


def test_amplitude_method_reaches_the_same_north_south_of_the_equator() -> None:
    mu = 600 * ARCSEC
    for degrees in (-60.0, 60.0):
        gyro, latitude = table_gyro(), rad(degrees)
        ratio = gyro.torsion / directive_moment(gyro, latitude)
        period = clamped_period_s(gyro, latitude)
        motion = integrate(
            gyro,
            latitude,
            Start(np.array([0.02]), np.zeros(1)),
            duration_s=3 * period,
            step_s=period / 96,
            tape=TapeTop("clamped", clamp=480 * ARCSEC, zero=lambda t: 0.4 * mu),
        )
        scale = (turning_points(motion, 4).azimuth[0] - 480 * ARCSEC) / mu
        centre = (scale[0] + 3 * scale[1] + 3 * scale[2] + scale[3]) / 8
        north = 480 * ARCSEC + (1 + ratio) * mu * centre - ratio * mu * 0.4
        assert north / ARCSEC == pytest.approx(0.0, abs=0.01)


# --- table 2.7: follow-up lag -----------------------------------------------------------------


def tracked(tape: TapeTop, count: int = 9) -> tuple[np.ndarray, np.ndarray]:
    gyro, latitude = table_gyro(), rad(47)
    period = tracking_period_s(gyro, latitude)
    motion = integrate(
        gyro,
        latitude,
        Start(
            np.array([rad(2.0) * math.cos(0.8)]),
            np.array([rad(2.0) * math.sin(0.8) * 2 * math.pi / period]),
        ),
        duration_s=0.5 * (count + 0.6) * period,
        step_s=period / 384,
        tape=tape,
    )
    turns = turning_points(motion, count)
    return turns.azimuth[0] / ARCSEC, turns.time_s[0]


def centre_and_loss(readings: np.ndarray) -> tuple[float, np.ndarray]:
    schuler = (readings[:-3] + 3 * readings[1:-2] + 3 * readings[2:-1] + readings[3:]) / 8
    return float(schuler.mean()), -np.diff(np.abs(np.diff(readings)) / 2)


def test_lag_both_ways_is_dry_friction() -> None:
    """eps = 60", lambda = .2: N unbiased, 24" of amplitude lost per half swing, linearly."""
    readings, times = tracked(TapeTop(lag=60 * ARCSEC))
    centre, loss = centre_and_loss(readings)
    assert centre == pytest.approx(0.0, abs=0.02)
    assert np.allclose(loss, 24.0, atol=0.1)
    gyro = table_gyro()
    period = period_at_amplitude_s(
        tracking_period_s(gyro, rad(47)), amplitude=rad(1.95), stiffness_share=1.0
    )
    assert np.mean(np.diff(times)) == pytest.approx(0.5 * period, abs=0.01)


def test_lag_one_way_shifts_north_by_half() -> None:
    """N shifts by lambda eps/2 = -6.0", 12" of amplitude lost per half swing."""
    centre, loss = centre_and_loss(tracked(TapeTop(eastward_lag=60 * ARCSEC))[0])
    assert centre == pytest.approx(-6.0, abs=0.05)
    assert np.allclose(loss, 12.0, atol=0.1)


def test_constant_offset_shifts_north_without_damping() -> None:
    """N shifts by lambda eps = 12.0"."""
    centre, loss = centre_and_loss(tracked(TapeTop(zero=lambda t: 60 * ARCSEC))[0])
    assert centre == pytest.approx(12.0, abs=0.01)
    assert np.allclose(loss, 0.0, atol=0.01)


def test_servo_delay_acts_as_viscous_damping() -> None:
    """A tape top that trails by delay times rate: ratio exp(-k T/2), k = D delay/2 J_eff."""
    gyro = table_gyro()
    readings, _ = tracked(TapeTop(delay_s=20.0))
    swing = np.abs(np.diff(readings))
    ratio = float(np.mean(swing[1:] / swing[:-1]))
    inertia, period = effective_inertia(gyro, rad(47)), tracking_period_s(gyro, rad(47))
    decay = gyro.torsion * 20.0 / (2 * inertia)
    rate = math.sqrt((2 * math.pi / period) ** 2 - decay**2)
    assert ratio == pytest.approx(math.exp(-decay * math.pi / rate), rel=2e-5)


def test_quadratic_drag_loses_four_thirds_of_the_squared_amplitude() -> None:
    gyro, latitude = table_gyro(), rad(47)
    inertia, period = effective_inertia(gyro, latitude), tracking_period_s(gyro, latitude)
    motion = integrate(
        gyro,
        latitude,
        Start(np.array([rad(2.0)]), np.zeros(1)),
        duration_s=3.7 * period,
        step_s=period / 96,
        disturbance=Disturbance(quadratic_drag=0.2 * inertia),
    )
    turns = np.abs(turning_points(motion, 6).azimuth[0])
    middle = np.sqrt(turns[1:] * turns[:-1])
    assert np.allclose((turns[:-1] - turns[1:]) / middle**2, 4.0 / 3.0 * 0.2, rtol=2e-3)


def test_asymmetric_stiffness_moves_the_midpoint_with_the_squared_amplitude() -> None:
    gyro, latitude = table_gyro(), rad(47)
    moment, period = directive_moment(gyro, latitude), tracking_period_s(gyro, latitude)
    for degrees in (1.0, 2.0):
        amplitude = rad(degrees)
        motion = integrate(
            gyro,
            latitude,
            Start(np.array([amplitude]), np.zeros(1)),
            duration_s=2.2 * period,
            step_s=period / 96,
            disturbance=Disturbance(asymmetry=0.02 * moment),
        )
        turns = turning_points(motion, 4).azimuth[0]
        centre = (turns[0] + turns[1]) / 2
        assert centre == pytest.approx(-0.02 * amplitude**2 / 3.0, rel=2e-3)


# --- refusals, derivatives ----------------------------------------------------------------------


def test_swing_velocity_is_the_derivative_of_the_position() -> None:
    swing = DampedSwing(0.3, 2.0, 1e-3, 0.015, 0.4)
    times, step = np.linspace(0.0, 900.0, 41), 1e-3
    numeric = (swing_position(swing, times + step) - swing_position(swing, times - step)) / (
        2 * step
    )
    assert np.allclose(swing_velocity(swing, times), numeric, atol=1e-9)
    assert np.allclose(swing_velocity(swing, turning_times_s(swing, 6)), 0.0, atol=1e-15)
    assert swing.ratio_per_half_swing == pytest.approx(
        math.exp(-1e-3 * swing.period_s / 2), rel=1e-12
    )


def test_what_does_not_happen_is_refused() -> None:
    swing = DampedSwing(0.0, 1.0, 0.0, 0.015, 0.0)
    with pytest.raises(ValueError, match="passes 2 only 0 times"):
        passage_times_s(swing, 2.0, 1)
    gyro = table_gyro()
    motion = integrate(
        gyro, 0.5, Start(np.array([0.01]), np.zeros(1)), duration_s=300.0, step_s=4.0
    )
    with pytest.raises(ValueError, match="4 are asked for"):
        turning_points(motion, 4)
    with pytest.raises(ValueError, match="passages"):
        passages(motion, 0.02, 1)
    with pytest.raises(ValueError, match="beyond the critical"):
        tracking_swing(table_gyro(damping=1.0), 0.5, amplitude=0.01)
