"""From the result: the record as PDF, and closing with a signature."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from textual.widgets import Static

from surveyapp import api
from surveyapp.core.observing.steps import Step
from surveyapp.core.simulate.session import book_text, simulate_session
from surveyapp.core.simulate.specification import SessionSpec
from surveyapp.domain.readings import ReadingKind
from surveyapp.errors import SurveyError
from surveyapp.observation.session import NewRow, SessionDesk
from surveyapp.tui.app import SurveyApp
from surveyapp.tui.screens.result import ResultScreen
from surveyapp.tui.views.result import result_headline, result_text
from surveyapp_models.angles import AngleUnit
from tests.tui.helpers_tui import (
    SMALL,
    make_project,
    settle,
    simulated,
)

PROJECTS = Path(__file__).resolve().parents[2] / "projects"


async def test_the_record_is_written_and_the_session_closed_and_signed(tmp_path: Path) -> None:
    folder = make_project(tmp_path / "p")
    text = book_text(simulated(points=8).rows)
    (folder / "observations" / "r1.csv").write_text(text, encoding="utf-8")
    app = SurveyApp(str(folder))
    async with app.run_test(size=SMALL) as pilot:
        await settle(pilot)
        await pilot.press("enter")
        await settle(pilot)
        while app.screen.__class__ is not ResultScreen:
            await pilot.press("f8")
            await settle(pilot)
        await pilot.press("f4")
        await settle(pilot)
        told = str(app.screen.query_one("#told", Static).content)
        assert "record.pdf" in told
        assert (folder / "results" / "record.pdf").read_bytes().startswith(b"%PDF")
        await pilot.press("f6")
        await pilot.pause()
        await pilot.press(*"A. Muster", "enter")
        await settle(pilot)
        assert "A. Muster" in str(app.screen.query_one("#told", Static).content)
    seen = SessionDesk(folder, "r1")
    assert seen.closed
    assert not seen.writable
    assert seen.step is Step.RESULT
    with pytest.raises(SurveyError, match="closed and signed"):
        seen.record(NewRow(ReadingKind.REVERSAL, "102-00-14", "dms"))
    seen.close()


def test_a_calibration_is_headed_by_its_gyro_azimuth() -> None:
    result = api.orient(PROJECTS / "tongjin-2015", session="G3024-G3022")
    head = result_headline(result, "G3024-G3022", AngleUnit.DMS)
    assert head.startswith("G3024-G3022  gyro azimuth 334-15-52.8")


def test_points_on_the_scale_stand_in_divisions(tmp_path: Path) -> None:
    spec = SessionSpec(method="amplitude", points=8, tape_zero_div=(0.2, 0.25))
    simulated_book = book_text(simulate_session(spec, np.random.default_rng(2)).rows)
    folder = make_project(tmp_path / "p", method="amplitude")
    (folder / "observations" / "r1.csv").write_text(simulated_book, encoding="utf-8")
    project = api.open_project(folder)
    result = api.orient(project, session="r1")
    lines = result_text(project, result, "r1", 74).plain.splitlines()
    head = next(i for i, line in enumerate(lines) if line.split()[:2] == ["point", "seq"])
    assert "residual div" in lines[head]
    assert [line.split()[0] for line in lines[head + 1 : head + 9]] == list("12345678")
