"""A seeded subset of the operating characteristics, inside binomial bounds.

The reference figures are those of the specification (another implementation, another generator).
A line fails when chance would explain the difference less often than once in a thousand.
"""

from __future__ import annotations

import pytest
from scipy.stats import binom

from bench._records import CampaignTruth, Truth
from bench.operating_characteristics import Line, evaluate, evaluate_campaign

DRAWS = 500
ONCE_IN = 1e-3
pytestmark = pytest.mark.statistical


def at_least(share: float, expected: float, runs: int) -> bool:
    return round(share * runs) >= int(binom.ppf(ONCE_IN, runs, expected))


def at_most(share: float, expected: float, runs: int) -> bool:
    return round(share * runs) <= int(binom.ppf(1.0 - ONCE_IN, runs, expected))


@pytest.mark.parametrize(("size", "rounding"), [(12, 0.1), (12, 10.0), (20, 0.1), (45, 0.1)])
def test_pure_noise_raises_an_alarm_as_often_as_stated(size: int, rounding: float) -> None:
    line = evaluate(Truth("none", size, rounding=rounding), 30, 31, DRAWS)
    assert at_most(line.detected, 0.06, 30)
    assert at_most(line.wrong, 0.03, 30)
    assert at_least(line.covered, 0.95, 30)


LINES = [
    (Truth("drift 1", 20, "midpoint_drift", drift=1.0), 1.0, 0.54),
    (Truth("step 25", 20, "midpoint_step", step=25.0), 1.0, 1.0),
    (Truth("step 12", 20, "midpoint_step", step=12.0), 1.0, 0.62),
    (Truth("oscillation 35", 20, "secondary_oscillation", oscillation=35.0), 1.0, 0.96),
    (Truth("warm-up 70", 45, "warm_up", warm_up=70.0), 1.0, 1.0),
    (Truth("temperature 15/K", 20, "temperature", temperature=15.0), 1.0, 1.0),
    (Truth("dry friction 30", 20, "dry_friction", friction=30.0), 1.0, 0.96),
    (Truth("quadratic drag .8", 20, "quadratic_drag", drag=0.8), 1.0, 0.88),
    (Truth("gross error 60", 20, "gross_error", gross=(60.0,)), 1.0, 1.0),
    (Truth("three gross errors", 20, "gross_error", gross=(60.0,) * 3), 0.50, 0.46),
    (Truth("damping change", 20, "damping_break", damping_change=0.01), 1.0, 0.9),
]


@pytest.mark.parametrize(("truth", "detected", "right"), LINES, ids=[t[0].name for t in LINES])
def test_effects_are_found_named_and_the_result_is_covered(
    truth: Truth, detected: float, right: float
) -> None:
    runs = 10
    line = evaluate(truth, runs, 77, DRAWS)
    # 1.00 of the 24 runs of the reference is taken for 0.96 or more: they say no better.
    assert at_least(line.detected, min(detected, 0.96), runs)
    assert at_least(line.right, min(right, 0.96), runs)
    assert at_most(line.wrong, 0.06, runs)
    assert at_least(line.covered, 0.93, runs)


@pytest.mark.parametrize(
    "truth", [Truth("walk", 20, walk=9.0), Truth("ar1", 20, ar1=0.8), Truth("ar1", 45, ar1=0.5)]
)
def test_wandering_noise_ends_in_no_name(truth: Truth) -> None:
    line = evaluate(truth, 15, 5, DRAWS)
    assert at_most(line.wrong, 0.08, 15)


def test_the_mean_over_a_wandering_run_is_covered() -> None:
    # The open problem of the specification: .67 to .96 there.
    line: Line = evaluate(Truth("walk", 20, walk=9.0), 15, 6, DRAWS)
    assert at_least(line.covered, 0.95, 15)


def test_campaigns_of_correlated_noise_end_in_no_name() -> None:
    # the bench does so with 100 and 300 determinations, which take three times as long and more
    line = evaluate_campaign(CampaignTruth("ar1", 60, ar1=0.5), 12, 3, DRAWS)
    assert at_most(line.wrong, 0.05, 12)


def test_a_temperature_coefficient_of_a_campaign_is_named() -> None:
    truth = CampaignTruth("temperature", 45, "temperature", temperature=1.5)
    line = evaluate_campaign(truth, 12, 9, DRAWS)
    assert at_least(line.right, 0.9, 12)
    assert at_least(line.covered, 0.93, 12)
