"""A candidate that is close behind what was named is told why it is no rival."""

from __future__ import annotations

import pytest

from bench._records import Truth, problems
from surveyapp.diagnosis.compare import MARGIN
from surveyapp.diagnosis.engine import diagnose


@pytest.mark.parametrize(
    "truth",
    [
        Truth("drift", 20, "midpoint_drift", drift=2.0),
        Truth("step", 20, "midpoint_step", step=25.0),
        Truth("warm-up", 45, "warm_up", warm_up=70.0),
    ],
    ids=lambda truth: truth.name,
)
def test_no_rival_within_the_margin_stands_without_a_reason(truth: Truth) -> None:
    cases, _ = problems(truth, 4, 17)
    explained = 0
    for case in cases:
        result = diagnose(case, draws=300, advise=False)
        if result.verdict != "explained":
            continue
        explained += 1
        named = {item.effect for item in result.adopted}
        near = [
            item
            for item in result.candidates
            if item.delta_bic is not None and item.delta_bic < MARGIN and item.effect not in named
        ]
        assert all(item.reason for item in near), near
    assert explained >= 2
