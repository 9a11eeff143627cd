"""The global test where sigmas were estimated from a few readings."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from surveyapp import api
from surveyapp.core.network.estimated_sigmas import Share, bounds, degrees
from surveyapp.core.network.quality import family_critical, global_test

PROJECT = """format = 1
name = "t"
[[station]]
name = "A"
e = 0.0
n = 0.0
fixed = true
[[station]]
name = "B"
e = 0.0
n = 100.0
fixed = true
[[station]]
name = "C"
[[traverse]]
name = "main"
book = "observations/main.csv"
sigma_angle_arcsec = 4.0
sigma_distance = { mm = 1.0, ppm = 0.0 }
"""
HEAD = "kind,at,from,to,value,unit,sigma,sigma_unit,set,hi,ht,note\n"
BOOK = HEAD + "".join(
    f"{row}\n"
    for row in (
        "distance,A,,C,70.7110,m,,,,,,",
        "distance,C,,A,70.7106,m,,,,,,",
        "distance,B,,C,70.7112,m,,,,,,",
        "angle,A,B,C,45.0005,deg,,,,,,",
        "angle,B,C,A,45.0003,deg,,,,,,",
    )
)


@pytest.mark.parametrize(
    ("r", "f", "lower", "upper"),
    [(10, 8, 1 / 3.855, 4.295), (5, 5, 1 / 7.146, 7.146), (8, 10, 1 / 4.295, 3.855)],
)
def test_one_estimate_alone_gives_the_table_of_f(
    r: int, f: int, lower: float, upper: float
) -> None:
    """F at 97.5 %: Ghilani, Adjustment Computations, table D.4."""
    found = bounds((Share(1.0, f),), r, 0.95)
    assert [x**2 for x in found] == pytest.approx([lower, upper], rel=5e-3)


def test_without_a_share_the_bounds_are_those_of_chi_square() -> None:
    """Chi-square with 10 degrees of freedom at 95 %: 3.247 and 20.483."""
    found = bounds((Share(1e-5, 6),), 10, 0.95)
    assert [10 * x**2 for x in found] == pytest.approx([3.247, 20.483], rel=2e-3)


def test_two_estimates_beside_a_known_part() -> None:
    """Drawn: the truth of each variance, and the residuals of it."""
    r = np.random.default_rng(7)
    n, dof, parts = 400_000, 12, ((0.5, 7), (0.3, 9))
    total = 0.2 + sum(p * f / r.chisquare(f, n) for p, f in parts)
    ratio = np.sqrt(total * r.chisquare(dof, n) / dof)
    found = bounds(tuple(Share(p, f) for p, f in parts), dof, 0.95)
    assert found == pytest.approx(np.quantile(ratio, [0.025, 0.975]), rel=6e-3)
    assert degrees([Share(p, f) for p, f in parts]) == pytest.approx(1 / (0.25 / 7 + 0.09 / 9))


def test_what_is_assumed_may_be_smaller() -> None:
    """Half of the variance assumed: the lower bound is that of the other half alone."""
    known, assumed = (
        bounds((Share(0.5, math.inf, rest_assumed=flag),), 10, 0.95) for flag in (False, True)
    )
    assert [10 * x**2 for x in known] == pytest.approx([3.247, 20.483], rel=2e-3)
    assert [10 * x**2 for x in assumed] == pytest.approx([3.247 / 2, 20.483], rel=2e-3)
    assert degrees((Share(0.5, math.inf),)) is None


def test_single_tests_are_those_of_student() -> None:
    """t at 99.5 % with 10 degrees of freedom: 3.169."""
    assert family_critical(1, 0.01, None, sigma_dof=10) == pytest.approx(3.169, abs=1e-3)
    assert global_test(1.0, 0, sigma_apriori=1.0, probability=0.95).passed is None


def test_a_traverse_that_states_them(tmp_path: Path) -> None:
    (tmp_path / "observations").mkdir()
    (tmp_path / "observations/main.csv").write_text(BOOK, encoding="utf-8")
    file = tmp_path / "project.toml"
    file.write_text(PROJECT, encoding="utf-8")
    known = api.adjust(tmp_path)
    file.write_text(PROJECT + "sigma_dof = { angle = 8, distance = 6 }\n", encoding="utf-8")
    found = api.adjust(tmp_path)
    assert known.global_test.sigma_dof is None
    test = found.global_test
    assert test.ratio == known.global_test.ratio
    assert test.sigma_dof is not None
    assert 6.0 < test.sigma_dof < 14.0  # both together know more than the weaker one
    upper = known.global_test.upper
    assert test.upper is not None
    assert upper is not None
    assert test.upper > upper * 1.2
    assert found.snooping.statistic == "student"
    assert found.to_dict()["global_test"]["sigma_dof"] == test.sigma_dof  # type: ignore[index]


@pytest.mark.parametrize("text", ["{ angle = 0 }", "{ angle = -3 }", '{ distance = "six" }', "8"])
def test_degrees_of_freedom_that_cannot_be(tmp_path: Path, text: str) -> None:
    (tmp_path / "observations").mkdir()
    (tmp_path / "observations/main.csv").write_text(BOOK, encoding="utf-8")
    (tmp_path / "project.toml").write_text(f"{PROJECT}sigma_dof = {text}\n", encoding="utf-8")
    with pytest.raises(api.SurveyError):
        api.adjust(tmp_path)
