"""Intervals of sigmas from few residuals: coverage by simulation, limits by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.special import bdtrik
from scipy.stats import t

from surveyapp.core.statistics.few_degrees import effective_dof, half_width95
from surveyapp.core.uncertain import Source, Uncertain

RUNS = 2000
LOW = float(bdtrik(0.0005, RUNS, 0.93)) / RUNS
HIGH = float(bdtrik(0.9995, RUNS, 0.98)) / RUNS
"""The interval is held to 93 to 98 %; bounds of the binomial distribution (99.9 %) around them."""


def coverage(dofs: list[float], sigmas: list[float], *, known: float, seed: int) -> float:
    """Share of intervals that hold the truth: each variance is estimated with its dof."""
    rng = np.random.default_rng(seed)
    true = np.array(sigmas) ** 2
    size = math.sqrt(true.sum() + known**2)
    held = 0
    for error in rng.normal(scale=size, size=RUNS):
        found = true * rng.chisquare(dofs) / dofs
        parts = [*zip(found.tolist(), dofs, strict=True), (known**2, math.inf)]
        held += abs(error) <= half_width95(parts)
    return held / RUNS


@pytest.mark.statistical
@pytest.mark.parametrize(("dof", "known"), [(1.0, 0.2), (1.0, 1.0), (2.0, 0.3), (3.0, 1.0)])
def test_one_estimate_among_known_sources(dof: float, known: float) -> None:
    assert LOW <= coverage([dof], [1.0], known=known, seed=int(10 * known + dof)) <= HIGH


@pytest.mark.statistical
@pytest.mark.parametrize(
    ("dofs", "sigmas"),
    [([1.0, 5.0], [1.0, 0.5]), ([2.0, 20.0], [1.0, 1.0])],
)
def test_several_estimates(dofs: list[float], sigmas: list[float]) -> None:
    assert LOW <= coverage(dofs, sigmas, known=0.5, seed=3) <= HIGH


def test_a_single_estimate_has_its_own_quantile() -> None:
    assert half_width95([(4.0, 3.0)]) == pytest.approx(2.0 * t.ppf(0.975, 3))
    assert half_width95([(4.0, math.inf)]) == pytest.approx(2.0 * 1.959964, rel=1e-6)


def test_equal_estimates_are_left_to_welch_and_satterthwaite() -> None:
    parts = [(1.0, 2.0), (1.0, 2.0)]
    assert effective_dof(parts) == pytest.approx(4.0)
    assert half_width95(parts) == pytest.approx(math.sqrt(2.0) * t.ppf(0.975, 4))


def test_never_narrower_than_welch_never_wider_than_banerjee() -> None:
    rng = np.random.default_rng(8)
    for _ in range(200):
        parts = [(float(v), float(d)) for v, d in zip(rng.chisquare(1, 3), (1, 4, 20), strict=True)]
        total = sum(v for v, _ in parts)
        welch = t.ppf(0.975, max(effective_dof(parts), 1.0)) * math.sqrt(total)
        banerjee = math.sqrt(sum(t.ppf(0.975, d) ** 2 * v for v, d in parts))
        assert welch * (1 - 1e-9) <= half_width95(parts)
        assert half_width95(parts) <= max(welch, banerjee) * (1 + 1e-9)


def test_a_value_without_error_has_no_interval() -> None:
    assert half_width95([(0.0, math.inf)]) == 0.0
    assert Uncertain(1.0).interval95 == 0.0
    assert Uncertain(1.0, {Source("a", "b", 2.0): math.inf}).interval95 == math.inf
