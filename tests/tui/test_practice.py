"""The simulated instrument shows what can be observed, and tells the truth afterwards."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from textual.widgets import Select, Static

from surveyapp import api
from surveyapp.core.observing.steps import Step
from surveyapp.core.practice.setup import simulate_instrument
from surveyapp.core.practice.simulated_instrument import (
    LEAD_S,
    ROUND_S,
    AutomaticInstrument,
    Looked,
    PracticeOutcome,
    SuspendedInstrument,
)
from surveyapp.core.simulate.turning_points import timetable
from surveyapp.domain.project import Method
from surveyapp.domain.readings import ReadingKind
from surveyapp.errors import SurveyError
from surveyapp.observation import practice as api_practice
from surveyapp.observation.entry import expected
from surveyapp.observation.practice import Practice
from surveyapp.observation.session import NewRow, SessionDesk
from surveyapp.tui.app import SurveyApp
from surveyapp.tui.screens.result import ResultScreen
from surveyapp.tui.screens.session import SessionScreen
from surveyapp.tui.widgets.entry import EntryLine
from surveyapp.tui.widgets.instrument import InstrumentPane
from surveyapp_models.angles import ARCSEC, AngleUnit, format_angle, wrap_pi
from tests.tui.helpers_tui import (
    SMALL,
    Clock,
    settle,
)

METHODS: tuple[Method, ...] = ("tracking", "amplitude", "transit", "automatic")


def suspended(practice: Practice) -> SuspendedInstrument:
    assert isinstance(practice.instrument, SuspendedInstrument)
    return practice.instrument


def test_the_mark_stands_still_where_it_is_read() -> None:
    instrument = simulate_instrument(np.random.default_rng(4), disturbed=False)
    assert isinstance(instrument, SuspendedInstrument)
    for moment, reading in zip(instrument.moments_s[:8], instrument.readings[:8], strict=True):
        circle = instrument.swing(moment).circle
        assert circle is not None
        assert abs(wrap_pi(circle - reading)) < 0.01 * ARCSEC
        beside = instrument.swing(moment + 2.0).circle
        assert beside is not None
        assert abs(wrap_pi(beside - reading)) < 4.0 * ARCSEC
    assert instrument.moments_s[0] == LEAD_S


def read_off(seen: SessionDesk, practice: Practice, clock: Clock) -> None:
    """A trainee who reads perfectly: what the view shows is what is written."""
    seen.go_to(Step.SIGHTS_BEFORE)
    for _ in range(2):
        write_seen(seen, practice)
    if seen.session.method != "automatic":
        read_tape_zero(seen, practice, clock, Step.ZERO_BEFORE)
    seen.go_to(Step.SWING)
    if seen.session.method == "automatic":
        for _ in range(6):
            clock.pass_by(ROUND_S)
            write_seen(seen, practice)
        return
    instrument = suspended(practice)
    if instrument.spec.clamped:
        write_seen(seen, practice)
    begun = clock.seconds
    for moment in events(instrument, seen.session.method):
        clock.pass_by(begun + moment - clock.seconds)
        if instrument.spec.timed and not is_turning(instrument, moment):
            seen.record(NewRow(ReadingKind.TRANSIT, "0", "div"))
        else:
            kind = ReadingKind.SCALE_REVERSAL if instrument.spec.clamped else None
            write_seen(seen, practice, kind)
    read_tape_zero(seen, practice, clock, Step.ZERO_AFTER)


def read_tape_zero(seen: SessionDesk, practice: Practice, clock: Clock, step: Step) -> None:
    seen.go_to(step)
    half = timetable(suspended(practice).spec).unspun_half_swing_s
    for _ in range(5):
        write_seen(seen, practice)
        clock.pass_by(half)


def is_turning(instrument: SuspendedInstrument, moment: float) -> bool:
    return moment in instrument.moments_s


def events(instrument: SuspendedInstrument, method: str) -> list[float]:
    """Turning points, and where passages are timed the moments at which the mark is at zero."""
    turning = list(instrument.moments_s[:13])
    if method != "transit":
        return turning
    found = turning
    for first, last in pairwise(turning[:]):
        low, high = first, last
        for _ in range(50):
            middle = 0.5 * (low + high)
            at_low, at_middle = (instrument.swing(t).scale_div or 0.0 for t in (low, middle))
            low, high = (middle, high) if at_low * at_middle > 0.0 else (low, middle)
        found.append(low)
    return sorted(found)


def write_seen(seen: SessionDesk, practice: Practice, kind: ReadingKind | None = None) -> None:
    what = expected(seen, seen.step, None, kind)
    view = practice.view(seen, what)
    face = str(what.face or "")
    if view.scale_div is not None and what.kind is not ReadingKind.CLAMP:
        seen.record(NewRow(what.kind, f"{view.scale_div:.3f}", "div"))
    else:
        assert view.circle is not None, what
        seen.record(NewRow(what.kind, format_angle(view.circle, AngleUnit.DMS, 1), "dms", face))


def observe(folder: Path, method: Method, seed: int, *, disturbed: bool) -> PracticeOutcome:
    clock = Clock()
    begun = api_practice.begin(folder, method=method, seed=seed, speed=50.0, disturbed=disturbed)
    practice = replace(begun, now=clock.now, steady=clock.steady)
    seen = SessionDesk(practice.folder, "practice", now=practice.now, steady=practice.steady)
    read_off(seen, practice, clock)
    outcome = practice.outcome(api.orient(seen.project))
    seen.close()
    assert outcome is not None
    return outcome


@pytest.mark.parametrize("method", METHODS)
def test_a_trainee_who_reads_well_gets_the_truth(tmp_path: Path, method: Method) -> None:
    outcomes = [
        observe(tmp_path / str(seed), method, seed, disturbed=False) for seed in (11, 12, 13, 14)
    ]
    assert [outcome.effect for outcome in outcomes] == [""] * 4
    for outcome in outcomes:
        assert abs(outcome.error) < 2.5 * outcome.interval95
        assert outcome.interval95 < 80.0 * ARCSEC
        assert outcome.inside == (abs(outcome.error) <= outcome.interval95)
    assert sum(outcome.inside for outcome in outcomes) >= 3


@pytest.mark.parametrize("method", METHODS)
def test_something_hidden_is_named_afterwards(tmp_path: Path, method: Method) -> None:
    outcome = observe(tmp_path / "p", method, 11, disturbed=True)
    assert outcome.effect in {"midpoint_step", "damping_break", "midpoint_drift", "warm_up"} | {
        "secondary_oscillation",
        "gross_error",
    }


def test_the_lot_hides_something_in_about_half_of_the_sessions() -> None:
    found = [
        simulate_instrument(np.random.default_rng(seed), method="automatic", disturbed=None).effect
        for seed in range(60)
    ]
    assert 18 <= sum(effect != "" for effect in found) <= 42


def test_an_automatic_gyro_delivers_round_by_round() -> None:
    instrument = simulate_instrument(np.random.default_rng(3), method="automatic", disturbed=False)
    assert isinstance(instrument, AutomaticInstrument)
    looked = Looked(ReadingKind.AZIMUTH)
    measuring = instrument.at(Step.SWING, 0.5 * ROUND_S, looked)
    assert measuring.circle is None
    assert measuring.swing == pytest.approx(0.0)
    first, second = (instrument.at(Step.SWING, k * ROUND_S + 1.0, looked) for k in (1, 2))
    assert first.circle == pytest.approx(instrument.azimuths[0])
    assert second.circle == pytest.approx(instrument.azimuths[1])
    north = instrument.at(Step.SWING, ROUND_S + 1.0, Looked(ReadingKind.NORTH)).circle
    assert north is not None
    assert wrap_pi(instrument.sights.line - north - instrument.azimuths[0]) == pytest.approx(0.0)


def test_the_view_follows_the_step_and_the_clock(tmp_path: Path) -> None:
    practice = api_practice.begin(tmp_path / "p", seed=1, speed=1.0)
    seen = SessionDesk(practice.folder, "practice", now=practice.now, steady=practice.steady)
    assert practice.view(seen, expected(seen, seen.step, None)).circle is None
    seen.go_to(Step.SIGHTS_BEFORE)
    circle = practice.view(seen, expected(seen, seen.step, None)).circle
    spec = suspended(practice).spec
    assert circle is not None
    assert abs(wrap_pi(circle - spec.circle_of_north - spec.line_azimuth)) < 20.0 * ARCSEC
    seen.go_to(Step.ZERO_BEFORE)
    assert practice.view(seen, expected(seen, seen.step, None)).scale_div == pytest.approx(
        4.0 + spec.tape_zero_div[0], abs=0.1
    )
    seen.close()


def test_an_impossible_speed_is_refused(tmp_path: Path) -> None:
    with pytest.raises(SurveyError, match="speed"):
        api_practice.begin(tmp_path / "p", speed=math.inf)


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
        instrument = suspended(practice)
        for moment in instrument.moments_s[:6]:
            circle = instrument.swing(moment).circle
            assert circle is not None
            screen.query_one(EntryLine).text = format_angle(circle, AngleUnit.DMS, 1)
            await pilot.press("enter", "enter")
            await settle(pilot)
        while screen.desk.step.value != Step.RESULT.value:
            await pilot.press("f8")
        await pilot.press("f8")
        for _ in range(3):
            await settle(pilot)
        assert isinstance(app.screen, ResultScreen)
        truth = str(app.screen.query_one("#truth", Static).content)
    assert format_angle(practice.instrument.truth(6) % (2 * math.pi), AngleUnit.DMS) in truth
    assert practice.instrument.effect.replace("_", " ") in truth


@pytest.mark.parametrize("method", METHODS)
async def test_every_method_is_practised_from_the_home_screen(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, method: Method
) -> None:
    monkeypatch.setattr(api_practice, "practice_folder", lambda: str(tmp_path / "practice"))
    app = SurveyApp(None)
    async with app.run_test(size=SMALL) as pilot:
        await settle(pilot)
        await pilot.press("p")
        await settle(pilot)
        app.screen.query_one("#method", Select).value = method
        app.screen.query_one("#speed", Select).value = "100"
        app.screen.query_one("#hidden", Select).value = "something"
        await pilot.press("f8")
        await settle(pilot)
        screen = app.screen
        assert isinstance(screen, SessionScreen)
        assert screen.observation.session.method == method
        assert "100 x" in str(screen.query_one(InstrumentPane).content)
        assert app.practice is not None
        assert app.practice.instrument.effect
