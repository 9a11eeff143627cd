"""The forecast holds what the next turning point does, and the alarm rings as often as it says."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.stats import binom

from surveyapp.core.observing.forecast import fit_timing, forecast_reading
from surveyapp.core.observing.run_alert import Trouble, channels, find_trouble
from surveyapp.core.swing.gyrofit import fit_damped_swing

AMPLITUDE, DECREMENT = 3600.0, 0.012
RUNS, ALARMED = 250, 60


def run(n: int, rng: np.random.Generator, sigma: float = 5.0) -> tuple[np.ndarray, ...]:
    index = np.arange(n, dtype=np.float64)
    sides = np.where(index % 2 == 0, 1.0, -1.0)
    values = AMPLITUDE * sides * np.exp(-DECREMENT * index) + rng.normal(scale=sigma, size=n)
    return values, index, sides


@pytest.mark.statistical
@pytest.mark.parametrize("n", [3, 4, 7, 12])
def test_interval_of_the_next_reading_holds_it_in_99_percent(n: int) -> None:
    rng = np.random.default_rng(20 + n)
    inside = 0
    for _ in range(RUNS):
        values, index, sides = run(n + 1, rng)
        reading, half = forecast_reading(
            values[:n], index[:n], sides[:n], next_index=n, sigma=5.0, dof=math.inf
        )
        assert reading is not None
        assert half is not None
        inside += abs(values[n] - reading) <= half
    # three points lean on the prior of the damping, which is wider than the truth here: the
    # interval may only be too wide
    assert inside >= int(binom.ppf(1e-3, RUNS, 0.99))
    assert n <= 4 or (half is not None and half < 2.576 * 5.0 * 1.6)


def test_two_points_already_tell_where_the_third_will_be() -> None:
    values, index, sides = run(4, np.random.default_rng(1), sigma=0.0)
    reading, half = forecast_reading(
        values[:2], index[:2], sides[:2], next_index=2, sigma=1.0, dof=math.inf
    )
    assert reading is not None
    assert half is not None
    assert abs(reading - values[2]) < half < 400.0
    late, half_late = forecast_reading(
        values[:2], index[:2], sides[:2], next_index=3, sigma=1.0, dof=math.inf
    )
    assert late is not None
    assert half_late is not None
    assert abs(late - values[3]) < half_late


def test_one_point_tells_no_reading_but_a_moment() -> None:
    nothing = forecast_reading(
        np.zeros(1), np.zeros(1), np.ones(1), next_index=1, sigma=1.0, dof=math.inf
    )
    assert nothing == (None, None)
    timing = fit_timing(np.zeros(1), np.array([100.0]), 425.0)
    assert timing is not None
    moment, sigma = timing.moment(1.0)
    assert moment == pytest.approx(100.0 + 212.5)
    assert 4.0 < sigma < 10.0


def test_moments_refine_the_period_of_the_card() -> None:
    index = np.arange(9, dtype=np.float64)
    timing = fit_timing(index, 50.0 + 215.0 * index, 425.0)
    assert timing is not None
    assert 2.0 * timing.half_period_s == pytest.approx(430.0, abs=0.2)
    moment, sigma = timing.moment(9.0)
    assert abs(moment - (50.0 + 215.0 * 9)) < 1.96 * sigma
    assert fit_timing(index[:1], np.array([5.0]), None) is None


@pytest.mark.statistical
def test_a_clean_run_seldom_alarms_at_any_time_of_its_length() -> None:
    rng = np.random.default_rng(8)
    alarms = 0
    for _ in range(ALARMED):
        values, index, sides = run(20, rng)
        alarms += any(
            find_trouble(fit_damped_swing(values[:n], index[:n], sides[:n]), index[:n], sides[:n])
            is not None
            for n in range(6, 21)
        )
    # at most 5 % by Ville's inequality, .022 in the reference
    assert alarms <= int(binom.ppf(0.99, ALARMED, 0.05))


@pytest.mark.parametrize(
    ("trouble", "disturb"),
    [
        (Trouble.GROSS_ERROR, lambda k, s: 120.0 * (k == 6)),
        (Trouble.STEP, lambda k, s: 60.0 * (k >= 7)),
        (Trouble.DAMPING, lambda k, s: -25.0 * s * np.maximum(k - 7, 0.0)),
        (Trouble.DRIFT, lambda k, s: 6.0 * k),
        (Trouble.WARM_UP, lambda k, s: 120.0 * np.exp(-k / 2.0)),
    ],
)
def test_each_trouble_is_called_by_its_name(trouble: Trouble, disturb: object) -> None:
    rng = np.random.default_rng(3)
    values, index, sides = run(14, rng)
    values = values + disturb(index, sides)  # type: ignore[operator]
    found = find_trouble(fit_damped_swing(values, index, sides), index, sides)
    assert found is not None
    assert found[0] is trouble
    assert found[3] >= 0.5
    if trouble not in (Trouble.DRIFT, Trouble.WARM_UP):
        assert abs(found[1] - 7) <= 1


def test_a_step_shows_in_the_midpoint_and_decay_in_the_amplitude() -> None:
    sides = np.array([1.0, -1.0, 1.0, -1.0])
    midpoint, amplitude = channels(np.full(4, 3.0), sides)
    assert midpoint.tolist() == [3.0, 3.0, 3.0]
    assert amplitude.tolist() == [0.0, 0.0, 0.0]
    midpoint, amplitude = channels(2.0 * sides, sides)
    assert midpoint.tolist() == [0.0, 0.0, 0.0]
    assert amplitude.tolist() == [2.0, 2.0, 2.0]
