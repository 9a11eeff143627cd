"""One mistake that spoils several readings, and one that keeps an adjustment from converging."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from bench.import_sigmas import _traverse
from surveyapp import api
from surveyapp.core.network.removals import MOST_SHOWN
from surveyapp.domain.adjustment import AdjustmentResult
from surveyapp.errors import SurveyError
from tests.formats.field_writers import Setup, Sight, gsi
from tests.formats.importing import project

FOOT = 0.3048


def adjusted(tmp_path: Path, setups: list[Setup], sights: list[Sight]) -> AdjustmentResult:
    folder = project(tmp_path / "p")
    file = tmp_path / "f.gsi"
    lines = gsi(setups, sights, width=16, length="m5")
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")
    api.import_file("gsi", file, folder, fixed=("101", "102"))
    return api.adjust(folder)


def spoilt(sights: list[Sight], kind: str) -> list[Sight]:
    """One mistake at station 104 of a closed traverse 101 to 105."""
    changed = []
    for s in sights:
        if s.at == "104" and kind == "hi":
            s = replace(s, hi=s.hi + 0.1)
        elif (s.at, s.to) == ("104", "105") and kind == "ht":
            s = replace(s, ht=s.ht + 0.1)
        elif s.at == "104" and kind == "feet":
            s = replace(s, sd=s.sd / FOOT)
        changed.append(s)
    return changed


@pytest.mark.parametrize(
    ("kind", "told", "count"),
    [
        ("hi", "zenith angles at 104: height of the instrument?", 4),
        ("ht", "zenith angles 104-105: height of the target?", 2),
        ("feet", "distances at 104: another unit or constant?", 4),
    ],
)
def test_the_cause_is_named_first(tmp_path: Path, kind: str, told: str, count: int) -> None:
    setups, sights = _traverse(0, 5, 2)
    setups = [replace(s, hi=s.hi + 0.1 * (kind == "hi" and s.name == "104")) for s in setups]
    result = adjusted(tmp_path, setups, spoilt(sights, kind))
    assert result.global_test.passed is False
    first = result.removals[0]
    assert (first.description, first.left_out, first.passed) == (told, count, True)
    assert len(result.removals) <= MOST_SHOWN
    assert result.to_dict()["removals"][0]["left_out"] == count  # type: ignore[index]


def test_where_one_observation_is_the_fault_no_group_is_accused(tmp_path: Path) -> None:
    setups, sights = _traverse(1, 5, 2)
    place = next(i for i, s in enumerate(sights) if (s.at, s.to) == ("104", "105"))
    sights[place] = replace(sights[place], sd=sights[place].sd + 3.0)
    result = adjusted(tmp_path, setups, sights)
    assert {item.left_out for item in result.removals} == {1}
    assert "slope_distance 104-105" in result.removals[0].description


CONNECTING = """format = 1
name = "t"
[[station]]
name = "A"
e = 0.0
n = 0.0
fixed = true
[[station]]
name = "B"
e = 100.0
n = 120.0
fixed = true
[[station]]
name = "P"
[[station]]
name = "Q"
[[station]]
name = "C"
e = 500.0
n = 120.0
fixed = true
[[station]]
name = "D"
e = 600.0
n = 0.0
fixed = true
[[traverse]]
name = "main"
book = "observations/main.csv"
sigma_angle_arcsec = 5.0
sigma_distance = { mm = 3.0, ppm = 3.0 }
"""


def _book(distance: float) -> str:
    """B (100, 120), P (200, 220), Q (400, 220), C (500, 120): every angle by hand."""
    side = 141.4214
    rows = (
        "angle,B,A,P,185.194429,deg",  # azimuth B-A 219.805571
        "angle,P,B,Q,225,deg",
        "angle,Q,P,C,225,deg",
        "angle,C,Q,D,185.194429,deg",
        f"distance,B,,P,{side},m",
        f"distance,P,,Q,{distance},m",
        f"distance,Q,,C,{side},m",
    )
    return "kind,at,from,to,value,unit\n" + "".join(f"{row}\n" for row in rows)


@pytest.mark.parametrize("factor", [3.28084, 20.0])
def test_what_does_not_converge_tells_without_which_it_does(tmp_path: Path, factor: float) -> None:
    folder = project(tmp_path / "p")
    (folder / "project.toml").write_text(CONNECTING, encoding="utf-8")
    (folder / "observations").mkdir()
    (folder / "observations/main.csv").write_text(_book(200.0 * factor), encoding="utf-8")
    with pytest.raises(SurveyError, match="does not converge") as refused:
        api.adjust(folder)
    assert "the likeliest first: line 7, distance P-Q" in refused.value.problems[0].hint
