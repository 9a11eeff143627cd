"""Numbers of traverse and shaft books beyond all measures are refused with their line."""

from pathlib import Path

import pytest

from tests.cli.command import run
from tests.shafts.test_refused_shafts import BOOK, folder

TRAVERSE = """\
format = 1
name = "t"
angle_unit = "deg"
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
[[traverse]]
name = "main"
book = "main.csv"
sigma_angle_arcsec = 7.0
sigma_distance = { mm = 2.0, ppm = 2.0 }
"""


@pytest.mark.parametrize("cell", ["1e308", "-1e200", "1e-320", "inf", "nan"])
def test_shaft_book_beyond_all_measures(tmp_path: Path, cell: str) -> None:
    outcome = run("shaft", folder(tmp_path / "p", book=BOOK.replace("5.6210", cell, 1)), "--json")
    assert outcome.code == 2, outcome.out
    assert outcome.json["problems"][0]["where"].endswith("line 5")


@pytest.mark.parametrize("cell", ["1e308", "-1e200", "1e-320", "inf", "nan"])
@pytest.mark.parametrize("column", ["value", "sigma"])
def test_traverse_book_beyond_all_measures(tmp_path: Path, column: str, cell: str) -> None:
    project = tmp_path / "p"
    project.mkdir()
    (project / "project.toml").write_text(TRAVERSE, encoding="utf-8")
    value, sigma = (cell, "2") if column == "value" else ("50.0", cell)
    (project / "main.csv").write_text(
        "kind,at,from,to,value,unit,sigma,sigma_unit,set,hi,ht,note\n"
        "angle,A,B,C,90.0,deg,,,,,,\n"
        f"distance,A,,C,{value},m,{sigma},mm,,,,\n",
        encoding="utf-8",
    )
    outcome = run("adjust", project, "--json")
    assert outcome.code == 2, outcome.out
    assert outcome.json["problems"][0]["where"].endswith("line 3")


@pytest.mark.parametrize(("at", "to"), [("E", "X"), ("ü", "F"), ("0", "nan")])
def test_gyro_side_to_an_unknown_point_is_named(tmp_path: Path, at: str, to: str) -> None:
    row = f"azimuth,underground,{at},,{to},120.0,deg,8,arcsec,,\n"
    outcome = run("shaft", folder(tmp_path / "p", book=BOOK + row), "--json")
    assert outcome.code == 2, outcome.out
    unknown = {name for name in (at, to) if name not in ("E", "F")}
    assert {problem["found"] for problem in outcome.json["problems"]} == unknown
