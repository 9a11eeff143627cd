"""Amplitude, transit and automatic sessions are typed on the same screen."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from textual.pilot import Pilot

from surveyapp import api
from surveyapp.core.observing.steps import Step
from surveyapp.core.simulate.session import simulate_session
from surveyapp.core.simulate.specification import SessionSpec
from surveyapp.tui.app import SurveyApp
from surveyapp.tui.screens.result import ResultScreen
from surveyapp.tui.screens.session import SessionScreen
from surveyapp.tui.widgets.entry import EntryLine
from tests.tui.helpers_tui import (
    SMALL,
    make_project,
    readings,
    rows_on_disk,
    settle,
)


async def go_to(pilot: Pilot[int], screen: SessionScreen, step: Step) -> None:
    while screen.desk.step is not step:
        await pilot.press("f8")
        await settle(pilot)


async def type_rows(pilot: Pilot[int], rows: list[dict[str, str]]) -> None:
    """Type rows; F2 until the kind is the row's, Space for a passage at its moment."""
    screen = pilot.app.screen
    assert isinstance(screen, SessionScreen)
    for row in rows:
        for _ in range(4):
            if screen.desk.what().kind == row["kind"]:
                break
            await pilot.press("f2")
        assert screen.desk.what().kind == row["kind"]
        if row["kind"] == "transit":
            await pilot.press("space")
        else:
            screen.query_one(EntryLine).text = row["value"]
            await pilot.press("enter")
        await settle(pilot)


async def result_of(pilot: Pilot[int], screen: SessionScreen) -> dict[str, object]:
    await go_to(pilot, screen, Step.RESULT)
    await pilot.press("f8")
    await settle(pilot)
    assert isinstance(pilot.app.screen, ResultScreen)
    assert pilot.app.screen.result is not None
    return pilot.app.screen.result.to_dict()


async def test_an_automatic_session(tmp_path: Path) -> None:
    folder = make_project(tmp_path / "p", "automatic")
    text = (folder / "project.toml").read_text(encoding="utf-8")
    (folder / "project.toml").write_text(text.replace("wild-gak1", "hgg05"), encoding="utf-8")
    app = SurveyApp(str(folder))
    async with app.run_test(size=SMALL) as pilot:
        await settle(pilot)
        await pilot.press("enter")
        await settle(pilot)
        screen = app.screen
        assert isinstance(screen, SessionScreen)
        await go_to(pilot, screen, Step.SWING)
        for value in ("321-53-09", "15", "14"):
            await type_rows(pilot, [{"kind": "azimuth", "value": value}])
        shown = await result_of(pilot, screen)
    assert readings(rows_on_disk(folder)) == [
        ("azimuth", "321-53-09"),
        ("azimuth", "321-53-15"),
        ("azimuth", "321-53-14"),
    ]
    assert shown == api.orient(folder, session="r1").to_dict()


@pytest.mark.parametrize("method", ["amplitude", "transit"])
async def test_a_clamped_session(tmp_path: Path, method: str) -> None:
    folder = make_project(tmp_path / "p", method)
    spec = SessionSpec(method=method, points=6, times=True)  # type: ignore[arg-type]
    kinds = ("clamp", "scale_reversal", "transit")
    rows = simulate_session(spec, np.random.default_rng(5)).rows
    typed = [row for row in rows if row["kind"] in kinds]
    app = SurveyApp(str(folder))
    ticks = iter(float(row["elapsed_s"]) for row in typed)
    async with app.run_test(size=SMALL) as pilot:
        await settle(pilot)
        await pilot.press("enter")
        await settle(pilot)
        screen = app.screen
        assert isinstance(screen, SessionScreen)
        await go_to(pilot, screen, Step.SWING)
        clock = screen.observation.clock
        begin = clock.stamp()
        for row in typed:
            moment = next(ticks)
            fixed = clock.corrected(begin, moment)
            screen.observation.clock = _Frozen(clock, fixed)  # type: ignore[assignment]
            await type_rows(pilot, [row])
        shown = await result_of(pilot, screen)
    kept = [row for row in rows_on_disk(folder) if row["kind"] in kinds]
    assert [row["kind"] for row in kept] == [row["kind"] for row in typed]
    assert shown == api.orient(folder, session="r1").to_dict()


class _Frozen:
    """The session's clock standing at one moment."""

    def __init__(self, clock: object, stamp: object) -> None:
        self.clock, self.moment = clock, stamp
        self.set_back_s = 0.0

    def stamp(self) -> object:
        return self.moment

    def corrected(self, stamp: object, seconds: float) -> object:
        return self.clock.corrected(stamp, seconds)  # type: ignore[attr-defined]

    def wall_clock_off_s(self) -> float:
        return 0.0
