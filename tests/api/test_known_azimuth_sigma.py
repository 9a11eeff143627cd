"""A known azimuth has an error of its own: stated, else from the coordinates."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from surveyapp import api
from surveyapp_models.angles import RHO_ARCSEC

TOML = """
format = 1
name = "known"
crs = "EPSG:25832"
{top}
[[instrument]]
id = "G"
card = "gyromat-3000"
[[station]]
name = "K"
e = 500000.0
n = 5300000.0
{k}
[[station]]
name = "L"
e = 500300.0
n = 5300400.0
{l}
[[orientation]]
id = "cal"
station = "K"
target = "L"
instrument = "G"
method = "automatic"
purpose = "calibration"
{session}
book = "observations/cal.csv"
[[orientation]]
id = "back"
station = "L"
target = "K"
instrument = "G"
method = "automatic"
purpose = "calibration"
{session}
book = "observations/back.csv"
"""


def orient(folder: Path, **keys: str) -> api.OrientationResult:
    (folder / "observations").mkdir()
    rows = "seq,kind,value\n1,azimuth,{0}.0\n2,azimuth,{0}.2\n"
    (folder / "observations/cal.csv").write_text(rows.format("036-52-11"))
    (folder / "observations/back.csv").write_text(rows.format("216-52-11"))
    blank = {"top": "", "k": "", "l": "", "session": ""}
    (folder / "project.toml").write_text(TOML.format(**(blank | keys)))
    return api.orient(folder)


def known_sigma(result: api.OrientationResult) -> float:
    """Sigma of the mean of forward and back less that with exact coordinates [arcsec]."""
    sigma = result.constants[0].sigma
    assert sigma is not None
    return sigma * RHO_ARCSEC


def codes(result: api.OrientationResult) -> set[str]:
    return {warning.code for warning in result.warnings}


def test_the_sigma_of_coordinates_over_the_length_does_not_average_out(tmp_path: Path) -> None:
    for name in ("exact", "coordinates", "project", "stated"):
        (tmp_path / name).mkdir()
    exact = known_sigma(orient(tmp_path / "exact", k="sigma_m = 0.0", l="sigma_m = 0.0"))
    # 10 mm at both ends of 500 m: 4.125" sqrt(2) = 5.83"
    ends = {"k": "sigma_m = 0.01", "l": "sigma_m = 0.01"}
    result = orient(tmp_path / "coordinates", **ends)
    share = math.sqrt(known_sigma(result) ** 2 - exact**2)
    assert share == pytest.approx(0.01 * math.sqrt(2.0) / 500.0 * RHO_ARCSEC, rel=1e-6)
    assert "known_azimuth_sigma_assumed" not in codes(result)
    # the project's default stands for both; a stated sigma of the azimuth wins
    result = orient(tmp_path / "project", top="station_sigma_m = 0.01")
    assert known_sigma(result) ** 2 - exact**2 == pytest.approx(share**2, rel=1e-6)
    result = orient(tmp_path / "stated", session="azimuth_known_sigma_arcsec = 10.0", **ends)
    assert known_sigma(result) ** 2 - exact**2 == pytest.approx(100.0, rel=1e-6)


def test_a_rule_book_may_state_the_sigma_of_stations(tmp_path: Path) -> None:
    (tmp_path / "p").mkdir()
    book = 'id = "b"\ntitle = "b"\nsource = "own"\nstation_sigma_m = 0.02\n'
    (tmp_path / "p/rules.toml").write_text(book)
    result = orient(tmp_path / "p", top='rule_book = "rules.toml"')
    assert "known_azimuth_sigma_assumed" not in codes(result)
    assert known_sigma(result) > 0.02 * math.sqrt(2.0) / 500.0 * RHO_ARCSEC


def test_who_states_nothing_is_asked(tmp_path: Path) -> None:
    result = orient(tmp_path)
    told = [w for w in result.warnings if w.code == "known_azimuth_sigma_assumed"]
    assert len(told) == 1  # K-L and L-K are one line
    # 5 mm at both ends of 500 m
    assert known_sigma(result) > 2.9
