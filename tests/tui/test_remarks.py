"""A remark at any time, and a book that is typed up afterwards."""

from __future__ import annotations

from pathlib import Path

from textual.widgets import Static

from surveyapp.core.observing.steps import Step
from surveyapp.tui.app import SurveyApp
from surveyapp.tui.screens.session import SessionScreen
from surveyapp.tui.widgets.entry import EntryLine
from tests.tui.helpers_tui import SMALL, make_project, rows_on_disk


async def test_a_remark_leaves_the_line_alone_and_a_typed_up_book_has_no_moments(
    tmp_path: Path,
) -> None:
    folder = make_project(tmp_path / "p")
    app = SurveyApp(str(folder))
    async with app.run_test(size=SMALL) as pilot:
        for _ in range(2):
            await app.workers.wait_for_complete()
            await pilot.pause()
        if not isinstance(app.screen, SessionScreen):
            await pilot.press("enter")
            await pilot.pause()
        screen = app.screen
        assert isinstance(screen, SessionScreen)
        await pilot.press("f8", *"179-01", "ctrl+n")
        await pilot.pause()
        await pilot.press(*"weather dry", "enter")
        await pilot.pause()
        assert "weather dry" in str(screen.query_one("#message", Static).content)
        assert screen.query_one(EntryLine).text == "179-01"
        assert screen.desk.step is Step.SIGHTS_BEFORE
        await pilot.press(*"-56", "enter", "ctrl+o")
        await pilot.pause()
        assert "typing up" in str(screen.query_one("#message", Static).content)
        await pilot.press(*"359-02-12", "enter")
        await pilot.pause()
    rows = rows_on_disk(folder)
    assert [(r["kind"], r["value"] or r["note"]) for r in rows[1:]] == [
        ("note", "weather dry"),
        ("backsight", "179-01-56"),
        ("backsight", "359-02-12"),
    ]
    assert [bool(row["time"]) for row in rows[1:]] == [True, True, False]
