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


def test_angles_of_directions_are_the_mean_of_their_sets(tmp_path: Path) -> None:
    """From A to <C> in two turned sets: 90-00-04 and, over the zero, 90-00-08: 90-00-06."""
    rows = (
        *("direction,B,A,10-00-00,dms,1/1", "direction,B,<C>,100-00-04,dms,1/1"),
        *("direction,B,A,299-59-58,dms,1/2", "direction,B,<C>,30-00-06,dms,1/2"),
        "distance,B,<C>,80.0,m,",
    )
    folder = project(tmp_path / "p", MORE)
    (folder / "observations").mkdir()
    book = "kind,at,to,value,unit,set\n" + "\n".join(rows) + "\n"
    (folder / "observations" / "main.csv").write_text(book, encoding="utf-8")
    written = api.write_sheets(folder, tmp_path / "r.pdf")
    table = next(Path(name) for name in written.paths if name.endswith(".csv"))
    found = {row["target"]: row for row in csv.DictReader(table.read_text("utf-8").splitlines())}
    assert (found["<C>"]["back"], found["<C>"]["sets"]) == ("A", "2")
    angle = parse_angle(found["<C>"]["angle"], AngleUnit.DMS)
    assert math.degrees(angle) * 3600 == pytest.approx(90 * 3600 + 6, abs=0.051)
    assert found["A"]["angle"] == ""


def test_traverses_whose_names_become_one_file_name_stay_two(tmp_path: Path) -> None:
    second = MORE[MORE.index("[[traverse]]") :].replace('"main"', '"M a"')
    third = second.replace('"M a"', '"m_a"')
    folder = project(tmp_path / "p", MORE + second + third)
    (folder / "observations").mkdir()
    (folder / "observations" / "main.csv").write_text(BOOK, encoding="utf-8")
    written = api.write_sheets(folder, tmp_path / "r.pdf")
    tables = {Path(name).name for name in written.paths if name.endswith(".csv")}
    assert {name.casefold() for name in tables} == {
        *("r-traverse-main.csv", "r-traverse-m_a.csv", "r-traverse-m_a-2.csv")
    }
