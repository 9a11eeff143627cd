"""The inertial path in stretches against the same filter one sample after the other."""

from __future__ import annotations

import math
import time

import numpy as np
import pytest

from surveyapp.core.sensors.rate import zero_velocity
from surveyapp.core.sensors.rate.rests import Rests
from surveyapp.core.sensors.rate.strapdown import Navigation, integrate, noise_of_all
from surveyapp.core.sensors.rate.zero_velocity import BOUND, EVERY, in_memory, inertial_path
from surveyapp.core.simulate.rate.vehicle import VehicleRun, usual_drive, vehicle_log
from surveyapp_models.arrays import Floats
from surveyapp_models.rate import quaternions
from surveyapp_models.rate.triad import Triad

DT = 0.01


def cross(v: Floats) -> Floats:
    """Matrix of the cross product."""
    x, y, z = v
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def one_by_one(
    force: Floats, rate: Floats, still: np.ndarray, noises: tuple[Floats, Floats]
) -> tuple[Floats, Floats, int]:
    """Places, last covariance, innovations beyond the bound: the plain recursion."""
    rest = slice(0, int(np.argmin(still)))
    bias, felt = rate[rest].mean(axis=0), force[rest].mean(axis=0)
    up = felt / np.linalg.norm(felt)
    ahead = np.array([0.0, 1.0, 0.0]) - up * up[1]
    ahead /= np.linalg.norm(ahead)
    c = np.vstack([np.cross(ahead, up), ahead, up])
    gravity = np.array([0.0, 0.0, np.linalg.norm(felt)])
    v, p = np.zeros(3), np.zeros(3)
    cov = np.diag([1e-8] * 3 + [1e-6] * 3 + [1e-5, 1e-5, 1e-8])
    places, beyond = np.empty(force.shape), 0
    for k in range(still.size):
        c = c @ quaternions.to_matrix(quaternions.from_rotation_vector((rate[k] - bias) * DT))
        change = (c @ force[k] - gravity) * DT
        step = np.eye(9)
        step[:3, 3:6] = DT * np.eye(3)
        step[3:6, 6:] = -cross(c @ force[k]) * DT
        p, v = p + (v + 0.5 * change) * DT, v + change
        cov = step @ cov @ step.T + noises[int(not still[k])]
        if still[k] and k % EVERY == 0:
            inverse = np.linalg.inv(cov[3:6, 3:6] + 1e-6 * np.eye(3))
            beyond += float(v @ inverse @ v) > BOUND
            gain = cov[:, 3:6] @ inverse
            error = -gain @ v
            p, v = p + error[:3], v + error[3:6]
            turn = quaternions.to_matrix(quaternions.from_rotation_vector(error[6:]))
            c, cov = turn @ c, cov - gain @ cov[3:6]
        places[k] = p
    return places, cov[:3, :3], beyond


def noise(velocity: float, turn: float) -> Floats:
    """What a sample adds."""
    return np.diag([0.0] * 3 + [velocity**2 * DT] * 3 + [turn**2 * DT] * 3)


def test_stretches_are_the_plain_recursion() -> None:
    """A drive with two rests: places, covariance and test to a hundredth of their own sigma."""
    run = VehicleRun(
        usual_drive(1),
        gyro=Triad(bias=np.array([2e-3, -1e-3, 1e-3]), noise=1e-4),
        accelerometer=Triad(noise=1e-3),
        shake=0.05,
    )
    log = vehicle_log(run, np.random.default_rng(3))
    force = np.column_stack([log.columns[f"acc_{a}_m_s2"] for a in "xyz"])[500:]
    rate = np.column_stack([log.columns[f"gyr_{a}_rad_s"] for a in "xyz"])[500:]
    still = np.array(
        [leg.state == "stationary" for leg in run.legs for _ in range(int(leg.seconds * 100))]
    )
    still = still[500:]
    shaken = [
        float(np.sqrt(np.var(np.diff(each[~still], axis=0), axis=0).max() / 2.0 * DT))
        for each in (force, rate)
    ]
    least = 1e-3, math.radians(0.01)
    noises = noise(*least), noise(max(least[0], shaken[0]), max(least[1], shaken[1]))
    places, covariance, beyond = one_by_one(force, rate, still, noises)
    found = inertial_path(in_memory(force, rate), Rests.of(still), interval_s=DT)
    sigma = math.sqrt(float(covariance[0, 0]))
    assert np.abs(places[found.rows] - found.place).max() < 0.01 * sigma
    np.testing.assert_allclose(found.end, places[-1], atol=0.01 * sigma)
    np.testing.assert_allclose(found.covariance, covariance, rtol=0.01, atol=0.01 * sigma**2)
    assert found.exceeding == pytest.approx(beyond / found.updates)
    first, last = places[still][:500], places[still][500:]
    np.testing.assert_allclose(found.stops[0], np.median(first, axis=0), atol=0.01 * sigma)
    np.testing.assert_allclose(found.stops[-1], np.median(last, axis=0), atol=0.01 * sigma)


def test_the_noise_of_many_samples_is_the_sum_of_each() -> None:
    """Against the transition and the noise of one sample at a time."""
    rng = np.random.default_rng(1)
    force = rng.normal(0.0, 3.0, (40, 3)) + np.array([0.0, 0.0, 9.8])
    rate = rng.normal(0.0, 0.3, (40, 3))
    start = Navigation(np.array([1.0, 0.0, 0.0, 0.0]), np.zeros(3), np.zeros(3), np.zeros((9, 9)))
    stretch = integrate(start, force, rate, gravity=9.8, interval_s=DT)
    covariance = np.zeros((9, 9))
    for k in range(40):
        step = stretch.transitions(np.array([k]), np.array([k + 1]))[0]
        covariance = step @ covariance @ step.T + np.diag([0.0] * 3 + [4.0] * 3 + [0.25] * 3)
    whole = noise_of_all(stretch, velocity=4.0, turn=0.25)
    np.testing.assert_allclose(whole, covariance, rtol=1e-9, atol=1e-9 * covariance.max())


def test_a_long_record_takes_some_microseconds_a_sample(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ten minutes at 100 Hz; one sample after the other takes a hundred microseconds each."""
    monkeypatch.setattr(zero_velocity, "MOST_POINTS", 100)
    rng = np.random.default_rng(2)
    still = np.arange(60_000) % 20_000 < 3_000
    force = rng.normal(0.0, 0.01, (still.size, 3)) + np.array([0.0, 0.0, 9.8])
    rate = rng.normal(0.0, 1e-3, (still.size, 3))
    begin = time.process_time()
    found = inertial_path(in_memory(force, rate), Rests.of(still), interval_s=DT)
    assert time.process_time() - begin < 60_000 * 40e-6
    assert found.rows.size <= 100
    assert found.length - found.along[-1] < 0.05 * found.length
    assert np.all(np.diff(found.along) > 0.0)
