"""Shaft books and tables that cannot be used say why, all problems together."""

import json
from pathlib import Path

import pytest

from surveyapp import api
from surveyapp.cli.main import main
from surveyapp.errors import SurveyError

TABLE = """format = 1
name = "one shaft"
angle_unit = "deg"
[[station]]
name = "C"
e = 0.0
n = 0.0
fixed = true
[[station]]
name = "D"
e = 0.0
n = 500.0
fixed = true
[[shaft]]
id = "S"
kind = "one"
depth_m = 600.0
wires = ["A", "B"]
book = "shaft.csv"
orient = { at = "E", to = "F" }
sigma_plumb_mm = 0.3
sigma_angle_arcsec = 3.0
sigma_distance = { mm = 0.7, ppm = 0.0 }
"""
BOOK = """kind,place,at,from,to,value,unit,sigma,sigma_unit,set,note
angle,surface,C,D,A,30.0,deg,,,,
angle,surface,C,A,B,0.640138888888889,deg,,,,
distance,surface,C,,B,9.8432,m,,,,
distance,surface,C,,A,5.6210,m,,,,
distance,surface,A,,B,4.2228,m,,,,
angle,underground,E,F,A,100.0,deg,,,,
angle,underground,E,A,B,359.359861111111111,deg,,,,
distance,underground,E,,B,9.8432,m,,,,
distance,underground,E,,A,5.6210,m,,,,
distance,underground,A,,B,4.2228,m,,,,
"""


def folder(path: Path, table: str = TABLE, book: str = BOOK) -> Path:
    path.mkdir()
    (path / "project.toml").write_text(table, encoding="utf-8")
    (path / "shaft.csv").write_text(book, encoding="utf-8")
    return path


def test_one_shaft_carries_the_azimuth_down(tmp_path: Path) -> None:
    """D-C-A 30, turn to A-B +1-29-32, mirrored below, F seen 100 degrees left of A."""
    (shaft,) = api.shaft(folder(tmp_path / "p")).shafts
    turn = (1.0 + 29.0 / 60.0 + 32.0707 / 3600.0) * 3600.0
    expected = 30.0 * 3600.0 + turn + turn - 100.0 * 3600.0
    found = shaft.azimuth.to_dict()["deg"] * 3600.0
    assert found == pytest.approx(expected % 1296000.0, abs=1e-3)
    surface, underground = shaft.triangles
    assert (surface.place, underground.place) == ("surface", "underground")
    assert surface.f_mm == pytest.approx(-0.2178, abs=0.5e-4)
    assert (surface.limit_mm, underground.limit_mm) == (2.0, 4.0)
    # twice the turn 7.022", twice the connecting angle 3", plumbing 20.723"
    squares = 2 * 7.022**2 + 2 * 3.0**2 + 20.723**2
    assert shaft.azimuth.to_dict()["sigma_arcsec"] == pytest.approx(squares**0.5, rel=1e-3)


REFUSED = [
    ("angle,surface,C,D,A,30.0", "angel,surface,C,D,A,30.0", "kind is not known"),
    ("angle,surface,C,D,A,30.0", "angle,above,C,D,A,30.0", "place is not known"),
    ("9.8432,m,,,,\ndistance,surface,C,,A", "nan,m,,,,\ndistance,surface,C,,A", "no number"),
    ("5.6210,m,,,,\ndistance,surface", "-5.6210,m,,,,\ndistance,surface", "not positive"),
    ("angle,surface,C,D,A,30.0,deg,,,,\n", "", "too few surface points"),
    ("angle,underground,E,F,A,100.0,deg,,,,\n", "", "no underground row names"),
    ("distance,underground,A,,B,4.2228", "swing,underground,Z,,,4.2228", "wrong unit"),
    ("distance,underground,A,,B,4.2228,m", "swing,,Z,,,4.2228,mm", "axis of the swing"),
    ("distance,underground,A,,B,4.2228,m", "azimuth,underground,E,,F,10.0,deg", "no sigma"),
    ("distance,surface,A,,B", "distance,surface,A,,A", "sight to itself"),
]


@pytest.mark.parametrize(("old", "new", "words"), REFUSED, ids=[r[2] for r in REFUSED])
def test_a_book_that_cannot_be_used_says_why(
    tmp_path: Path, old: str, new: str, words: str
) -> None:
    assert old in BOOK
    with pytest.raises(SurveyError) as caught:
        api.shaft(folder(tmp_path / "p", book=BOOK.replace(old, new, 1)))
    assert any(words in problem.what for problem in caught.value.problems)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('wires = ["A", "B"]', 'wires = ["A"]', "not two names"),
        ("sigma_plumb_mm = 0.3", "sigma_plumb_mm = -0.3", "out of range"),
        ("sigma_plumb_mm = 0.3", "", "sigma_plumb_mm is missing"),
        ("depth_m = 600.0", "depth_m = 0.0", "out of range"),
        ('kind = "one"', 'kind = "three"', "not known"),
        ("sigma_angle_arcsec = 3.0", "", "without a standard deviation"),
        (
            'orient = { at = "E", to = "F" }',
            'orient = { at = "E", to = "G" }',
            "no underground row",
        ),
        ('name = "D"\ne = 0.0\nn = 500.0\nfixed = true', 'name = "D"', "too few surface points"),
        ('book = "shaft.csv"', 'book = "other.csv"', "does not exist"),
    ],
)
def test_a_table_that_cannot_be_used_says_why(
    tmp_path: Path, old: str, new: str, words: str
) -> None:
    assert old in TABLE
    path = folder(tmp_path / "p", TABLE.replace(old, new))
    with pytest.raises(SurveyError) as caught:
        api.shaft(path)
    assert any(words in problem.what for problem in caught.value.problems)
    assert main(["shaft", str(path)]) == 2


def test_all_problems_of_table_and_book_come_together(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table = TABLE.replace("depth_m = 600.0", "depth_m = -1.0").replace('kind = "one"', 'kind = "x"')
    book = BOOK.replace("angle,surface,C,D,A,30.0", "angle,surface,C,D,A,wide")
    book = book.replace("distance,surface,A,,B,4.2228", "distance,surface,A,,B,long")
    assert main(["shaft", str(folder(tmp_path / "p", table, book)), "--json"]) == 2
    problems = json.loads(capsys.readouterr().out)["problems"]
    assert len(problems) == 4


def test_weak_geometry_is_told(tmp_path: Path) -> None:
    """Wires 0.4 m apart seen from 5.6 m under 4 degrees."""
    import math

    far = math.sqrt(5.621**2 + 0.4**2 - 2 * 5.621 * 0.4 * math.cos(math.radians(60.0)))
    gamma = math.degrees(math.asin(0.4 / far * math.sin(math.radians(60.0))))
    book = BOOK.replace("4.2228", "0.4").replace("9.8432", f"{far:.6f}")
    book = book.replace("0.640138888888889", f"{gamma:.9f}")
    book = book.replace("359.359861111111111", f"{360.0 - gamma:.9f}")
    codes = {warning.code for warning in api.shaft(folder(tmp_path / "p", book=book)).warnings}
    assert {"wires_close", "gamma_large", "triangle_long"} <= codes


def test_a_project_without_shafts_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "p"
    path.mkdir()
    (path / "project.toml").write_text('format = 1\nname = "none"\n')
    with pytest.raises(SurveyError, match="no shaft"):
        api.shaft(path)
