"""Loops of levelling: length, millimetres per root of a kilometre, allowed value, verdict."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

from surveyapp import api
from surveyapp.cli.main import main
from surveyapp.core.network.closures import network_closures
from surveyapp.domain.adjustment import Closure
from surveyapp.errors import SurveyError
from surveyapp.io.exporters.gkf import gkf_text
from surveyapp.io.importers.gkf import read_gkf

GKF = """<?xml version="1.0"?>
<gama-local xmlns="http://www.gnu.org/software/gama/gama-local">
<network><parameters sigma-apr="2"/>
<points-observations>
<point id="A" z="100" fix="z"/><point id="B" adj="z"/><point id="C" adj="z"/>
<height-differences>
{rows}
</height-differences>
</points-observations></network></gama-local>
"""
ROWS = (
    '<dh from="A" to="B" val="1.000" dist="1.0"/>',
    '<dh from="B" to="C" val="2.000" dist="2.25"/>',
    '<dh from="C" to="A" val="{back}" dist="3.0" stdev="3"/>',
)


def gkf(folder: Path, *, back: str = "-3.006", rows: tuple[str, ...] = ROWS) -> Path:
    path = folder / "level.gkf"
    path.write_text(GKF.format(rows="\n".join(rows).format(back=back)), encoding="utf-8")
    return path


def loop(path: Path) -> Closure:
    found = [c for c in network_closures(read_gkf(path)) if c.kind == "height"]
    assert len(found) == 1
    return found[0]


def test_a_loop_by_hand(tmp_path: Path) -> None:
    """6.25 km, -6 mm: -2.4 mm per root of km; sigmas 2, 3 (from dist) and 3 mm (stated)."""
    closure = loop(gkf(tmp_path))
    values = closure.to_dict()
    assert values["length_m"] == pytest.approx(6250.0)
    assert abs(values["height_m"]) == pytest.approx(0.006)  # type: ignore[arg-type]
    assert abs(values["height_mm_per_sqrt_km"]) == pytest.approx(2.4)  # type: ignore[arg-type]
    assert values["height_allowed_m"] == pytest.approx(3e-3 * math.sqrt(4 + 9 + 9))
    assert values["pass"] is True


def test_a_loop_beyond_the_allowed_value_is_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = gkf(tmp_path, back="-3.020")
    main(["adjust", str(path)])
    text = capsys.readouterr().out
    line = next(line for line in text.splitlines() if line.lstrip().startswith("A - B - C"))
    assert [cell.lstrip("+-") for cell in line.split()[5:]] == [
        *("6.250", "20.00", "8.00", "14.07", "NO")
    ]
    main(["adjust", str(path), "--json"])
    closure = json.loads(capsys.readouterr().out)["closures"][0]
    assert closure["pass"] is False
    assert abs(closure["height_mm_per_sqrt_km"]) == pytest.approx(8.0)


def test_without_the_length_of_a_section_there_is_no_rate(tmp_path: Path) -> None:
    rows = (ROWS[0], ROWS[1].replace('dist="2.25"', 'stdev="3"'), ROWS[2])
    values = loop(gkf(tmp_path, rows=rows)).to_dict()
    assert values["length_m"] is None
    assert values["height_mm_per_sqrt_km"] is None
    assert values["height_allowed_m"] == pytest.approx(3e-3 * math.sqrt(22))


def test_dist_is_written_again(tmp_path: Path) -> None:
    network = read_gkf(gkf(tmp_path))
    assert [obs.length_m for obs in network.observations] == [1000.0, 2250.0, 3000.0]
    copy = tmp_path / "copy.gkf"
    copy.write_text(gkf_text(network), encoding="utf-8")
    again = read_gkf(copy)
    for old, new in zip(network.observations, again.observations, strict=True):
        assert (new.length_m, new.value) == (old.length_m, old.value)
        assert new.sigma == pytest.approx(old.sigma, rel=1e-14)


@pytest.mark.parametrize("dist", ["0", "-1", "x"])
@pytest.mark.parametrize("stdev", ["", ' stdev="2"'])
def test_a_section_without_length_is_refused_once(tmp_path: Path, dist: str, stdev: str) -> None:
    row = ROWS[1].replace('dist="2.25"', f'dist="{dist}"{stdev}')
    with pytest.raises(SurveyError) as refused:
        read_gkf(gkf(tmp_path, rows=(ROWS[0], row, ROWS[2])))
    assert len(refused.value.problems) == 1
    assert "line 8" in refused.value.problems[0].where


BOOK = """kind,at,from,to,value,unit,sigma,sigma_unit,length_m
height_difference,A,,B,1.000,m,2,mm,1000
height_difference,B,,C,2.000,m,3,mm,{length}
height_difference,C,,A,-3.006,m,3,mm,3000
"""
PROJECT = """format = 1
name = "level"
[[station]]
name = "A"
e = 0.0
n = 0.0
h = 100.0
fixed = true
[[station]]
name = "B"
[[station]]
name = "C"
[[traverse]]
name = "main"
book = "main.csv"
"""


def book(folder: Path, length: str) -> Path:
    (folder / "project.toml").write_text(PROJECT, encoding="utf-8")
    (folder / "main.csv").write_text(BOOK.format(length=length), encoding="utf-8")
    return folder


def test_a_book_states_the_lengths(tmp_path: Path) -> None:
    closure = api.adjust(book(tmp_path, "2250")).closures[0]
    assert closure.length_m == pytest.approx(6250.0)
    assert abs(closure.height_per_sqrt_km or 0.0) == pytest.approx(2.4)


@pytest.mark.parametrize("length", ["0", "-5", "long"])
def test_a_book_with_an_impossible_length_is_refused(tmp_path: Path, length: str) -> None:
    with pytest.raises(SurveyError, match="length"):
        api.adjust(book(tmp_path, length))


def test_a_section_levelled_there_and_back_closes_on_itself(tmp_path: Path) -> None:
    """1.002 m forth and 1.006 m back over 400 m each: -4 mm, 4.47 mm per root of 0.8 km."""
    rows = (
        '<dh from="A" to="B" val="1.002" dist="0.4"/>',
        '<dh from="B" to="A" val="-1.006" dist="0.4"/>',
        '<dh from="B" to="C" val="2.001" dist="0.5"/>',
    )
    closures = network_closures(read_gkf(gkf(tmp_path, rows=rows)))
    assert [item.stations for item in closures] == [("A", "B", "A")]
    found = closures[0].to_dict()
    assert found["height_m"] == pytest.approx(-0.004)
    assert found["length_m"] == pytest.approx(800.0)
    assert found["height_mm_per_sqrt_km"] == pytest.approx(-4.0 / math.sqrt(0.8))
    sigma = 2e-3 * math.sqrt(0.8)  # 2 mm per root of a kilometre, two runs
    assert found["height_allowed_m"] == pytest.approx(3.0 * sigma)
    assert found["pass"] is True
