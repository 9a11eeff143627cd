"""Attitudes, quaternions and the table against facts that a surveyor can check by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from surveyapp_models.constants import EARTH_RATE
from surveyapp_models.rate import quaternions
from surveyapp_models.rate.attitude import attitude_matrix, earth_rate, euler_angles, sensed
from surveyapp_models.rate.fog_station import FogOnTelescope
from surveyapp_models.rate.turntable import POSITIONS, Table, profile, seat


def test_heading_is_clockwise_and_a_body_that_looks_east_has_its_y_axis_east() -> None:
    east = attitude_matrix(heading=math.radians(90.0))
    np.testing.assert_allclose(east @ [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], atol=1e-15)
    np.testing.assert_allclose(east @ [1.0, 0.0, 0.0], [0.0, -1.0, 0.0], atol=1e-15)


def test_nose_up_is_positive_pitch_and_right_side_down_is_positive_roll() -> None:
    up = attitude_matrix(heading=0.3, pitch=0.2)
    assert (up @ [0.0, 1.0, 0.0])[2] == pytest.approx(math.sin(0.2))
    right_down = attitude_matrix(heading=0.3, roll=0.2)
    assert (right_down @ [1.0, 0.0, 0.0])[2] == pytest.approx(-math.sin(0.2))


def test_euler_angles_come_back_from_quaternions() -> None:
    rng = np.random.default_rng(1)
    for _ in range(50):
        heading, pitch, roll = rng.uniform(0, 6.28), rng.uniform(-1.4, 1.4), rng.uniform(-3, 3)
        q = quaternions.from_matrix(attitude_matrix(heading=heading, pitch=pitch, roll=roll))
        found = euler_angles(quaternions.to_matrix(q))
        np.testing.assert_allclose(found, (heading, pitch, roll), atol=1e-12)


def test_integration_is_exact_for_a_constant_rate_where_the_first_order_step_is_not() -> None:
    """Sensors.md 2c: 60 s at 100 Hz and 21.5 deg/s, first order |q| = 1.0106."""
    rate = np.array([0.2, -0.1, 0.3]) * math.radians(21.5) / math.sqrt(0.14)
    found = quaternions.integrate(np.tile(rate, (6000, 1)), interval_s=0.01)[-1]
    exact = quaternions.from_rotation_vector(rate * 60.0)
    np.testing.assert_allclose(found * np.sign(found @ exact), exact, atol=1e-12)
    q = np.array([1.0, 0.0, 0.0, 0.0])
    for _ in range(6000):
        q = q + 0.005 * quaternions.multiply(q, np.array([0.0, *rate]))
    assert math.sqrt(float(q @ q)) == pytest.approx(1.0106, abs=2e-4)


@pytest.mark.parametrize("count", [0, 1, 2, 3, 97, 1000])
def test_integration_of_any_number_of_samples_is_the_plain_product(count: int) -> None:
    rates = np.random.default_rng(2).normal(0.0, 1.0, (count, 3))
    found = quaternions.integrate(rates, interval_s=0.1)
    q = np.array([1.0, 0.0, 0.0, 0.0])
    for rate in rates:
        q = quaternions.multiply(q, quaternions.from_rotation_vector(rate * 0.1))
    assert found.shape == (count + 1, 4)
    np.testing.assert_allclose(found[-1], q, atol=1e-12)


def test_a_body_at_rest_at_the_pole_and_at_the_equator_feels_the_earth() -> None:
    level = quaternions.from_matrix(np.eye(3))
    pole, force = sensed(level, latitude=math.pi / 2)
    np.testing.assert_allclose(pole, [0.0, 0.0, EARTH_RATE], atol=1e-20)
    np.testing.assert_allclose(force, [0.0, 0.0, 9.80665])
    equator, _ = sensed(level, latitude=0.0)
    np.testing.assert_allclose(equator, [0.0, EARTH_RATE, 0.0], atol=1e-20)
    assert np.degrees(EARTH_RATE) * 3600 == pytest.approx(15.041, abs=1e-3)


@pytest.mark.parametrize("position", POSITIONS)
def test_an_axis_that_points_up_reads_minus_the_clockwise_rate(position: str) -> None:
    table = Table(latitude=math.radians(45.0))
    angles = profile(np.full(3600, math.radians(20.0)), interval_s=0.05)
    rates, forces = table.motion(angles, interval_s=0.05, mount=seat(position))
    axis, sign = "xyz".index(position[0]), 1.0 if position[1] == "+" else -1.0
    vertical = EARTH_RATE * math.sin(math.radians(45.0))
    expected = np.zeros(3)
    expected[axis] = sign * (vertical - math.radians(20.0))
    np.testing.assert_allclose(rates.mean(axis=0), expected, atol=1e-12)  # ten whole turns
    assert forces[0, axis] == pytest.approx(sign * 9.80665)


def test_a_gyro_on_a_telescope_sees_the_table_by_the_sine_of_its_elevation() -> None:
    fog = FogOnTelescope(constant=3.0)
    assert fog.axis(2.9)[2] == pytest.approx(math.sin(0.1))  # the reading increases downwards
    assert FogOnTelescope(constant=3.0, reading_increases=False).axis(3.1)[2] == pytest.approx(
        math.sin(0.1)
    )
    turned = FogOnTelescope(constant=3.0, collimation=0.01).axis(3.0 + math.pi)
    np.testing.assert_allclose(turned, [math.sin(0.01), -math.cos(0.01), 0.0], atol=1e-15)


def test_the_level_gyro_pointing_north_reads_the_level_earth_rate() -> None:
    latitude = math.radians(35.0)
    rate = FogOnTelescope(constant=1.0).at_rest(reading=1.0, alidade_azimuth=0.0, latitude=latitude)
    assert rate == pytest.approx(earth_rate(latitude)[1])
