"""Runs of a large project: most pass by their first draws, and no verdict changes by it."""

from __future__ import annotations

import numpy as np
import pytest

from surveyapp.core.swing import goodness
from surveyapp.core.swing.goodness import FitTest, Judge, goodness_of_fit

COUNT = 10
MANY = goodness.MANY_SESSIONS + 10


def fit_tests(residuals: np.ndarray, resolution: float = 0.0) -> dict[str, FitTest]:
    place = np.arange(COUNT)
    jacobian = np.column_stack([np.ones(COUNT), (-1.0) ** place, place * (-1.0) ** place])
    projected = residuals - jacobian @ np.linalg.lstsq(jacobian, residuals, rcond=None)[0]
    found = goodness_of_fit(
        projected, jacobian, Judge(sessions=MANY), sigma=1.0, resolution=resolution
    )
    return {test.name: test for test in found}


@pytest.mark.parametrize("resolution", [0.0, 0.5])
def test_a_verdict_by_the_first_draws_is_that_of_all_draws(
    monkeypatch: pytest.MonkeyPatch, resolution: float
) -> None:
    rng = np.random.default_rng(5)
    runs = rng.standard_normal((12, COUNT))
    runs[0] = 3.0 * np.sin(0.5 * np.arange(COUNT))  # what a drift of the tape leaves
    by_first = [fit_tests(run, resolution) for run in runs]
    monkeypatch.setattr(goodness, "AMID", 2.0)
    by_all = [fit_tests(run, resolution) for run in runs]
    early = 0
    for short, whole in zip(by_first, by_all, strict=True):
        for name in ("lag1_correlation", "runs"):
            assert short[name].value == whole[name].value
            assert short[name].passed == whole[name].passed
            assert (short[name].low, short[name].high) in (
                (None, None),
                (whole[name].low, whole[name].high),
            )
            early += short[name].high is None
    assert early >= 12
    assert by_first[0]["lag1_correlation"].high is not None


def test_a_run_that_does_not_fit_is_drawn_to_the_end_and_refused() -> None:
    step = np.where(np.arange(COUNT) < COUNT // 2, -1.0, 1.0)
    found = fit_tests(20.0 * step)
    assert found["lag1_correlation"].high is not None
    assert not found["chi_square"].passed
