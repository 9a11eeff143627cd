"""A whole session is typed on the screen; the book gives to the last digit what it must."""

from __future__ import annotations

import errno
import os
from pathlib import Path

import pytest
from textual.pilot import Pilot
from textual.widgets import Static

from surveyapp import api
from surveyapp.core.observing.steps import Step
from surveyapp.core.simulate.session import book_text
from surveyapp.domain.readings import ReadingKind
from surveyapp.observation.session import NewRow, SessionDesk
from surveyapp.tui import texts
from surveyapp.tui.app import SurveyApp
from surveyapp.tui.screens.help import HelpScreen
from surveyapp.tui.screens.project import ProjectScreen
from surveyapp.tui.screens.result import ResultScreen
from surveyapp.tui.screens.session import SessionScreen
from surveyapp.tui.widgets.entry import EntryLine
from surveyapp.tui.widgets.run import RunPane
from surveyapp.tui.widgets.titlebar import TitleBar
from tests.tui.helpers_tui import (
    SMALL,
    Clock,
    make_project,
    open_session,
    readings,
    rows_on_disk,
    settle,
    simulated,
)


async def enter(pilot: Pilot[int], text: str) -> None:
    """Type a text and press Enter; the run is judged before the next."""
    entry = pilot.app.screen.query_one(EntryLine)
    entry.text = text
    await pilot.press("enter")
    await settle(pilot)


def told(screen: SessionScreen) -> str:
    return str(screen.query_one("#message", Static).content)


async def go_to(pilot: Pilot[int], screen: SessionScreen, step: Step) -> None:
    for _ in range(10):
        if screen.desk.step is step:
            return
        await pilot.press("f8")
        await settle(pilot)
    raise AssertionError(step)


ORDER = {
    "tape_zero": (Step.ZERO_BEFORE, Step.ZERO_AFTER),
    "backsight": (Step.SIGHTS_BEFORE, Step.SIGHTS_AFTER),
    "reversal": (Step.SWING, Step.SWING),
}


async def test_a_whole_tracking_session_typed_gives_what_orient_gives(tmp_path: Path) -> None:
    session = simulated(points=9)
    folder = make_project(tmp_path / "p")
    swing = [i for i, row in enumerate(session.rows) if row["kind"] == "reversal"]
    before = sorted(session.rows[: swing[0]], key=lambda r: r["kind"])
    during = list(session.rows[swing[0] : swing[-1] + 1])
    after = sorted(session.rows[swing[-1] + 1 :], key=lambda r: r["kind"], reverse=True)
    typed = [*before, *during, *after]
    app = SurveyApp(str(folder))
    async with app.run_test(size=SMALL) as pilot:
        screen = await open_session(pilot)
        for number, row in enumerate(typed):
            place = 0 if number < len(before) + len(during) else 1
            await go_to(pilot, screen, ORDER[row["kind"]][place])
            await enter(pilot, row["value"])
            assert told(screen).startswith("on disk: row"), (row, told(screen))
        await pilot.press("f8")
        await settle(pilot)
        await pilot.press("f8")
        await settle(pilot)
        assert isinstance(app.screen, ResultScreen)
        assert app.screen.result is not None
        shown = app.screen.result.to_dict()
    assert readings(rows_on_disk(folder)) == [(row["kind"], row["value"]) for row in typed]
    expected = api.orient(folder, session="r1").to_dict()
    assert shown == expected
    # another hand: the same readings and moments, without the screen's notes, sides written down
    other = make_project(tmp_path / "other")
    kept = [row for row in rows_on_disk(folder) if row["kind"] != "note"]
    plain = [
        {**row, "side": source["side"], "seq": str(number)}
        for number, (row, source) in enumerate(zip(kept, typed, strict=True), 1)
    ]
    (other / "observations" / "r1.csv").write_text(book_text(tuple(plain)), encoding="utf-8")
    by_hand = api.orient(other, session="r1").to_dict()["sessions"][0]
    assert shown["sessions"][0]["gyro_north"] == by_hand["gyro_north"]
    assert shown["sessions"][0]["gyro_azimuth"] == by_hand["gyro_azimuth"]
    truth = 100.0  # degrees; what the simulated session was made with
    assert by_hand["gyro_north"]["deg"] == pytest.approx(truth, abs=20.0 / 3600.0)


async def test_short_forms_misses_strikes_and_undo(tmp_path: Path) -> None:
    folder = make_project(tmp_path / "p")
    app = SurveyApp(str(folder))
    async with app.run_test(size=SMALL) as pilot:
        screen = await open_session(pilot)
        await go_to(pilot, screen, Step.SWING)
        for text in ("102-00-14", "98-01-04", "59 08", "02 30", "101-58-02"):
            await enter(pilot, text)
        await pilot.press("f5")
        await settle(pilot)
        assert "missed" in told(screen)
        await enter(pilot, "56-50")
        await pilot.press("ctrl+z")
        await settle(pilot)
        await pilot.press("f6")
        await pilot.pause()
        await pilot.press("down", *"shaky", "enter")
        await settle(pilot)
        assert "shaky" in told(screen)
    rows = rows_on_disk(folder)
    assert readings(rows) == [
        ("reversal", "102-00-14"),
        ("reversal", "98-01-04"),
        ("reversal", "101-59-08"),
        ("reversal", "98-02-30"),
        ("reversal", "101-58-02"),
        ("missed", ""),
        ("reversal", "101-56-50"),
        ("strike", rows[-2]["value"]),
        ("strike", rows[-1]["value"]),
    ]
    struck = {row["seq"]: row for row in rows}
    assert struck[rows[-2]["value"]]["value"] == "101-56-50"
    assert struck[rows[-1]["value"]]["kind"] == "reversal"


async def test_an_implausible_reading_is_asked_for_once_and_then_written(tmp_path: Path) -> None:
    folder = make_project(tmp_path / "p")
    app = SurveyApp(str(folder))
    async with app.run_test(size=SMALL) as pilot:
        screen = await open_session(pilot)
        await go_to(pilot, screen, Step.SWING)
        for text in ("102-00-14", "98-01-04", "101-59-08", "98-02-30"):
            await enter(pilot, text)
        await enter(pilot, "98-58-02")
        assert "other side" in told(screen)
        assert screen.query_one(EntryLine).text == "98-58-02"
        await pilot.press("right", "backspace", "3", "enter")
        await settle(pilot)
        assert "other side" in told(screen), "another text is asked about anew"
        await pilot.press(*"101-48-02", "enter")
        await settle(pilot)
        assert "from the forecast" in told(screen)
        await pilot.press("enter")
        await settle(pilot)
        assert told(screen).startswith("on disk")
        await enter(pilot, "361-00-00")
        assert told(screen).startswith("not written: 361-00-00")
    assert [value for _, value in readings(rows_on_disk(folder))][-1] == "101-48-02"


async def test_escape_keeps_what_is_half_typed_and_the_step_returns(tmp_path: Path) -> None:
    folder = make_project(tmp_path / "p")
    app = SurveyApp(str(folder))
    async with app.run_test(size=SMALL) as pilot:
        screen = await open_session(pilot)
        await go_to(pilot, screen, Step.SWING)
        await enter(pilot, "102-00-14")
        await pilot.press("9", "8", "-", "escape")
        await settle(pilot)
        assert told(screen) == texts.DRAFT_KEPT
        await pilot.press("escape")
        await settle(pilot)
        again = await open_session(pilot)
        assert again is not screen
        assert again.query_one(EntryLine).text == "98-"
        assert again.desk.step is Step.SWING
    app = SurveyApp(str(folder))
    async with app.run_test(size=SMALL) as pilot:
        await settle(pilot)
        await settle(pilot)
        assert isinstance(app.screen, SessionScreen), "an unfinished session opens by itself"
        assert app.screen.desk.step is Step.SWING
        await pilot.press("f1")
        await settle(pilot)
        assert isinstance(app.screen, HelpScreen)
        await pilot.press("escape")
        await settle(pilot)
        assert isinstance(app.screen, SessionScreen)


async def test_what_comes_after_the_first_turning_point_is_not_before_it(tmp_path: Path) -> None:
    folder = make_project(tmp_path / "p")
    app = SurveyApp(str(folder))
    async with app.run_test(size=SMALL) as pilot:
        screen = await open_session(pilot)
        await go_to(pilot, screen, Step.SWING)
        await enter(pilot, "102-00-14")
        await pilot.press("f7", "f7", "f7")
        await settle(pilot)
        assert screen.desk.step is Step.SIGHTS_BEFORE
        await enter(pilot, "175-00-09")
        assert told(screen) == texts.CLOSED_REFUSED
    assert readings(rows_on_disk(folder)) == [("reversal", "102-00-14")]


async def test_a_full_disk_is_told_and_what_was_typed_stays(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = make_project(tmp_path / "p")
    app = SurveyApp(str(folder))
    async with app.run_test(size=SMALL) as pilot:
        screen = await open_session(pilot)
        await go_to(pilot, screen, Step.SWING)

        def full(*_: object) -> int:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

        with monkeypatch.context() as patch:
            patch.setattr(os, "fsync", full)
            await pilot.press(*"102-00-14", "enter")
            await pilot.pause()
            assert told(screen).startswith("NOT written")
            assert screen.query_one(EntryLine).text == "102-00-14"
        await pilot.press("enter")
        await settle(pilot)
        assert told(screen).startswith("on disk")
    assert readings(rows_on_disk(folder)) == [("reversal", "102-00-14")]


async def test_the_second_opener_says_so_and_reads(tmp_path: Path) -> None:
    folder = make_project(tmp_path / "p")
    first = SessionDesk(folder, "r1")
    first.record(NewRow(ReadingKind.REVERSAL, "102-00-14", "dms"))
    app = SurveyApp(str(folder))
    async with app.run_test(size=SMALL) as pilot:
        screen = await open_session(pilot)
        assert screen.query_one(TitleBar).state == texts.READING_ONLY
        await pilot.press(*"98-01-04", "enter")
        await pilot.pause()
        assert told(screen).startswith("NOT written")
    first.close()
    assert readings(rows_on_disk(folder)) == [("reversal", "102-00-14")]


async def test_a_torn_line_is_told(tmp_path: Path) -> None:
    folder = make_project(tmp_path / "p")
    book = folder / "observations" / "r1.csv"
    text = book.read_text(encoding="utf-8")
    book.write_text(text + "1,,,reversal,102-00-14,dms,,,,,\n2,,,reversal,98-0", encoding="utf-8")
    app = SurveyApp(str(folder))
    async with app.run_test(size=SMALL) as pilot:
        screen = await open_session(pilot)
        assert "r1.csv.torn" in told(screen)
    assert readings(rows_on_disk(folder)) == [("reversal", "102-00-14")]


async def test_the_countdown_is_seen_and_heard(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder, clock = make_project(tmp_path / "p"), Clock()
    seen = SessionDesk(folder, "r1", now=clock.now, steady=clock.steady)
    seen.go_to(Step.SWING)
    for value in ("102-00-14", "98-01-04", "101-59-08"):
        seen.record(NewRow(ReadingKind.REVERSAL, value, "dms"))
        clock.pass_by(212.5)
    seen.close()
    rung = []
    app = SurveyApp(str(folder), now=clock.now, steady=clock.steady)
    monkeypatch.setattr(app, "bell", lambda: rung.append(True))
    async with app.run_test(size=SMALL) as pilot:
        await settle(pilot)
        await settle(pilot)
        await settle(pilot)
        screen = app.screen
        assert isinstance(screen, SessionScreen)
        screen.query_one(RunPane).tick()
        await pilot.pause()
        assert "NOW" in str(screen.query_one("#countdown", Static).content)
    assert rung == [True]


async def test_a_second_target_joins_the_round_of_sights(tmp_path: Path) -> None:
    folder = make_project(tmp_path / "p")
    app = SurveyApp(str(folder))
    async with app.run_test(size=SMALL) as pilot:
        screen = await open_session(pilot)
        await go_to(pilot, screen, Step.SIGHTS_BEFORE)
        await enter(pilot, "175-00-09")
        await pilot.press("f4")
        await pilot.press("f3")
        assert (screen.desk.what().target, screen.desk.what().face) == ("3090", "L")
        await enter(pilot, "201-10-20")
        assert (screen.desk.what().target, screen.desk.what().face) == ("3090", "R")
        await enter(pilot, "10 16")
        assert (screen.desk.what().target, screen.desk.what().face) == ("3082", "R")
        await enter(pilot, "354-59-50")
    sights = [r for r in rows_on_disk(folder) if r["kind"] == "backsight"]
    assert [(r["target"], r["face"], r["value"]) for r in sights] == [
        ("", "L", "175-00-09"),
        ("3090", "L", "201-10-20"),
        ("3090", "R", "21-10-16"),
        ("", "R", "354-59-50"),
    ]


async def test_what_is_typed_is_not_left_behind_by_the_next_step(tmp_path: Path) -> None:
    app = SurveyApp(str(make_project(tmp_path / "ramp-3")))
    async with app.run_test(size=SMALL) as pilot:
        screen = await open_session(pilot)
        step = screen.desk.step
        screen.query_one(EntryLine).text = "1.5"
        await pilot.pause()
        await pilot.press("f8")
        await settle(pilot)
        assert screen.desk.step is step
        assert told(screen).startswith(
            "not written: 1.5 (level along) is in the line. Enter writes"
        )
        await pilot.press("f8")
        await settle(pilot)
        assert screen.desk.step is step, "the same key again changes nothing"
        await pilot.press("ctrl+z", "f8")
        await settle(pilot)
        assert screen.desk.step is not step


async def test_the_project_is_read_anew_after_the_result_of_a_session(tmp_path: Path) -> None:
    app = SurveyApp(str(make_project(tmp_path / "ramp-3")))
    async with app.run_test(size=SMALL) as pilot:
        await settle(pilot)
        project = app.screen
        assert isinstance(project, ProjectScreen)
        read: list[bool] = []
        project.action_reload = lambda: read.append(True)  # type: ignore[method-assign]
        await pilot.press("enter")
        await settle(pilot)
        await app.switch_screen(ResultScreen(app.folder or "", "r1", None))
        await settle(pilot)
        await pilot.press("escape")
        await settle(pilot)
        assert app.screen is project
        assert read
