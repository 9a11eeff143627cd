"""From the result: the record as PDF, and closing with a signature."""

from __future__ import annotations

from pathlib import Path

import pytest
from helpers_tui import SMALL, make_project, simulated
from textual.pilot import Pilot
from textual.widgets import Static

from surveyapp.api_session import NewRow, Observation
from surveyapp.core.simulate.session import book_text
from surveyapp.core.steps import Step
from surveyapp.domain.readings import ReadingKind
from surveyapp.errors import SurveyError
from surveyapp.tui.app import SurveyApp
from surveyapp.tui.screens.result import ResultScreen


async def settle(pilot: Pilot[int]) -> None:
    for _ in range(2):
        await pilot.app.workers.wait_for_complete()
        await pilot.pause()


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
    seen = Observation(folder, "r1")
    assert seen.closed
    assert not seen.writable
    assert seen.step is Step.RESULT
    with pytest.raises(SurveyError, match="closed and signed"):
        seen.record(NewRow(ReadingKind.REVERSAL, "102-00-14", "dms"))
    seen.close()
