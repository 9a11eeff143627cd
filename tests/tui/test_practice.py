"""The simulated instrument shows what can be observed, and tells the truth afterwards."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from helpers_tui import SMALL
from textual.pilot import Pilot
from textual.widgets import Static

from surveyapp import api, api_practice
from surveyapp.api_entry import expected
from surveyapp.api_session import NewRow, Observation
from surveyapp.core.practice import LEAD_S, simulate_instrument
from surveyapp.core.steps import Step
from surveyapp.domain.readings import ReadingKind
from surveyapp.errors import SurveyError
from surveyapp.tui.app import SurveyApp
from surveyapp.tui.screens.result import ResultScreen
from surveyapp.tui.screens.session import SessionScreen
from surveyapp.tui.widgets.entry import EntryLine
from surveyapp.tui.widgets.instrument import InstrumentPane
from surveyapp_models.angles import ARCSEC, AngleUnit, format_angle, wrap_pi


def test_the_mark_stands_still_where_it_is_read() -> None:
    instrument = simulate_instrument(np.random.default_rng(4), disturbed=False)
    for moment, reading in zip(instrument.moments_s[:8], instrument.readings[:8], strict=True):
        circle = instrument.swing(moment).circle
        assert circle is not None
        assert abs(wrap_pi(circle - reading)) < 0.01 * ARCSEC
        beside = instrument.swing(moment + 2.0).circle
        assert beside is not None
        assert abs(wrap_pi(beside - reading)) < 4.0 * ARCSEC
    assert instrument.moments_s[0] == LEAD_S


@pytest.mark.parametrize("disturbed", [False, True])
def test_a_trainee_who_reads_well_gets_the_truth_or_learns_why_not(
    tmp_path: Path, disturbed: bool
) -> None:
    practice = api_practice.begin(tmp_path / "p", seed=11, speed=50.0, disturbed=disturbed)
    seen = Observation(practice.folder, "practice", now=practice.now, steady=practice.steady)
    seen.go_to(Step.SWING)
    for moment in practice.instrument.moments_s[:12]:
        circle = practice.instrument.swing(moment).circle
        assert circle is not None
        text = format_angle(circle, AngleUnit.DMS, 1)
        seen.record(NewRow(ReadingKind.REVERSAL, text, "dms"))
    outcome = practice.outcome(api.orient(seen.project))
    seen.close()
    assert outcome is not None
    assert (outcome.effect != "") == disturbed
    if not disturbed:
        assert abs(outcome.error) < 3.0 * outcome.interval95


def test_the_view_follows_the_step_and_the_clock(tmp_path: Path) -> None:
    practice = api_practice.begin(tmp_path / "p", seed=1, speed=1.0)
    seen = Observation(practice.folder, "practice", now=practice.now, steady=practice.steady)
    assert practice.view(seen, expected(seen, seen.step, None)).circle is None
    seen.go_to(Step.SIGHTS_BEFORE)
    circle = practice.view(seen, expected(seen, seen.step, None)).circle
    line = practice.instrument.spec.circle_of_north + practice.instrument.spec.line_azimuth
    assert circle is not None
    assert abs(wrap_pi(circle - line)) < 20.0 * ARCSEC
    seen.go_to(Step.ZERO_BEFORE)
    assert practice.view(seen, expected(seen, seen.step, None)).scale_div == pytest.approx(
        4.0 + practice.instrument.spec.tape_zero_div[0], abs=0.05
    )
    seen.close()


def test_an_impossible_speed_is_refused(tmp_path: Path) -> None:
    with pytest.raises(SurveyError, match="speed"):
        api_practice.begin(tmp_path / "p", speed=math.inf)


async def settle(pilot: Pilot[int]) -> None:
    await pilot.app.workers.wait_for_complete()
    await pilot.pause()


async def test_practice_runs_the_same_session_screen_and_ends_with_the_truth(
    tmp_path: Path,
) -> None:
    practice = api_practice.begin(tmp_path / "p", seed=11, speed=200.0, disturbed=True)
    app = SurveyApp(None, practice=practice)
    async with app.run_test(size=SMALL) as pilot:
        await settle(pilot)
        screen = app.screen
        assert isinstance(screen, SessionScreen)
        assert screen.query_one(InstrumentPane)
        while screen.desk.step is not Step.SWING:
            await pilot.press("f8")
        for moment in practice.instrument.moments_s[:6]:
            circle = practice.instrument.swing(moment).circle
            assert circle is not None
            screen.query_one(EntryLine).text = format_angle(circle, AngleUnit.DMS, 1)
            await pilot.press("enter", "enter")
            await settle(pilot)
        while screen.desk.step is not Step.RESULT:
            await pilot.press("f8")
        await pilot.press("f8")
        for _ in range(3):
            await settle(pilot)
        assert isinstance(app.screen, ResultScreen)
        truth = str(app.screen.query_one("#truth", Static).content)
    assert format_angle(practice.instrument.north(6) % (2 * math.pi), AngleUnit.DMS) in truth
    assert practice.instrument.effect.replace("_", " ") in truth
