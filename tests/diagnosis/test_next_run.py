"""What to observe next after a run: widths, separations, recurrence, words."""

from __future__ import annotations

import numpy as np
import pytest

from bench._records import Truth, problems
from surveyapp.diagnosis.candidates import single_effects
from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.engine import diagnose
from surveyapp.diagnosis.fits import fit_members
from surveyapp.diagnosis.next_run import RUN_ACTIONS, run_advice
from surveyapp.diagnosis.outlook import ActionResult, Outlook
from surveyapp.diagnosis.plain_words import words_of
from surveyapp.diagnosis.run_average import run_average
from surveyapp.diagnosis.run_rivals import design_of, rivals_of

IDS = [action.id for action in RUN_ACTIONS]


def run(effect: str = "", seed: int = 3, size: int = 12, **sizes: float) -> Case:
    cases, _ = problems(Truth("t", size, effect, **sizes), 1, seed)  # type: ignore[arg-type]
    return cases[0]


def advised(case: Case, seed: int = 1) -> Outlook:
    found = run_advice(case, fit_members(case, ()), np.random.default_rng(seed))
    assert found is not None
    return found


def by_id(found: Outlook) -> dict[str, ActionResult]:
    assert sorted(item.action for item in found.actions) == sorted(IDS)
    return {item.action: item for item in found.actions}


@pytest.mark.parametrize(
    ("effect", "sizes"), [("", {}), ("midpoint_drift", {"drift": 3.0}), ("", {"walk": 9.0})]
)
def test_as_it_stands_it_is_the_average_of_the_run(effect: str, sizes: dict[str, float]) -> None:
    """Two programs, one formula: the interval of now is that of the short run's average."""
    case = run(effect, **sizes)  # type: ignore[arg-type]
    average, _ = run_average(case, fit_members(case, ()))
    assert advised(case).interval == pytest.approx(average.interval95, rel=0.02)


def test_a_second_run_of_a_clean_one_is_worth_the_root_of_two() -> None:
    ratios: dict[str, list[float]] = {name: [] for name in IDS}
    for seed in range(12):
        found = advised(run(seed=seed))
        for name, item in by_id(found).items():
            ratios[name].append(item.interval95 / found.interval)
    means = {name: float(np.mean(values)) for name, values in ratios.items()}
    for name in ("reversed_start", "second_run", "other_observer"):
        assert 0.5 < means[name] < 0.8, name  # 1/sqrt(2), and fewer doubts
    # two points more of twelve: sqrt(12/14) = .93 at best, the amplitude's unknowns help too
    assert 0.75 < means["two_points"] < 1.0


def test_what_is_expected_is_what_comes() -> None:
    """Expected separation is the mean of the later weights: no less than now (martingale)."""
    for seed in range(6):
        found = advised(run("midpoint_drift", seed=seed, drift=2.0))
        for item in found.actions:
            assert item.separation >= found.now - 0.08
            assert item.information >= 0.0


def test_events_do_not_recur_and_the_instrument_does() -> None:
    case = run(seed=5)
    base = fit_members(case, ())
    n = case.size
    for action in RUN_ACTIONS:
        design = design_of(case, base, action)
        columns: dict[str, list[float]] = {}
        for rival in rivals_of(case, single_effects(case, base.theta), (design, action)):
            largest = np.abs(rival.columns[:, n:]).max(axis=(1, 2))
            for unit, size in zip(rival.units, largest.tolist(), strict=True):
                columns.setdefault(unit, []).append(size)
        assert set(columns["gross_error"]) == {0.0}
        for unit in ("midpoint_drift", "warm_up", "quadratic_drag", "dry_friction"):
            assert min(columns[unit]) > 0.0, unit
        after_step = max(columns["midpoint_step"])
        assert (after_step == 0.0) == action.later
        assert (max(columns["damping_break"]) == 0.0) == action.anew


def test_a_reversed_start_turns_the_sides() -> None:
    case = run()
    base = fit_members(case, ())
    one, two = (
        design_of(case, base, action)
        for action in RUN_ACTIONS
        if action.id in ("reversed_start", "other_observer")
    )
    n = case.size
    assert one.laws["side"][n:] == pytest.approx(-two.laws["side"][n:])
    assert one.flat.shape == two.flat.shape == (2 * n, 5)


def test_the_same_seed_gives_the_same_advice() -> None:
    case = run("warm_up", warm_up=40.0)
    assert advised(case, 7) == advised(case, 7)


def test_it_is_told_with_numbers_and_in_the_json() -> None:
    case = run("midpoint_drift", drift=3.0)
    result = diagnose(case, draws=500)
    told = " ".join(words_of(result, case))
    assert "Next, best: " in told
    assert "north at +-" in told
    actions = result.to_dict()["actions"]
    assert {item["action"] for item in actions} == set(IDS)
    assert all(item["interval95_arcsec"] > 0.0 for item in actions)


@pytest.mark.parametrize("size", [5, 61])
def test_without_enough_points_or_with_too_many_nothing_is_said(size: int) -> None:
    case = run(size=size)
    assert run_advice(case, fit_members(case, ()), np.random.default_rng(1)) is None
