"""Several lines of one side: combined by their variances where they agree."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from surveyapp import api
from surveyapp.core.orientation.combined_lines import _agreement, _covariance, _inverse
from surveyapp.core.uncertain import Source, Uncertain

TOML = """
format = 1
name = "side"
crs = "+proj=tmerc +lat_0=0 +lon_0=20 +k=1 +x_0=500000 +y_0=0 +ellps=GRS80 +units=m +type=crs"
[[instrument]]
id = "G"
card = "gyromat-3000"
constant = { arcsec = 10.0, sigma_arcsec = 3.0 }
[[instrument]]
id = "H"
card = "gyromat-3000"
constant = { arcsec = 20.0, sigma_arcsec = 4.0 }
[[station]]
name = "A"
e = 500000.0
n = 5300000.0
[[station]]
name = "B"
e = 500300.0
n = 5300400.0
"""
SESSION = """
[[orientation]]
id = "{id}"
station = "{start}"
target = "{end}"
instrument = "{id}"
method = "automatic"
purpose = "survey"
sigma_arcsec = {sigma}
book = "observations/{id}.csv"
"""


def orient(folder: Path, h: str, *, back: bool = False) -> api.OrientationResult:
    """G reads A-B with 6", H the same line (or B-A) with 12"."""
    (folder / "observations").mkdir()
    for name, text in (("G", "036-52-00.0"), ("H", h)):
        (folder / f"observations/{name}.csv").write_text(f"seq,kind,value\n1,azimuth,{text}\n")
    ends = {"start": "B", "end": "A"} if back else {"start": "A", "end": "B"}
    toml = TOML + SESSION.format(id="G", start="A", end="B", sigma=6.0)
    (folder / "project.toml").write_text(toml + SESSION.format(id="H", sigma=12.0, **ends))
    return api.orient(folder)


def test_two_instruments_by_hand(tmp_path: Path) -> None:
    # G 36-52-10, H 36-52-30, 20" apart; own variances 36 + 9 = 45 and 144 + 16 = 160
    result = orient(tmp_path, "036-52-10.0")
    (side,) = result.to_dict()["combined"]
    assert [part["weight"] for part in side["lines"]] == pytest.approx([160 / 205, 45 / 205])
    assert [part["instrument"] for part in side["lines"]] == ["G", "H"]
    assert side["chi_square"] == pytest.approx(20.0**2 / 205, rel=1e-6)
    assert (side["dof"], side["agree"]) == (1, True)
    # P(chi-square of 1 > 1.951) by the normal integral
    assert side["probability"] == pytest.approx(math.erfc(math.sqrt(400 / 205 / 2)), abs=1e-6)
    first, second = (line.to_dict()["grid_azimuth"] for line in result.lines)
    combined = side["grid_azimuth"]
    mean = (160 * first["deg"] + 45 * second["deg"]) / 205
    assert combined["deg"] == pytest.approx(mean, abs=1e-10)
    # deflection and centring are of both: they stay whole beside 45 x 160 / 205
    shared = first["sigma_arcsec"] ** 2 - 45.0
    assert shared == pytest.approx(second["sigma_arcsec"] ** 2 - 160.0, rel=1e-6)
    assert shared > 0.0
    assert combined["sigma_arcsec"] ** 2 == pytest.approx(shared + 45 * 160 / 205, rel=1e-6)
    (check,) = (check for check in result.checks if check.rule == "line.instruments")
    assert check.passed is True
    assert check.value == pytest.approx(20.0, rel=1e-6)


def test_the_way_back_is_turned(tmp_path: Path) -> None:
    result = orient(tmp_path, "216-52-10.0", back=True)
    (side,) = result.combined
    assert (side.station, side.target, side.agree) == ("A", "B", True)
    grids = [line.grid_azimuth for line in result.lines]
    assert side.grid_azimuth is not None
    assert grids[0] is not None
    assert abs(side.grid_azimuth.value - grids[0].value) < math.radians(20.0 / 3600.0)
    assert {check.rule for check in result.checks} >= {"line.forward_back"}


def test_what_disagrees_is_not_combined(tmp_path: Path) -> None:
    # 30" apart at sqrt(205) = 14.3": p = 0.036
    (side,) = orient(tmp_path, "036-52-20.0").combined
    assert side.probability == pytest.approx(math.erfc(math.sqrt(900 / 205 / 2)), abs=1e-6)
    assert not side.agree
    assert side.to_dict()["grid_azimuth"] is None


@pytest.mark.parametrize(
    ("sigmas", "rounds"),
    [((4.0, 8.0), (6, 6)), ((4.0, 8.0), (4, 30)), ((4.0, 8.0, 6.0), (8, 8, 8))],
)
def test_lines_that_agree_are_called_so_in_19_of_20_cases(
    sigmas: tuple[float, ...], rounds: tuple[int, ...]
) -> None:
    # two lines: Welch's t-test; 1500 runs at 5 % have a standard error of .56 %
    rng, told, runs = np.random.default_rng(20261128), 0, 1500
    for _ in range(runs):
        shared = float(rng.normal(scale=10.0))
        items = []
        for number, (sigma, count) in enumerate(zip(sigmas, rounds, strict=True)):
            found = rng.normal(scale=sigma, size=count)
            own = Source("rounds", str(number), float(count - 1))
            parts = {own: float(found.std(ddof=1)) / math.sqrt(count), Source("known", "K"): 10.0}
            items.append(Uncertain(float(found.mean()) + shared, parts))
        inverse = _inverse(_covariance(items))
        assert inverse is not None
        told += _agreement(items, inverse)[1] < 0.05
    assert 0.03 < told / runs < 0.075
