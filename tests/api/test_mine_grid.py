"""A mine's own grid, printed convergences, and grids that no survey is computed with."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from surveyapp import api
from surveyapp.core.geodesy import open_grid, open_mine_grid
from surveyapp.domain.mine_grid import MineGrid
from surveyapp.errors import SurveyError
from surveyapp_models.angles import ARCSEC, RHO_ARCSEC

TOML = """
format = 1
name = "mine grid"
{grid}
[[instrument]]
id = "G"
card = "gyromat-3000"
[[station]]
name = "A"
{a}
[[station]]
name = "B"
{b}
[[station]]
name = "C"
{c}
[[station]]
name = "D"
{d}
[[orientation]]
id = "K"
station = "A"
target = "B"
instrument = "G"
method = "automatic"
purpose = "calibration"
{known}
book = "observations/K.csv"
[[orientation]]
id = "U"
station = "C"
target = "D"
instrument = "G"
method = "automatic"
purpose = "survey"
{survey}
book = "observations/U.csv"
"""
PLACES = {"a": "e = 1000.0\nn = 2000.0", "b": "e = 1100.0\nn = 2200.0", "c": "", "d": ""}
LOCAL = (
    """grid = { rotation = "12-00-00", origin = { e = 1000.0, n = 2000.0, lat = 47.0, lon = 8.0 }"""
)


def project(folder: Path, *, grid: str = "", known: str = "", survey: str = "", **at: str) -> Path:
    (folder / "observations").mkdir(parents=True)
    book = "seq,kind,value\n1,azimuth,{0}.0\n2,azimuth,{0}.2\n3,azimuth,{0}.1\n"
    (folder / "observations/K.csv").write_text(book.format("030-00-00"))
    (folder / "observations/U.csv").write_text(book.format("100-00-00"))
    text = TOML.format(grid=grid, known=known, survey=survey, **(PLACES | at))
    (folder / "project.toml").write_text(text)
    return folder


def test_a_mine_grid_turned_against_true_north(tmp_path: Path) -> None:
    # the mine's north bears 12-00-00: mine azimuth 18-00-00 is true 30-00-00; at the origin the
    # convergence is the rotation itself
    folder = project(
        tmp_path, grid=LOCAL + " }", known='azimuth_known = "018-00-00"', c="e = 1000.0\nn = 2000.0"
    )
    result = api.orient(folder).to_dict()
    assert result["constants"][0]["arcsec"] == pytest.approx(-0.1, abs=1e-4)
    line = result["lines"][0]
    assert line["convergence_arcsec"] == pytest.approx(43200.0, abs=1e-6)
    assert line["grid_azimuth"]["deg"] == pytest.approx(88.0, abs=1e-7)
    assert line["direction_from_south"] is None


def test_meridians_converge_from_the_origin_of_a_mine_grid_without_a_base() -> None:
    phi, lam = math.radians(-26.2), math.radians(27.9)
    mine = MineGrid(rotation=math.radians(-3.0), e=1e4, n=2e4, latitude=phi, longitude=lam)
    grid = open_mine_grid(mine)
    gamma = grid.convergence(latitude=phi, longitude=lam + math.radians(0.05))
    expected = math.radians(-3.0) + math.radians(0.05) * math.sin(phi)
    assert (gamma - expected) * RHO_ARCSEC == pytest.approx(0.0, abs=1e-4)
    e, n = grid.projected(latitude=phi, longitude=lam)
    assert (e, n) == pytest.approx((1e4, 2e4), abs=1e-6)


def test_a_mine_grid_is_transformed_both_ways_and_turns_azimuths() -> None:
    base = open_grid("EPSG:31467")
    base_e, base_n = base.projected(latitude=math.radians(51.0), longitude=math.radians(7.2))
    mine = MineGrid(
        rotation=math.radians(25.0), base="EPSG:31467", e=5000.0, n=1000.0,
        base_e=base_e, base_n=base_n, scale=1.0004,
    )  # fmt: skip
    grid = open_mine_grid(mine)
    assert grid.projected(latitude=math.radians(51.0), longitude=math.radians(7.2)) == (
        pytest.approx((5000.0, 1000.0), abs=1e-6)
    )
    # 1000 m along base azimuth 25-00-00 is 1000.4 m due north in the mine
    e = base_e + 1000.0 * math.sin(math.radians(25.0))
    n = base_n + 1000.0 * math.cos(math.radians(25.0))
    latitude, longitude = base.geographic(e=e, n=n)
    found = grid.projected(latitude=latitude, longitude=longitude)
    assert found == pytest.approx((5000.0, 2000.4), abs=1e-5)
    back = grid.geographic(e=found[0], n=found[1])
    assert back == pytest.approx((latitude, longitude), abs=1e-12)
    turned = grid.convergence(latitude=latitude, longitude=longitude)
    straight = base.convergence(latitude=latitude, longitude=longitude)
    assert turned - straight == pytest.approx(math.radians(25.0), abs=1e-12)


def test_the_sigma_of_the_rotation_cancels_between_known_and_unknown_lines(tmp_path: Path) -> None:
    grid = LOCAL + ", rotation_sigma_arcsec = 60.0 }"
    known = 'azimuth_known = "018-00-00"\nazimuth_known_sigma_arcsec = 1.0'
    at = {"c": "e = 1000.0\nn = 2000.0"}
    line = api.orient(project(tmp_path / "a", grid=grid, known=known, **at)).lines[0]
    assert line.grid_azimuth is not None
    assert line.grid_azimuth.sigma * RHO_ARCSEC < 20.0
    # with a constant known beforehand it does not
    folder = project(tmp_path / "b", grid=grid, known=known, **at)
    text = (folder / "project.toml").read_text()
    constant = "constant = { arcsec = 0.0, sigma_arcsec = 1.0 }\nconstant_choice = 'known'"
    text = text.replace('card = "gyromat-3000"', f'card = "gyromat-3000"\n{constant}')
    (folder / "project.toml").write_text(text)
    line = api.orient(folder).lines[0]
    assert line.grid_azimuth is not None
    assert line.grid_azimuth.sigma * RHO_ARCSEC > 60.0
    assert any(part.source == "rotation of the mine grid" for part in line.budget)


def test_printed_convergences_without_a_crs(tmp_path: Path) -> None:
    known = 'azimuth_known = "040-00-00"'
    folder = project(
        tmp_path,
        known=known,
        a='convergence = "-1-12-00"\nconvergence_sigma_arcsec = 2.0',
        b="",
        survey='convergence = "-1-12-45"\nconvergence_sigma_arcsec = 3.0',
    )
    result = api.orient(folder).to_dict()
    # constant = 40 - 1.2 - 30; grid = 100 + constant + 1-12-45
    assert result["constants"][0]["arcsec"] == pytest.approx((8.8 * 3600) - 0.1, abs=1e-6)
    line = result["lines"][0]
    assert line["convergence_arcsec"] == pytest.approx(-4365.0)
    assert line["grid_azimuth"]["deg"] == pytest.approx(100 + 8.8 + 1 + 12.75 / 60, abs=1e-9)
    printed = [part for part in line["budget"] if part["source"] == "printed convergence"]
    assert printed[0]["sigma_arcsec"] == pytest.approx(math.hypot(2.0, 3.0))


def test_a_printed_convergence_without_sigma_is_known_to_its_last_digit(tmp_path: Path) -> None:
    folder = project(tmp_path, a='convergence = "1-12-00.0"')
    stated = api.open_project(folder).station("A").convergence
    assert stated is not None
    assert stated.sigma == pytest.approx(0.1 * ARCSEC / math.sqrt(12.0))


@pytest.mark.parametrize(
    ("grid", "what"),
    [
        ('grid = { rotation = "12-00-00" }', "rotation stands without origin"),
        ("grid = { origin = { e = 0.0, n = 0.0, lat = 1.0, lon = 1.0 } }", "rotation is missing"),
        ('grid = { rotation = "12-00-00", origin = { e = 0.0, n = 0.0 } }', "where it lies"),
        (LOCAL + ", rotation_sigma_arcsec = -1.0 }", "rotation_sigma_arcsec is out of range"),
        (LOCAL + ", scale = 0.0 }", "scale is out of range"),
        (
            'grid = { base = "EPSG:31467", rotation = "1-00-00", origin = { e = 0.0, n = 0.0, '
            "base_e = 1.0 } }",
            "belong together",
        ),
        (
            'crs = "EPSG:25832"\ngrid = { base = "EPSG:31467", rotation = "1-00-00", '
            "origin = { e = 0.0, n = 0.0, base_e = 1.0, base_n = 1.0 } }",
            "named twice",
        ),
    ],
)
def test_bad_mine_grids_are_told(tmp_path: Path, grid: str, what: str) -> None:
    with pytest.raises(SurveyError, match=what):
        api.open_project(project(tmp_path, grid=grid))


def test_an_unknown_base_is_told(tmp_path: Path) -> None:
    grid = LOCAL.replace("rotation", 'base = "EPSG:999999", rotation') + " }"
    with pytest.raises(SurveyError) as caught:
        api.orient(project(tmp_path, grid=grid, known='azimuth_known = "018-00-00"'))
    assert caught.value.problems[0].where == "project.toml, grid, base"


@pytest.mark.parametrize(
    ("keys", "what"),
    [
        (
            {"a": 'convergence = "1-12-00"', "known": 'convergence = "1-12-01"'},
            "stated twice and differently",
        ),
        ({"a": "convergence_sigma_arcsec = 2.0"}, "stands without convergence"),
        ({"a": 'convergence = "1-12-00"\nconvergence_sigma_arcsec = -2.0'}, "out of range"),
        ({"a": "sigma_m = -0.01"}, "sigma_m is out of range"),
        ({"known": "azimuth_known_sigma_arcsec = -1.0"}, "azimuth_known_sigma_arcsec is out"),
    ],
)
def test_bad_convergences_and_sigmas_are_told(
    tmp_path: Path, keys: dict[str, str], what: str
) -> None:
    with pytest.raises(SurveyError, match=what):
        api.open_project(project(tmp_path, **keys))


def test_a_printed_convergence_that_is_not_the_one_of_the_grid_is_refused(tmp_path: Path) -> None:
    at = {"a": "lat = 47.0\nlon = 8.0\nconvergence = '{}'", "b": "lat = 47.01\nlon = 8.01"}
    crs = 'crs = "EPSG:25832"'  # 1 degree west of the axis: -0.7314 degrees
    good = {key: text.format("-0-43-53") for key, text in at.items()}
    api.orient(project(tmp_path / "good", grid=crs, **good))
    bad = {key: text.format("0-43-53") for key, text in at.items()}
    with pytest.raises(SurveyError, match="given twice and differently"):
        api.orient(project(tmp_path / "bad", grid=crs, **bad))


@pytest.mark.parametrize(
    ("crs", "e", "n", "rule"),
    [  # 431 km and 3811 km north of the equator, in feet and exchanged
        ("+proj=tmerc +lon_0=111 +x_0=500000 +ellps=GRS80", 1416108.0, 12504740.0, "convergence"),
        ("+proj=tmerc +lon_0=111 +x_0=500000 +ellps=GRS80", 3811452.3, 431630.7, "scale"),
        ("EPSG:3857", 890555.9, 5942074.1, "scale"),  # web Mercator at latitude 47
        ("ESRI:54030", 600000.0, 5000000.0, "angles"),  # Robinson is not conformal
    ],
)
def test_coordinates_in_another_unit_or_exchanged_are_told(
    tmp_path: Path, crs: str, e: float, n: float, *, rule: str
) -> None:
    folder = project(tmp_path, grid=f'crs = "{crs}"', a=f"e = {e}\nn = {n}", c=f"e = {e}\nn = {n}")
    failed = [c.rule for c in api.check(folder) if c.confirmed and c.passed is False]
    assert f"grid.{rule}" in failed


def test_a_mine_grid_by_hand_away_from_its_origin(tmp_path: Path) -> None:
    # C lies 500 m east and 500 m north of the origin in the mine, 593.03 m east and 385.12 m north
    # in the world; the meridian through it converges by east tan(latitude) / N (GRS80)
    folder = project(
        tmp_path, grid=LOCAL + " }", known='azimuth_known = "018-00-00"', c="e = 1500.0\nn = 2500.0"
    )
    turn = math.radians(12.0)
    east = 500.0 * math.cos(turn) + 500.0 * math.sin(turn)
    north = 500.0 * math.cos(turn) - 500.0 * math.sin(turn)
    e2, a = 0.00669438002290, 6378137.0
    across = a / math.sqrt(1.0 - e2 * math.sin(math.radians(47.0)) ** 2)
    along = across * (1.0 - e2) / (1.0 - e2 * math.sin(math.radians(47.0)) ** 2)
    latitude = math.radians(47.0) + north / along
    convergence = east * math.tan(latitude) / across * RHO_ARCSEC
    line = api.orient(folder).to_dict()["lines"][0]
    assert convergence == pytest.approx(20.53, abs=0.01)
    assert line["convergence_arcsec"] == pytest.approx(43200.0 + convergence, abs=1e-3)
    # gyro 100-00-00.1, constant -0.1: true 100-00-00, from the mine's north at C 87-59-39.47
    assert line["grid_azimuth"]["deg"] == pytest.approx(88.0 - convergence / 3600.0, abs=1e-7)
