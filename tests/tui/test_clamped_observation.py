"""Clamped and automatic sessions through the API and on the screen, row by row."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from textual.widgets import Static

from surveyapp import api
from surveyapp.core.observing.doubts import Doubt
from surveyapp.core.observing.steps import Step
from surveyapp.core.simulate.session import Row, book_text, simulate_session
from surveyapp.core.simulate.specification import SessionSpec, SwingMethod
from surveyapp.domain.readings import ReadingKind, Side
from surveyapp.errors import SurveyError
from surveyapp.observation import session as api_session
from surveyapp.observation.entry import expected, understand
from surveyapp.observation.session import NewRow, SessionDesk
from surveyapp.tui.app import SurveyApp
from surveyapp.tui.views.progress import countdown_text, forecast_text, is_near
from surveyapp_models.angles import AngleUnit
from tests.tui.helpers_tui import (
    SMALL,
    Clock,
    make_project,
    rows_on_disk,
    settle,
)

KINDS = ("clamp", "scale_reversal", "transit")


def simulated(method: SwingMethod, points: int = 7, seed: int = 5) -> list[Row]:
    spec = SessionSpec(method=method, points=points, tape_zero_points=0)
    rows = simulate_session(spec, np.random.default_rng(seed)).rows
    return [row for row in rows if row["kind"] in KINDS]


def observed(seen: SessionDesk, clock: Clock, rows: list[Row]) -> None:
    """Write rows at their moments."""
    for row in rows:
        begin = clock.seconds - 1000.0
        clock.pass_by(float(row["elapsed_s"]) - float(rows[0]["elapsed_s"]) - begin)
        seen.record(NewRow(ReadingKind(row["kind"]), row["value"], row["unit"]))


def session(folder: Path, method: SwingMethod, clock: Clock) -> SessionDesk:
    make_project(folder, method)
    seen = SessionDesk(folder, "r1", now=clock.now, steady=clock.steady)
    seen.go_to(Step.SWING)
    return seen


@pytest.mark.parametrize("method", ["amplitude", "transit"])
def test_progress_is_what_orient_gives_for_the_same_book(
    tmp_path: Path, method: SwingMethod
) -> None:
    clock = Clock()
    seen = session(tmp_path / "p", method, clock)
    rows, north = simulated(method), 0
    for count in range(1, len(rows) + 1):
        row = rows[count - 1]
        clock.seconds = 1000.0 + float(row["elapsed_s"]) - float(rows[0]["elapsed_s"])
        clock.wall = datetime(2026, 3, 2, 8, 0, tzinfo=UTC) + timedelta(seconds=clock.seconds)
        seen.record(NewRow(ReadingKind(row["kind"]), row["value"], row["unit"]))
        progress = api_session.progress(seen.project, "r1")
        try:
            result = api.orient(tmp_path / "p", session="r1").sessions[0]
        except SurveyError:
            assert progress.north is None
            continue
        assert result.gyro_north is not None
        assert progress.north == result.gyro_north.value
        assert progress.interval95 == result.interval95
        north += 1
    assert north > 3


def test_the_countdown_runs_to_the_next_passage(tmp_path: Path) -> None:
    clock = Clock()
    seen = session(tmp_path / "p", "transit", clock)
    rows = simulated("transit")
    places = [i for i, row in enumerate(rows) if row["kind"] == "transit"]
    observed(seen, clock, rows[: places[4] + 1])
    progress = api_session.progress(seen.project, "r1")
    coming = float(rows[places[5]]["elapsed_s"]) - float(rows[places[4]]["elapsed_s"])
    remaining = seen.remaining_s(progress)
    assert remaining is not None
    assert progress.passage is not None
    assert remaining == pytest.approx(coming, abs=2.0 * progress.passage.half_width_s)
    assert not is_near(progress, remaining)
    assert countdown_text(progress, remaining).startswith("transit > in 3:")
    assert forecast_text(progress, AngleUnit.DMS).startswith("L at -")
    clock.pass_by(remaining - 5.0)
    assert is_near(progress, seen.remaining_s(progress))
    assert "NOW" in countdown_text(progress, seen.remaining_s(progress))
    clock.pass_by(120.0)
    late = seen.remaining_s(progress)
    assert late is None
    assert countdown_text(progress, late) == "transit > overdue: F5 for each point gone by"


def test_a_clock_set_back_and_midnight_change_no_forecast(tmp_path: Path) -> None:
    rows = simulated("transit")[:9]
    found = []
    for name, begin, set_back in (
        ("day", datetime(2026, 3, 2, 8, 0, tzinfo=UTC), 0.0),
        ("night", datetime(2026, 3, 1, 23, 55, tzinfo=UTC), 0.0),
        ("back", datetime(2026, 3, 2, 8, 0, tzinfo=UTC), 3600.0),
    ):
        clock = Clock(begin)
        seen = session(tmp_path / name, "transit", clock)
        observed(seen, clock, rows[:5])
        clock.wall -= timedelta(seconds=set_back)
        for before, row in pairwise(rows[4:]):
            clock.pass_by(float(row["elapsed_s"]) - float(before["elapsed_s"]))
            seen.record(NewRow(ReadingKind(row["kind"]), row["value"], row["unit"]))
        seen.close()
        again = SessionDesk(tmp_path / name, "r1", now=clock.now, steady=clock.steady)
        progress = api_session.progress(again.project, "r1")
        assert progress.passage is not None
        found.append((progress.passage.moment_s, again.remaining_s(progress)))
    for moment, remaining in found[1:]:
        assert moment == pytest.approx(found[0][0], abs=1e-6)
        assert remaining == pytest.approx(found[0][1], abs=1e-3)


def test_moments_of_another_clock_give_no_countdown(tmp_path: Path) -> None:
    folder = make_project(tmp_path / "p", "amplitude")
    rows = [dict(row, elapsed_s="") for row in simulated("amplitude")]
    (folder / "observations" / "r1.csv").write_text(book_text(tuple(rows)), encoding="utf-8")
    clock = Clock()
    seen = SessionDesk(folder, "r1", now=clock.now, steady=clock.steady)
    progress = api_session.progress(seen.project, "r1")
    assert progress.next is not None
    assert progress.next.reading is not None
    assert seen.remaining_s(progress) is None


def test_an_implausible_scale_reading_is_asked_about_in_divisions(tmp_path: Path) -> None:
    clock = Clock()
    seen = session(tmp_path / "p", "amplitude", clock)
    rows = simulated("amplitude")
    observed(seen, clock, rows[:6])
    progress = api_session.progress(seen.project, "r1")
    what = expected(seen, Step.SWING, progress)
    assert what.kind is ReadingKind.SCALE_REVERSAL
    assert what.side is Side(rows[6]["side"])
    stamp = seen.clock.stamp()
    good = understand(seen, rows[6]["value"], what, progress=progress, stamp=stamp)
    assert good.questions == ()
    wrong = f"{float(rows[6]['value']) * 0.9:.2f}"
    asked = understand(seen, wrong, what, progress=progress, stamp=stamp).questions
    assert [(item.doubt, item.scale) for item in asked] == [(Doubt.OUTSIDE_FORECAST, True)]
    other = f"{-float(rows[6]['value']):.2f}"
    asked = understand(seen, other, what, progress=progress, stamp=stamp).questions
    assert [item.doubt for item in asked] == [Doubt.WRONG_SIDE]


def test_a_missed_point_turns_the_side_that_is_asked_for(tmp_path: Path) -> None:
    clock = Clock()
    seen = session(tmp_path / "p", "amplitude", clock)
    rows = simulated("amplitude")
    observed(seen, clock, rows[:5])
    seen.record(NewRow(ReadingKind.MISSED))
    for progress in (None, api_session.progress(seen.project, "r1")):
        what = expected(seen, Step.SWING, progress)
        assert what.side is Side(rows[6]["side"])


async def test_the_screen_forecasts_a_transit_and_f5_counts_a_point_on(tmp_path: Path) -> None:
    clock = Clock()
    folder = tmp_path / "p"
    seen = session(folder, "transit", clock)
    rows = simulated("transit")
    places = [i for i, row in enumerate(rows) if row["kind"] == "transit"]
    observed(seen, clock, rows[: places[3] + 1])
    seen.close()
    app = SurveyApp(str(folder), now=clock.now, steady=clock.steady)
    async with app.run_test(size=SMALL) as pilot:
        await settle(pilot)
        countdown = str(app.screen.query_one("#countdown", Static).render())
        facts = str(app.screen.query_one("#facts", Static).render())
        assert countdown.startswith("transit < in 3:")
        assert "R at +" in countdown
        assert "dt E-W, s" in facts
        assert "Schuler, div" in facts
        await pilot.press("f5")
        await settle(pilot)
        assert rows_on_disk(folder)[-1]["kind"] == "missed"
        after = str(app.screen.query_one("#countdown", Static).render())
        assert after.startswith("transit < in 3:")
        assert "L at -" in after


async def test_the_screen_of_an_automatic_gyro_says_enough(tmp_path: Path) -> None:
    folder = make_project(tmp_path / "p", "automatic")
    text = (folder / "project.toml").read_text(encoding="utf-8")
    (folder / "project.toml").write_text(text.replace("wild-gak1", "hgg05"), encoding="utf-8")
    clock = Clock()
    seen = SessionDesk(folder, "r1", now=clock.now, steady=clock.steady)
    seen.go_to(Step.SWING)
    for value in ("09", "15", "14", "12", "10", "12"):
        seen.record(NewRow(ReadingKind.AZIMUTH, f"321-53-{value}", "dms"))
    seen.close()
    app = SurveyApp(str(folder), now=clock.now, steady=clock.steady)
    async with app.run_test(size=SMALL) as pilot:
        await settle(pilot)
        facts = str(app.screen.query_one("#facts", Static).render())
        assert 'gyro azimuth 321-53-12.0 ±2.4" (95 %)' in facts
        assert 'ENOUGH  ±1.9" after two more  wanted ±8.0"' in facts
