"""The traverse in the survey record: numbers of the adjustment, and a plan true to scale."""

from __future__ import annotations

import math
from pathlib import Path

import pypdf
import pytest

from surveyapp import api
from surveyapp.domain.adjustment import AdjustmentResult
from surveyapp.report.blocks import Figure, KeyValues, Marker, Polyline, Table
from surveyapp.report.plan import plan_figure, round_below
from surveyapp.report.sections import traverse as section
from surveyapp_models.angles import AngleUnit

TOML = """format = 1
name = "T"
angle_unit = "dms"

[[station]]
name = "A"
e = 1000.0
n = 2000.0
fixed = true

[[station]]
name = "B"
e = 1000.0
n = 2100.0
fixed = true

[[station]]
name = "C"

[[station]]
name = "D"

[[traverse]]
name = "main"
book = "observations/main.csv"
sigma_angle_arcsec = 7.0
sigma_distance = { mm = 2.0, ppm = 2.0 }
"""
BOOK = """kind,at,from,to,value,unit,sigma,sigma_unit,set,hi,ht,note
angle,B,A,C,90-00-00,dms,,,,,,
distance,B,,C,50.000,m,,,,,,
angle,C,B,D,180-00-00,dms,,,,,,
distance,C,,D,80.000,m,,,,,,
distance,D,,C,80.003,m,,,,,,
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "observations").mkdir()
    (tmp_path / "project.toml").write_text(TOML, encoding="utf-8")
    (tmp_path / "observations" / "main.csv").write_text(BOOK, encoding="utf-8")
    return tmp_path


def figure_of(result: AdjustmentResult) -> Figure:
    figure = plan_figure(result)
    assert figure is not None
    return figure


def test_round_numbers() -> None:
    assert [round_below(x) for x in (1.0, 1.99, 4.9, 5.0, 0.021, 999.0)] == [
        1.0,
        1.0,
        2.0,
        5.0,
        pytest.approx(0.02),
        500.0,
    ]


def test_the_plan_is_true_to_scale_with_enlarged_ellipses(folder: Path) -> None:
    result = api.adjust(folder)
    figure = figure_of(result)
    fixed = [m.at for m in figure.primitives if isinstance(m, Marker) and m.shape == "square"]
    free = [m.at for m in figure.primitives if isinstance(m, Marker) and m.shape == "dot"]
    assert (len(fixed), len(free)) == (2, 2)
    a, b = fixed
    assert a[0] == pytest.approx(b[0])  # A and B lie north of one another
    scale = (b[1] - a[1]) / 100.0
    assert math.dist(free[0], free[1]) == pytest.approx(80.0015 * scale, rel=1e-6)
    curves = [p.points for p in figure.primitives if isinstance(p, Polyline)]
    assert len(curves) == 2
    ellipse = result.point("D").ellipse
    assert ellipse is not None
    reach = [math.dist(p, free[1]) for p in curves[1]]
    enlarged = float(figure.title.split(" times")[0].split()[-1])
    assert max(reach) == pytest.approx(ellipse.a_m * scale * enlarged, rel=0.01)
    far = curves[1][reach.index(max(reach))]
    azimuth = math.atan2(far[0] - free[1][0], far[1] - free[1][1]) % math.pi
    assert math.cos(2 * (azimuth - ellipse.azimuth)) == pytest.approx(1.0, abs=0.05)
    assert all(0.0 <= x <= figure.width_mm and 0.0 <= y <= figure.height_mm for x, y in curves[1])


def test_the_section_shows_what_the_adjustment_says(folder: Path) -> None:
    result = api.adjust(folder)
    made = section.blocks("main", result, unit=AngleUnit.DMS)
    tables = {block.head[0]: block for block in made if isinstance(block, Table)}
    point = result.point("D")
    row = next(row for row in tables["point"].rows if row[0] == "D")
    assert row[1:3] == (f"{point.e:.4f}", f"{point.n:.4f}")
    assert point.sigma_e is not None
    assert row[3] == f"{point.sigma_e * 1e3:.1f}"
    assert "H m" not in tables["point"].head  # nobody measured heights
    observations = tables["kind"].rows
    assert len(observations) == 5
    back = next(row for row in observations if row[1:3] == ("D", "C"))
    assert back[3] == "80.0030 m"
    assert back[4] == f"{result.observations[4].residual * 1e3:+.1f} mm"
    assert back[6] == f"{result.observations[4].redundancy:.2f}"
    assert observations[0][3] == "90-00-00.0"
    assert observations[0][7] == "-"  # nothing controls it
    facts = dict(next(block for block in made if isinstance(block, KeyValues)).pairs)
    assert facts["degrees of freedom"].startswith("1 (")


def test_every_traverse_of_a_project_is_in_the_record(folder: Path) -> None:
    written = api.report(folder, folder / "record.pdf")
    assert "traverse main" in written.sections
    pages = pypdf.PdfReader(folder / "record.pdf").pages
    text = "\n".join(page.extract_text() for page in pages)
    assert "Traverse main" in text
    assert "times enlarged" in text
    assert "80.0030 m" in text


def test_a_traverse_that_cannot_be_adjusted_says_why_in_the_record(folder: Path) -> None:
    book = folder / "observations" / "main.csv"
    book.write_text(BOOK.replace("angle,C,B,D,180-00-00,dms,,,,,,\n", ""), encoding="utf-8")
    written = api.report(folder, folder / "record.pdf")
    assert "traverse main" in written.sections
    pages = pypdf.PdfReader(folder / "record.pdf").pages
    assert "D" in "\n".join(page.extract_text() for page in pages)
