"""Blunders that would give a fine sigma and an azimuth wrong by degrees are refused or told."""

from pathlib import Path

import pytest

from surveyapp import api
from surveyapp.core.geodesy import open_grid
from surveyapp.domain.results import OrientationResult
from surveyapp.errors import Problem, SurveyError
from tests.cli.command import GOOD_BOOK, GOOD_TOML, good_project


def refused(folder: Path) -> Problem:
    with pytest.raises(SurveyError) as error:
        api.orient(folder)
    return error.value.problems[0]


def codes(result: OrientationResult) -> set[str]:
    return {warning.code for warning in result.warnings}


@pytest.mark.parametrize("right", ["40-00-04", "230-00-04", "219-00-04"])
def test_a_wrong_face_or_a_slip_of_degrees_is_refused(tmp_path: Path, right: str) -> None:
    book = "\n".join(GOOD_BOOK.splitlines()[:9]).replace("220-00-04", right) + "\n"
    problem = refused(good_project(tmp_path, book=book))
    assert "faces" in problem.what
    assert "session run" in problem.where
    assert "180 degrees" in problem.expected


def test_one_degree_in_one_of_four_sights_is_refused(tmp_path: Path) -> None:
    book = GOOD_BOOK.replace("220-00-04", "221-00-04")
    assert "faces" in refused(good_project(tmp_path, book=book)).what


def test_a_large_collimation_is_no_blunder(tmp_path: Path) -> None:
    book = GOOD_BOOK.replace("220-00-04", "220-20-04").replace("220-00-02", "220-20-02")
    target = api.orient(good_project(tmp_path, book=book)).sessions[0].to_dict()["targets"][0]
    assert target["collimation_arcsec"] == pytest.approx(-601.0, abs=1.0)


@pytest.mark.parametrize("points", [["10-00-00"] * 6, ["10-00-00", "", "10-00-04", "", "9-59-50"]])
def test_points_that_do_not_swing_are_refused(tmp_path: Path, points: list[str]) -> None:
    rows = [f"reversal,{point}" if point else "missed," for point in points]
    book = "seq,kind,value\n" + "".join(f"{i},{row}\n" for i, row in enumerate(rows, 1))
    problem = refused(good_project(tmp_path, book=book))
    assert "session run" in problem.where or "run.csv" in problem.where
    assert problem.hint


@pytest.mark.parametrize("purpose", ["survey", "calibration"])
def test_a_line_between_one_place_is_refused(tmp_path: Path, purpose: str) -> None:
    toml = GOOD_TOML.replace("e = 431634.860\nn = 3811581.143", "e = 431630.663\nn = 3811452.311")
    toml = toml.replace('purpose = "survey"', f'purpose = "{purpose}"')
    problem = refused(good_project(tmp_path, toml=toml))
    assert "one place" in problem.what
    assert problem.found == "0.000 m apart"


def test_exchanged_coordinates_are_told(tmp_path: Path) -> None:
    toml = GOOD_TOML.replace("e = 431630.663\nn = 3811452.311", "n = 431630.663\ne = 3811452.311")
    assert {"outside_grid", "line_long"} <= codes(api.orient(good_project(tmp_path, toml=toml)))
    good = codes(api.orient(good_project(tmp_path / "good")))
    assert not {"outside_grid", "line_long"} & good


def test_the_area_of_a_grid_knows_the_date_line() -> None:
    from math import radians

    grid = open_grid("EPSG:3832")  # a grid of the Pacific, from 98 E across 180 to 69 W
    assert grid.area_deg is not None
    inside = [(0.0, 179.0), (0.0, -179.0), (-20.0, 150.0)]
    assert not any(grid.is_beside(latitude=radians(a), longitude=radians(b)) for a, b in inside)
    assert grid.is_beside(latitude=0.0, longitude=radians(10.0))
    free = open_grid("+proj=tmerc +lon_0=9 +ellps=GRS80 +type=crs")
    assert not free.is_beside(latitude=radians(80.0), longitude=radians(170.0))


def test_a_constant_of_degrees_is_told(tmp_path: Path) -> None:
    toml = GOOD_TOML.replace("arcsec = -9.7", "arcsec = 7200.0")
    assert "constant_large" in codes(api.orient(good_project(tmp_path, toml=toml)))


def test_an_azimuth_far_from_the_coordinates_is_told(tmp_path: Path) -> None:
    # A-B runs at 1-52 by the coordinates, the readings say 40-25: another target was sighted
    result = api.orient(good_project(tmp_path))
    text = next(w.text for w in result.warnings if w.code == "far_from_coordinates")
    assert "+38.5" in text
    sample = Path(__file__).parents[2] / "projects" / "tongjin-2015"
    assert "far_from_coordinates" not in codes(api.orient(sample))
