"""Points of a run have one number, from 1 and with missed ones, wherever a surveyor reads it."""

from __future__ import annotations

import contextlib
import io
import re
from pathlib import Path

import numpy as np
import pytest

from surveyapp import api
from surveyapp.cli.main import main
from surveyapp.core.simulate.session import book_text, simulate_session
from surveyapp.core.simulate.specification import SessionSpec
from surveyapp.io.project import read_project
from surveyapp.observation.session import progress
from surveyapp.report.plots import axis
from surveyapp.report.sections.reduction import blocks
from surveyapp.report.text import blocks_text
from surveyapp.tui.views.progress import alert_text
from surveyapp_models.angles import AngleUnit, format_angle, parse_angle
from tests.tui.helpers_tui import make_project

SLIP, MISSED = 9, 3


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run whose third turning point was missed and whose ninth is two minutes off."""
    place = make_project(tmp_path_factory.mktemp("numbers") / "p")
    session = simulate_session(SessionSpec(points=14, times=True), np.random.default_rng(3))
    lines, count = [], 0
    for line in book_text(session.rows).splitlines():
        cells = line.split(",")
        count += "reversal" in cells
        if "reversal" in cells and count == MISSED:
            cells[3:8] = ["missed", "", "", "", ""]
        elif "reversal" in cells and count == SLIP:
            value = parse_angle(cells[4], AngleUnit.DMS) + np.radians(2.0 / 60.0)
            cells[4] = format_angle(value, AngleUnit.DMS)
        lines.append(",".join(cells))
    book = place / "observations" / "r1.csv"
    book.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return place


def test_alarm_check_diagnosis_and_record_say_the_same_number(folder: Path) -> None:
    seen = progress(read_project(folder), "r1")
    assert f"Point {SLIP} " in alert_text(seen, "tracking")
    check = next(c for c in api.check(folder) if c.rule == "fit.largest_residual")
    assert f"turning point {SLIP} " in check.text
    words = " ".join(" ".join(diagnosis_words(folder)).split())
    assert "Gross error of a reading" in words
    assert f"at turning point {SLIP}:" in words
    result = api.orient(folder)
    table = blocks_text(blocks(api.open_project(folder), result))
    rows = {int(m[1]): m[2] for m in re.finditer(r"^ *(\d+) +(\d+) +[LR] ", table, re.MULTILINE)}
    assert MISSED not in rows
    assert rows[SLIP] == str(seen.alert.seq if seen.alert else "")


def diagnosis_words(folder: Path) -> list[str]:
    """What ``diagnose`` prints."""
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        assert main(["diagnose", str(folder), "--session", "r1"]) == 0
    return out.getvalue().splitlines()


@pytest.mark.parametrize("points", [3, 4, 7, 14, 61])
def test_an_axis_of_points_has_whole_ticks(points: int) -> None:
    made = axis([float(k + 1) for k in range(points)], count=10, whole=True)
    assert all(tick == round(tick) for tick in made.ticks)
    assert made.decimals == 0
    assert 2 <= len(made.ticks) <= 11
