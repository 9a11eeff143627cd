"""The sheets of the trade: numbers of the commands, a table that any reader can read."""

from __future__ import annotations

import csv
import json
import math
from html.parser import HTMLParser
from pathlib import Path

import pytest

from surveyapp import api
from surveyapp.report.sheets import Sheet, sheet_csv, sheet_html
from surveyapp_models.angles import AngleUnit, parse_angle
from tests.cli.command import run
from tests.formats.importing import project

ROOT = Path(__file__).parents[2]
MORE = """
[[station]]
name = "A"
e = 0.0
n = 0.0
h = 10.0
fixed = true
[[station]]
name = "B"
e = 0.0
n = 100.0
h = 11.0
fixed = true
[[station]]
name = "<C>"
[[traverse]]
name = "main"
book = "observations/main.csv"
sigma_angle_arcsec = 5.0
sigma_distance = { mm = 2.0, ppm = 2.0 }
"""
BOOK = """kind,at,from,to,value,unit,hi,ht
angle,B,A,<C>,270-00-00,dms,,
slope_distance,B,,<C>,80.0,m,1.5,1.5
zenith,B,,<C>,90-00-00,dms,1.5,1.5
"""


class Cells(HTMLParser):
    """Cells of a table, by the parser of the standard library."""

    def __init__(self) -> None:
        super().__init__()
        self.rows: list[list[str]] = []
        self.inside = False

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag == "tr":
            self.rows.append([])
        if tag in ("td", "th"):
            self.inside = True
            self.rows[-1].append("")

    def handle_endtag(self, tag: str) -> None:
        self.inside = self.inside and tag not in ("td", "th")

    def handle_data(self, data: str) -> None:
        if self.inside:
            self.rows[-1][-1] += data


def test_the_traverse_sheet(tmp_path: Path) -> None:
    folder = project(tmp_path / "p", MORE)
    (folder / "observations").mkdir()
    (folder / "observations" / "main.csv").write_text(BOOK, encoding="utf-8")
    result = run("report", str(folder), "-o", str(tmp_path / "r.pdf"), "--sheets", "--json")
    assert result.code == 0, result.err
    sheets = json.loads(result.out)["sheets"]
    assert [Path(p).name for p in sheets] == ["r-traverse-main.csv", "r-traverse-main.html"]
    with Path(sheets[0]).open(encoding="utf-8", newline="") as stream:
        row = next(csv.DictReader(stream))
    assert (row["station"], row["target"], row["back"]) == ("B", "<C>", "A")
    assert row["angle"] == "270-00-00.0"
    assert (row["slope m"], row["level m"]) == ("80.0000", "80.0000")
    assert row["grid azimuth"] == "90-00-00.0"
    assert (row["E m"], row["N m"], row["H m"]) == ("80.0000", "100.0000", "11.0000")
    parser = Cells()
    parser.feed(Path(sheets[1]).read_text(encoding="utf-8"))
    assert parser.rows[0] == list(row)
    assert parser.rows[1] == list(row.values())


def test_the_gyro_sheet_of_a_measured_sample(tmp_path: Path) -> None:
    folder = ROOT / "projects" / "tongjin-2015"
    written = api.write_sheets(folder, tmp_path / "record.pdf")
    assert written.problems == ()
    paths = written.paths
    lines = api.orient(folder).lines
    with Path(paths[0]).open(encoding="utf-8", newline="") as stream:
        text = stream.read().split("\n\n")[0]
    rows = list(csv.reader(text.splitlines()))
    place = rows[0].index("grid azimuth")
    assert len(rows) == 1 + len(lines)
    for row, line in zip(rows[1:], lines, strict=True):
        assert (row[0], row[1]) == (line.station, line.target)
        assert line.grid_azimuth is not None
        value = parse_angle(row[place], AngleUnit.DMS)
        assert value == pytest.approx(line.grid_azimuth.value, abs=math.radians(0.06 / 3600))


def test_texts_are_no_formulas_and_no_tags() -> None:
    sheet = Sheet("x", "<b>", ("a",), (("=1+1",), ("-5.0",), ("<script>",)), ("@x",))
    assert sheet_csv(sheet).splitlines() == ["a", "'=1+1", "-5.0", "<script>", "", "'@x"]
    assert "<script>" not in sheet_html(sheet, project="&", software="s")
