"""The three sample projects read without a warning and hold what their sources printed."""

import json
import math
import os
import subprocess
import sys
from pathlib import Path

import pytest

from surveyapp.domain.readings import ReadingKind, Side
from surveyapp.io.project import read_project
from surveyapp_models.angles import ARCSEC, AngleUnit, parse_angle

PROJECTS = Path(__file__).parents[2] / "projects"
SAMPLES = ("gi-b1-1966", "johannesburg-1966", "tongjin-2015")


@pytest.mark.parametrize("name", SAMPLES)
def test_sample_reads_without_warnings(name: str) -> None:
    project = read_project(PROJECTS / name)
    assert project.warnings == ()
    assert len(project.digest) == 64
    expected = json.loads((PROJECTS / name / "expected.json").read_text(encoding="utf-8"))
    known = {session.id for session in project.sessions}
    assert {item["id"] for item in expected.get("sessions", ())} <= known


def test_johannesburg_holds_twenty_turning_points_from_the_left() -> None:
    book = read_project(PROJECTS / "johannesburg-1966").sessions[0].book
    points = book.of_kind(ReadingKind.REVERSAL)
    assert [p.side for p in points] == [Side.LEFT, Side.RIGHT] * 10
    assert points[0].value == pytest.approx(math.radians(179 + 1 / 60 + 56 / 3600))


def test_gi_b1_has_its_tape_zeros_before_the_run() -> None:
    book = read_project(PROJECTS / "gi-b1-1966").sessions[0].book
    zeros = book.of_kind(ReadingKind.TAPE_ZERO)
    assert [z.side for z in zeros] == [Side.RIGHT, Side.LEFT] * 3
    assert {str(book.place_of(z)) for z in zeros} == {"before"}


def test_tongjin_keeps_the_printed_bearings_and_rounds() -> None:
    project = read_project(PROJECTS / "tongjin-2015")
    session = project.session("G3007-G3006")
    assert session.azimuth_known == pytest.approx(parse_angle("246-52-09", AngleUnit.DMS))
    assert dict(session.override)["rounds"] == 3
    assert project.instruments[0].card.sigma.azimuth == pytest.approx(5.0 * ARCSEC)


def test_reading_a_project_imports_nothing_slow() -> None:
    code = (
        "import sys; from pathlib import Path; from surveyapp.io.project import read_project;"
        f"read_project(Path({str(PROJECTS / 'tongjin-2015')!r}));"
        "slow = {'tomlkit', 'filelock', 'platformdirs', 'scipy', 'pyproj'} & set(sys.modules);"
        "sys.exit(str(slow) if slow else 0)"
    )
    root = PROJECTS.parent
    path = f"{root}{os.pathsep}{root / 'models'}"
    environment = {**os.environ, "PYTHONPATH": path}
    subprocess.run([sys.executable, "-c", code], check=True, env=environment)
