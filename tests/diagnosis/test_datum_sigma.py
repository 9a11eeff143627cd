"""Values at a datum: their sigma by linear theory, how often they hold, what rivals add."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from surveyapp.diagnosis.candidates import single_effects
from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.datum import datum_with_rivals
from surveyapp.diagnosis.engine import diagnose
from surveyapp.diagnosis.fits import Member, fit_members
from surveyapp.diagnosis.plain_words import words_of
from surveyapp.diagnosis.run_value import datum_values
from surveyapp.diagnosis.subjects.reversal_run import TurningPoints, reversal_run
from surveyapp_models.angles import ARCSEC, wrap_pi

NORTH = 1.0
TAU = 4.0


def run(seed: int, *, drift: float = 0.0) -> Case:
    """Twenty points that settle by 70 arc-seconds to ``NORTH``, and a drift."""
    rng = np.random.default_rng(seed)
    k = np.arange(20.0)
    side = np.where(k % 2 == 0, 1.0, -1.0)
    north = 70.0 * np.exp(-k / TAU) + drift * (k - k[-1])
    swing = side * 3600.0 * np.exp(-0.016 * k)
    error = 4.0 * rng.standard_normal(20)
    readings = NORTH + ARCSEC * (north + swing + error)
    return reversal_run(TurningPoints(readings.tolist(), right=(side > 0).tolist(), sigma=None))


@pytest.mark.statistical
def test_the_asymptote_lies_in_its_interval() -> None:
    inside = count = 0
    for seed in range(10):
        datum = diagnose(run(seed), draws=300, advise=False).after_best.value_at_datum
        if datum is None or datum.effect != "warm_up":
            continue
        (_, found), *_ = datum.states
        assert found.interval95 is not None
        inside += abs(wrap_pi(found.value - NORTH)) <= found.interval95
        count += 1
    assert count >= 5
    # .85 of those that were found, which are a selection; once in a thousand times below that
    assert inside >= stats.binom.ppf(0.001, count, 0.85)


def test_the_sigma_of_an_asymptote_contains_that_of_its_time() -> None:
    """Against the linear theory, written out: north, swing, settling and its time constant free."""
    case = run(1)
    base = fit_members(case, ())
    (candidate,) = (c for c in single_effects(case, base.theta) if c.id == "warm_up")
    place = [p["tau"] for p in candidate.points].index(TAU)
    fit = fit_members(case, (Member(candidate, place),), base.theta)
    ((_, _, value),) = datum_values(case, fit)
    k = np.arange(20.0)
    side = np.where(k % 2 == 0, 1.0, -1.0) * np.exp(-0.016 * k)
    amplitude = float(fit.linear[1])
    settling = np.exp(-k / TAU)
    design = np.column_stack(
        [np.ones(20), side, k * side, settling, amplitude * k / TAU**2 * settling]
    )
    cofactor = np.linalg.inv(design.T @ design)[0, 0] if amplitude else 0.0
    scatter = np.sqrt(fit.sum_of_squares / (20 - 5))
    assert value.sigma == pytest.approx(scatter * np.sqrt(cofactor), rel=0.05)


def test_the_sigma_of_the_datum_is_told() -> None:
    case = run(1)
    told = [
        t
        for t in words_of(diagnose(case, draws=300, advise=False), case)
        if "from the average" in t
    ]
    assert told
    assert all("(sigma " in text for text in told)


def test_sets_that_put_the_datum_elsewhere_widen_it() -> None:
    """A settling with and without a drift beside it, both as likely: half of the gap enters."""
    case = run(4, drift=1.0)
    base = fit_members(case, ())
    by_id = {c.id: c for c in single_effects(case, base.theta)}
    settling = Member(by_id["warm_up"], 5)
    one = fit_members(case, (settling,), base.theta)
    two = fit_members(case, (settling, Member(by_id["midpoint_drift"], 0)), base.theta)
    two = replace(two, score=one.score)
    ((_, _, alone),) = datum_values(case, one)
    ((_, _, other),) = datum_values(case, two)
    ((_, _, both),) = datum_with_rivals(case, one, (one, two))
    gap = alone.value - other.value
    assert both.value == alone.value
    assert both.sigma == pytest.approx(np.hypot(alone.sigma, gap / np.sqrt(2.0)), rel=1e-6)
