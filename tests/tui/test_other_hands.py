"""A field book that another hand edits while it is open: taken over, told, not written over."""

from __future__ import annotations

from pathlib import Path

import pytest
from textual.pilot import Pilot
from textual.widgets import Static

from surveyapp.core.observing.steps import Step
from surveyapp.domain.readings import ReadingKind
from surveyapp.errors import SurveyError
from surveyapp.observation.session import NewRow, SessionDesk
from surveyapp.tui.app import SurveyApp
from surveyapp.tui.screens.session import SessionScreen
from surveyapp.tui.widgets.entry import EntryLine
from surveyapp.tui.widgets.ledger import Ledger
from tests.tui.helpers_tui import SMALL, Clock, make_project, rows_on_disk

BY_HAND = "3,2026-03-02T08:10:00+00:00,600.0,backsight,359-02-12,dms,R,,,,\n"


def opened(tmp_path: Path) -> tuple[SessionDesk, Path, Clock]:
    folder, clock = make_project(tmp_path / "p"), Clock()
    seen = SessionDesk(folder, "r1", now=clock.now, steady=clock.steady)
    seen.go_to(Step.SIGHTS_BEFORE)
    seen.record(NewRow(ReadingKind.BACKSIGHT, "179-01-56", "dms", "L"))
    return seen, folder / "observations" / "r1.csv", clock


def test_a_row_added_by_hand_is_kept_and_the_next_one_stands_behind_it(tmp_path: Path) -> None:
    seen, book, _ = opened(tmp_path)
    assert not seen.changed_outside()
    with book.open("a", encoding="utf-8") as stream:
        stream.write(BY_HAND)
    assert seen.changed_outside()
    with pytest.raises(SurveyError, match="another hand"):
        seen.record(NewRow(ReadingKind.BACKSIGHT, "179-01-58", "dms", "L"))
    assert [row.seq for row in seen.book.rows] == [1, 2, 3]
    assert seen.record(NewRow(ReadingKind.BACKSIGHT, "179-01-58", "dms", "L")) == 4
    seen.close()
    rows = rows_on_disk(tmp_path / "p")
    assert [row["value"] for row in rows] == ["", "179-01-56", "359-02-12", "179-01-58"]
    assert float(rows[-1]["elapsed_s"]) >= 600.0


def test_a_book_that_was_made_unreadable_is_not_written_to(tmp_path: Path) -> None:
    seen, book, _ = opened(tmp_path)
    before = book.read_text(encoding="utf-8")
    book.write_text(before + "total garbage;;\n", encoding="utf-8")
    for _ in range(2):
        with pytest.raises(SurveyError, match="seq"):
            seen.record(NewRow(ReadingKind.BACKSIGHT, "359-02-12", "dms", "R"))
    assert book.read_text(encoding="utf-8") == before + "total garbage;;\n"
    book.write_text(before, encoding="utf-8")
    seen.read_again()
    assert seen.record(NewRow(ReadingKind.BACKSIGHT, "359-02-12", "dms", "R")) == 3
    seen.close()


def told(pilot: Pilot[int]) -> str:
    return str(pilot.app.screen.query_one("#message", Static).content)


async def test_the_screen_shows_what_another_hand_wrote_and_keeps_what_is_typed(
    tmp_path: Path,
) -> None:
    seen, book, _ = opened(tmp_path)
    seen.close()
    app = SurveyApp(str(tmp_path / "p"))
    async with app.run_test(size=SMALL) as pilot:
        await pilot.app.workers.wait_for_complete()
        await pilot.pause()
        if not isinstance(app.screen, SessionScreen):
            await pilot.press("enter")
            await pilot.pause()
        screen = app.screen
        assert isinstance(screen, SessionScreen)
        await pilot.press(*"02 1")
        with book.open("a", encoding="utf-8") as stream:
            stream.write(BY_HAND)
        screen.watch_book()
        await pilot.pause()
        assert "another hand" in told(pilot)
        assert "359-02-12" in str(
            screen.query_one(Ledger).query_one("#ledger-rows", Static).content
        )
        assert screen.query_one(EntryLine).text == "02 1"
        book.write_text(book.read_text(encoding="utf-8") + "x;y\n", encoding="utf-8")
        screen.watch_book()
        await pilot.pause()
        assert "cannot be read" in told(pilot)
        assert screen.query_one(EntryLine).text == "02 1"


def test_a_second_opener_reads_along_and_looks_at_every_step(tmp_path: Path) -> None:
    first, book, clock = opened(tmp_path)
    second = SessionDesk(tmp_path / "p", "r1", now=clock.now, steady=clock.steady)
    assert not second.writable
    before = book.read_bytes()
    second.go_to(Step.RESULT)
    assert second.step is Step.RESULT
    assert book.read_bytes() == before
    first.record(NewRow(ReadingKind.BACKSIGHT, "359-02-12", "dms", "R"))
    assert second.changed_outside()
    second.read_again()
    assert second.step is Step.RESULT
    assert [row.text for row in second.book.rows[1:]] == ["179-01-56", "359-02-12"]
    with pytest.raises(SurveyError, match="cannot be written"):
        second.record(NewRow(ReadingKind.BACKSIGHT, "179-01-58", "dms", "L"))
    second.close()
    assert first.record(NewRow(ReadingKind.BACKSIGHT, "179-01-58", "dms", "L")) == 4
    first.close()
