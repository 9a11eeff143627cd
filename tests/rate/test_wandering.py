"""Odds of an effect against noise that wanders, of gyros simulated without the simulator."""

from __future__ import annotations

import numpy as np
import pytest

from surveyapp.diagnosis.candidates import SHAPE_ODDS, all_candidates
from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.fits import Fit, Member, fit_members, with_noise
from surveyapp.diagnosis.stochastic import SIGNALS, effect_gain, effects_gain
from surveyapp.diagnosis.subjects.rate import RateStop, rate_case
from surveyapp.diagnosis.wandering import ODDS, log_odds
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


def test_an_effect_of_unknown_size_is_weighed_as_the_covariance_that_it_is() -> None:
    """Against the restricted likelihood of the whole covariance, written out (Harville 1974)."""
    rng = np.random.default_rng(4)
    n, each = 21, 7
    base, effect = rng.normal(size=(n, 3)), rng.normal(size=(n, 2))
    y = rng.normal(size=n) + 2.0 * effect[:, 0]
    q, _ = np.linalg.qr(base)
    out = np.eye(n) - q @ q.T
    residual, seen = out @ y, out @ effect
    scale = each / np.mean(np.sum(seen**2, axis=0))
    contrasts = np.linalg.svd(out)[0][:, : n - 3]  # of which the base knows nothing
    z = contrasts.T @ y

    def minus(covariance: Floats) -> float:
        total = float(z @ np.linalg.solve(covariance, z))
        return float((n - 3) * np.log(total) + np.linalg.slogdet(covariance)[1])

    about = contrasts.T @ effect
    each_size = [
        minus(np.eye(n - 3) + size * scale * about @ about.T) - minus(np.eye(n - 3))
        for size in SIGNALS
    ]
    expected = 2.0 * np.log(np.mean(np.exp(-0.5 * np.array(each_size))))
    found = effect_gain(base, effect, residual, each=each, floor=1e-18)
    assert found == pytest.approx(expected, rel=1e-9)
    both = effect_gain(base, np.hstack([base, effect]), residual, each=each, floor=1e-18)
    assert both == pytest.approx(found, rel=1e-9)  # what the base has is not counted again


def test_two_effects_are_weighed_as_the_sum_of_their_covariances() -> None:
    """Every pair of sizes written out; their order decides nothing."""
    rng = np.random.default_rng(6)
    n, each = 24, 8
    base, first, second = rng.normal(size=(n, 2)), rng.normal(size=(n, 3)), rng.normal(size=(n, 1))
    y = rng.normal(size=n) + first[:, 1] + 1.5 * second[:, 0]
    q, _ = np.linalg.qr(base)
    out = np.eye(n) - q @ q.T
    contrasts = np.linalg.svd(out)[0][:, : n - 2]
    z = contrasts.T @ y
    parts = []
    for effect in (first, second):
        about = contrasts.T @ effect
        parts.append(about @ about.T * each / np.mean(np.sum(about**2, axis=0)))

    def minus(covariance: Floats) -> float:
        total = float(z @ np.linalg.solve(covariance, z))
        return float((n - 2) * np.log(total) + np.linalg.slogdet(covariance)[1])

    gains = [
        minus(np.eye(n - 2)) - minus(np.eye(n - 2) + one * parts[0] + other * parts[1])
        for one in SIGNALS
        for other in SIGNALS
    ]
    expected = 2.0 * np.log(np.mean(np.exp(0.5 * np.array(gains))))
    for effects in ([first, second], [second, first]):
        found = effects_gain(base, effects, out @ y, each=each, floor=1e-18)
        assert found == pytest.approx(expected, rel=1e-9)


def test_a_drift_beside_a_sensitivity_costs_what_both_do_together() -> None:
    """Each charged beside the other, a drift beside a sensitivity went to a walk."""
    force = np.random.default_rng(5).normal(size=(STOPS, 3))
    force *= 9.8 / np.linalg.norm(force, axis=1)[:, None]
    rng = np.random.default_rng(7)
    minutes = 0.1 * np.arange(STOPS)[:, None]
    outputs = 1e-4 * rng.normal(size=(STOPS, 3)) + 4e-4 * minutes
    case = rests(outputs + force @ (4e-5 * rng.normal(size=(3, 3))))
    pool = {c.id: c for c in all_candidates(case, None)}
    members = [Member(pool["g_sensitivity"], 0), Member(pool["bias_ramp"], 0)]
    base = fit_members(case, [])
    gain = effects_gain(
        base.design, [m.columns for m in members], base.residual, each=STOPS, floor=1e-18
    )
    for order in (members, members[::-1]):
        assert fit_members(case, order).bic == pytest.approx(base.bic - gain)


def test_odds_tell_drifts_from_walks() -> None:
    """Records of three gyros, sizes unknown: few walks are worth two to one, most drifts are."""
    rng = np.random.default_rng(11)
    minutes = 0.1 * (np.arange(STOPS) - 0.5 * STOPS)[:, None]

    def share(outputs: list[Floats]) -> float:
        odds = []
        for output in outputs:
            case = rests(output)
            walk = next(
                f
                for f in with_noise(case, fit_members(case, []))
                if f.noise is not None and f.noise.kind == "random_walk"
            )
            odds.append(log_odds(case, with_ramp(case), walk))
        return float(np.mean(np.array(odds) >= np.log(ODDS)))

    def white() -> Floats:
        return 1e-4 * rng.normal(size=(STOPS, 3))

    drifts = [white() + 4e-4 * minutes * rng.choice([-1.0, 1.0], 3) for _ in range(40)]
    walks = [white() + 1e-4 * np.cumsum(rng.normal(size=(STOPS, 3)), axis=0) for _ in range(40)]
    assert share(drifts) >= 0.8  # .96 of 400
    assert share(walks) <= 0.2  # .05 of 400: nine and more of 40 have p = 2e-4


def test_a_shape_is_charged_beforehand_and_a_named_effect_is_not() -> None:
    """A step costs what its drawn coefficients do, the search for its place, and the odds."""
    case = rests(1e-4 * np.random.default_rng(3).normal(size=(STOPS, 3)))
    pool = {c.id: c for c in all_candidates(case, None)}
    assert pool["bias_ramp"].odds == pool["gross_error"].odds == 0.0
    base = fit_members(case, [])
    for name, place, odds in (("step", 4, SHAPE_ODDS), ("bias_ramp", 0, 0.0)):
        member = Member(pool[name], place)
        fit = fit_members(case, [member])
        gain = effect_gain(base.design, member.columns, base.residual, each=STOPS, floor=1e-18)
        searched = fit.parameters - base.parameters - 3
        assert searched == (name == "step")
        expected = base.bic - gain + searched * np.log(case.size) + odds
        assert fit.bic == pytest.approx(expected)


def test_nine_coefficients_are_not_beaten_by_one_that_was_looked_for() -> None:
    """A sensitivity that is plain to an F test goes before a gross error of any row."""
    rng = np.random.default_rng(12)
    before = by_counting = 0
    for _ in range(24):
        case = rests(np.zeros((STOPS, 3)))
        force = np.column_stack([case.columns[f"force_{a}"] for a in "xyz"])[::3]
        pull = 9e-6 * rng.normal(size=(3, 3))
        case = rests(1e-4 * rng.normal(size=(STOPS, 3)) + force @ pull.T)
        pool = {c.id: c for c in all_candidates(case, None)}
        one = fit_members(case, [Member(pool["g_sensitivity"], 0)])
        gross = pool["gross_error"]
        rivals = [fit_members(case, [Member(gross, g)]) for g in range(len(gross.points))]
        other = min(rivals, key=lambda fit: fit.bic)
        before += one.bic < other.bic
        n = case.size
        plain = n * np.log(one.sum_of_squares / n / case.scale**2) + one.parameters * np.log(n)
        by_counting += plain < other.bic
    assert before >= 17  # .92 of 400: fewer have p = 4e-4
    assert by_counting < before  # .60 of 400 by a charge for each
