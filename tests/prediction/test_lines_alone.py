"""A line is predicted as if it were the only one, whatever else is asked for."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
import pytest

from surveyapp.core.orientation.circumstances import Circumstances
from surveyapp.core.orientation.predicted_constant import (
    SCENARIOS,
    TOGETHER,
    PredictedConstants,
    predict_constants,
)
from surveyapp.core.orientation.prediction_notes import Wanted
from surveyapp.core.statistics.mixture import student
from surveyapp.core.uncertain import Uncertain
from surveyapp.domain.station_line import StationLine
from tests.prediction.test_if_it_drifts import determined

DAYS = [0.0, 20.0, 40.0, 60.0, 80.0, 100.0]
TOLD = {"elapsed_days": 7000.0, "temperature_c": 10.0}
CONSTANT, FACTS = determined(DAYS)


def wanted(told: Mapping[str, float], name: str = "B") -> Wanted:
    return Wanted(StationLine("A", name), ((1.0, Circumstances.of(told)),))


def numbers(found: PredictedConstants, place: int) -> list[float]:
    line, mean = found.lines[place], found.average
    own = [line.value, line.sigma, line.interval95, mean.value, mean.sigma, mean.interval95]
    return [*own, *(found.causes[name] for name in sorted(found.causes)), found.scatter.sigma]


@pytest.mark.parametrize(
    "other",
    [
        {"elapsed_days": 105.0, "temperature_c": 10.0},
        {"elapsed_days": 105.0, "temperature_c": 14.0},  # the first that is not at 10 C
        {"elapsed_days": 105.0},
        {"temperature_c": 10.0},
        {"elapsed_days": 105.0, "temperature_c": 10.0, "latitude": 0.9, "pressure_hpa": 900.0},
    ],
)
@pytest.mark.parametrize("count", [1, TOGETHER + 1])
def test_the_others_change_nothing(other: Mapping[str, float], count: int) -> None:
    """By up to 22 % of the interval they did; the last of many is of another part."""
    alone = numbers(predict_constants(CONSTANT, FACTS, [wanted(TOLD)]), 0)
    others = [wanted(other, f"C{k}") for k in range(count)]
    first = predict_constants(CONSTANT, FACTS, [wanted(TOLD), *others])
    last = predict_constants(CONSTANT, FACTS, [*others, wanted(TOLD)])
    assert numbers(first, 0) == pytest.approx(alone, rel=1e-9)
    assert numbers(last, count) == pytest.approx(alone, rel=1e-9)


def test_a_line_in_five_states_is_the_mean_of_its_states() -> None:
    """Of the 600 heaviest members alone its interval was 7 to 11 % too narrow."""
    g = np.random.default_rng(4)
    constant, facts = determined(DAYS)
    seen = g.uniform(0.0, 30.0, len(DAYS))  # wider than the least spread of what nobody told
    facts = {
        key: Circumstances.of({"elapsed_days": day, "temperature_c": t})
        for key, day, t in zip(facts, DAYS, seen, strict=True)
    }
    [open_] = predict_constants(constant, facts, [wanted({"elapsed_days": 130.0})]).lines
    states = [
        wanted({"elapsed_days": 130.0, "temperature_c": float(theta)}, f"{theta:.1f}")
        for theta in seen.mean() + seen.std() * np.array(SCENARIOS)
    ]
    lines = predict_constants(constant, facts, states).lines
    assert open_.value == pytest.approx(np.mean([line.value for line in lines]), rel=1e-9)
    inside = [within(line, open_.value, open_.interval95) for line in lines]
    assert np.mean(inside) == pytest.approx(0.95, abs=2e-4)


def within(line: Uncertain, centre: float, half: float) -> float:
    """Probability that the mixture of a line lies within ``half`` of ``centre``."""
    assert line.spread is not None
    mixture = line.spread.mixture
    readings = line.without(line.spread.name).sigma
    scale = np.sqrt(mixture.variances + readings**2)
    middle = line.value + mixture.offsets
    ends = [student((centre + sign * half - middle) / scale, mixture.dof)[0] for sign in (1, -1)]
    assert math.isfinite(mixture.dof)
    return float(mixture.weights @ (ends[0] - ends[1]))
