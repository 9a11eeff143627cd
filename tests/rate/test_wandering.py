"""How white a rest is, beside three gyros that are simulated without the program's simulator."""

from __future__ import annotations

import numpy as np
import pytest

from surveyapp.diagnosis.candidates import SHAPE_ODDS, all_candidates
from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.fits import Fit, Member, fit_members
from surveyapp.diagnosis.subjects.rate import RateStop, rate_case
from surveyapp.diagnosis.wandering import asked_of, whiteness
from surveyapp_models.arrays import Floats

STOPS = 16


def rests(outputs: Floats) -> Case:
    """Stops every six seconds in attitudes of their own."""
    forces = np.random.default_rng(5).normal(size=(STOPS, 3))
    forces *= 9.8 / np.linalg.norm(forces, axis=1)[:, None]
    return rate_case(
        [RateStop(output=w, elapsed_s=6.0 * k, force=forces[k]) for k, w in enumerate(outputs)],
        identity="unit",
    )


def with_ramp(case: Case) -> Fit:
    """The drift of each gyro fitted."""
    ramp = next(c for c in all_candidates(case, None) if c.id == "bias_ramp")
    return fit_members(case, [Member(ramp, 0)])


def test_whiteness_is_uniform_in_white_records_and_small_in_walks() -> None:
    """A p value: of 80 white records .05, .3, .6 of them fall below within 3.5 sigma."""
    rng = np.random.default_rng(11)
    cases = [rests(1e-4 * rng.normal(size=(STOPS, 3))) for _ in range(80)]
    found = np.array([whiteness(case, with_ramp(case), "random_walk") for case in cases])
    for level in (0.05, 0.3, 0.6):
        spread = 3.5 * np.sqrt(level * (1.0 - level) / found.size)
        assert abs(float(np.mean(found <= level)) - level) <= spread
    walks = [rests(1e-4 * np.cumsum(rng.normal(size=(STOPS, 3)), axis=0)) for _ in range(10)]
    # a walk as large as the noise of a stop, and no noise: never white
    assert max(whiteness(case, with_ramp(case), "random_walk") for case in walks) < 0.05


def test_a_shape_is_charged_beforehand_and_a_named_effect_is_not() -> None:
    """The BIC of a step is that of its residuals, its parameters and the odds against it."""
    case = rests(1e-4 * np.random.default_rng(3).normal(size=(STOPS, 3)))
    pool = {c.id: c for c in all_candidates(case, None)}
    assert pool["bias_ramp"].odds == pool["gross_error"].odds == 0.0
    fit = fit_members(case, [Member(pool["step"], 4)])
    n, p = case.size, fit.parameters
    plain = n * np.log(fit.sum_of_squares / n / case.scale**2) + p * np.log(n)
    assert fit.bic == pytest.approx(plain + SHAPE_ODDS)


def test_fewer_white_records_are_given_away_where_there_are_many_stops() -> None:
    """Eighteen stops and fewer: the whole share; from thirty on a third; between, in between."""
    found = [
        asked_of(
            rate_case(
                [RateStop(output=np.zeros(3), elapsed_s=6.0 * k) for k in range(count)],
                identity="unit",
            )
        )
        for count in (12, 18, 24, 30, 50)
    ]
    assert found[0] == found[1] == pytest.approx(1.0)
    assert found[3] == found[4] == pytest.approx(0.33)
    assert 0.5 < found[2] < 0.65
