"""What keeps a name off a run: causes by the margin, shapes against their odds."""

from __future__ import annotations

from dataclasses import replace

import pytest

from bench._records import Truth, problems
from surveyapp.diagnosis.case import Case, Levels
from surveyapp.diagnosis.loop import Search, search
from surveyapp.diagnosis.subjects.reversal_run import LEVELS

WITHOUT = replace(LEVELS, shape_odds=0.0)


def searched(case: Case, levels: Levels) -> Search:
    return search(replace(case, levels=levels), draws=300, confirm=None)


@pytest.fixture(scope="module")
def warm_ups() -> list[tuple[Search, Search]]:
    """Each with the odds of a shape and without."""
    cases, _ = problems(Truth("warm-up", 20, "warm_up", warm_up=40.0), 6, 4)
    return [(searched(case, LEVELS), searched(case, WITHOUT)) for case in cases]


def test_a_shape_keeps_a_first_name_off_only_against_its_odds(
    warm_ups: list[tuple[Search, Search]],
) -> None:
    """Each of these records has a bend or a slow wave within 4 BIC of the warm-up, or none."""
    named, before = (sum("warm_up" in pair[k].adopted for pair in warm_ups) for k in (0, 1))
    assert named >= before + 2
    assert not any(set(pair[0].adopted) - {"warm_up"} for pair in warm_ups)


def test_a_shape_is_told_where_there_is_no_name(warm_ups: list[tuple[Search, Search]]) -> None:
    same = [pair for pair in warm_ups if not pair[0].adopted]
    for with_odds, without in same:
        assert [fit.key for fit in with_odds.near] == [fit.key for fit in without.near]


def test_a_further_effect_passes_a_gate_of_its_own() -> None:
    cases, _ = problems(Truth("drift", 20, "midpoint_drift", drift=4.0), 2, 4)
    for case in cases:
        assert [gate.level for gate in searched(case, LEVELS).gates] == [0.05, 0.01]
