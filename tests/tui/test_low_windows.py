"""In a low window the readings and gyro north are seen, and the keys that lead on and out."""

from __future__ import annotations

from pathlib import Path

import pytest
from textual.widgets._footer import FooterKey

from surveyapp.core.simulate.session import book_text
from surveyapp.tui.app import SurveyApp
from surveyapp.tui.widgets.entry import EntryLine
from surveyapp.tui.widgets.ledger import Ledger
from surveyapp.tui.widgets.run import RunPane
from surveyapp.tui.widgets.swing import SwingPlot
from tests.tui.helpers_tui import (
    SMALL,
    Clock,
    make_project,
    open_session,
    settle,
    simulated,
)

LONG = "The moment lies before the last row, and the reading beyond the forecast. " * 3


async def test_north_and_the_latest_readings_are_seen_beside_a_long_message(
    tmp_path: Path,
) -> None:
    folder = make_project(tmp_path / "p")
    book = folder / "observations" / "r1.csv"
    book.write_text(book_text(simulated(points=12).rows[:17]), encoding="utf-8")
    clock = Clock()
    clock.pass_by(2900.0)
    app = SurveyApp(str(folder), now=clock.now, steady=clock.steady)
    async with app.run_test(size=SMALL) as pilot:
        screen = await open_session(pilot)
        screen.query_one(EntryLine).tell(LONG, serious=True)
        for size in (SMALL, (60, 18)):
            await pilot.resize_terminal(*size)
            await settle(pilot)
            pane = screen.query_one(RunPane).region
            facts, ledger = screen.query_one("#facts").region, screen.query_one(Ledger).region
            assert facts.y + 1 < pane.bottom, "gyro north and its interval"
            assert min(ledger.bottom, pane.bottom) - ledger.y >= 3, "head and two readings"
            assert screen.query_one(SwingPlot).size.height <= pane.height // 3
            keys = {key.key for key in screen.query(FooterKey)}
            assert {"f1", "f8", "escape"} <= keys


@pytest.mark.parametrize("size", [(60, 18)])
async def test_the_key_that_goes_on_stays_where_others_find_no_room(
    tmp_path: Path, size: tuple[int, int]
) -> None:
    app = SurveyApp(str(make_project(tmp_path / "p")))
    async with app.run_test(size=size) as pilot:
        await settle(pilot)
        await pilot.press("enter", "f8")
        await settle(pilot)
        keys = {key.key for key in app.screen.query(FooterKey)}
        assert "f3" in keys, "a step with faces: more keys than columns"
        assert {"f1", "f8", "escape"} <= keys
