"""F9 reads a simulated total station into the line; Enter confirms, the book says who read."""

from __future__ import annotations

import csv
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from textual.pilot import Pilot
from textual.widgets import Static

from surveyapp.core.observing.steps import Step
from surveyapp.io.settings import Settings, write_settings
from surveyapp.observation.session import SessionDesk
from surveyapp.tui.app import SurveyApp
from surveyapp.tui.screens.session import SessionScreen
from surveyapp.tui.widgets.entry import EntryLine
from tests.tui.helpers_tui import (
    LARGE,
    Clock,
    make_project,
    settle,
)

if sys.platform == "win32":
    pytest.skip("pseudo-terminals", allow_module_level=True)
from tests.formats import simulated_station as s


def told(pilot: Pilot[int]) -> str:
    return str(pilot.app.screen.query_one("#message", Static).content)


async def test_f9_reads_enter_confirms_and_the_book_says_who(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    config = tmp_path / "config"
    monkeypatch.setattr("surveyapp.io.settings.user_config_folder", lambda: config)
    folder = make_project(tmp_path / "p")
    clock = Clock()
    desk = SessionDesk(folder, "r1", now=clock.now, steady=clock.steady)
    desk.go_to(Step.SIGHTS_BEFORE)
    app = SurveyApp(None)
    async with app.run_test(size=LARGE) as pilot:
        app.push_screen(SessionScreen(desk))
        await settle(pilot)
        line = app.screen.query_one(EntryLine)
        await pilot.press("f9")
        await settle(pilot)
        assert "No instrument is known" in told(pilot)
        with s.Station(s.geocom(lambda: s.radians(43.5), s.radians(91.0), None)) as station:
            write_settings(replace(Settings(), instrument=f"geocom:{station.port}"))
            await pilot.press("f9")
            await settle(pilot)
            assert line.text == "43-30-00.0", told(pilot)
            assert "Enter confirms" in told(pilot)
            assert not rows(folder)  # nothing is written before
            await pilot.press("enter")
            await settle(pilot)
            await pilot.press("f9")  # face right is asked for now
            await settle(pilot)
            assert line.text == ""
            assert "face L, face R is asked for" in told(pilot)
        write_settings(replace(Settings(), instrument="geocom:/dev/no-such-port"))
        await pilot.press("f9")
        await settle(pilot)
        assert "cannot be opened" in told(pilot)
        line.text = "223-30-02"
        await pilot.press("enter")
        await settle(pilot)
    book = rows(folder)
    assert [row["value"] for row in book] == ["43-30-00.0", "223-30-02"]
    assert "read by the instrument, GeoCOM" in book[0]["note"]
    assert book[1]["note"] == ""


def rows(folder: Path) -> list[dict[str, str]]:
    path = folder / "observations" / "r1.csv"
    if not path.exists():
        return []
    with path.open(encoding="utf-8", newline="") as stream:
        return [row for row in csv.DictReader(stream) if row["kind"] == "backsight"]
