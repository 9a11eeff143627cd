"""Guided programmes from the first step to the card: typed, and from a log that is growing."""

from __future__ import annotations

import csv
import math
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
import pytest
from textual.widgets import DataTable, Input, OptionList, Static

from surveyapp import api
from surveyapp.core.sensors.programmes.catalogue import PROGRAMMES, SIX_POSITION, TILT_STATIC
from surveyapp.errors import SurveyError
from surveyapp.io.sensor_cards import read_sensor_card
from surveyapp.observation.sensors.desk import card_path
from surveyapp.observation.sensors.programmes import ProgrammeDesk, free_id, runs_of
from surveyapp.tui import texts
from surveyapp.tui.app import SurveyApp
from surveyapp.tui.screens.programme import ProgrammeScreen
from surveyapp.tui.screens.sensor_log import SensorLogScreen
from surveyapp.tui.screens.sensors import SensorsScreen
from surveyapp.tui.widgets.titlebar import TitleBar
from tests.tui.helpers_tui import (
    SMALL,
    settle,
)

SENSITIVITY, ZERO = 477716.0, 1200.0


class Minutes:
    """A wall clock that a test turns."""

    def __init__(self) -> None:
        self.time = datetime(2026, 3, 1, 8, 0, tzinfo=UTC)

    def __call__(self) -> datetime:
        self.time += timedelta(seconds=20)
        return self.time


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    api.new_project(tmp_path / "mine")
    return tmp_path / "mine"


def answer(row: dict[str, object], rng: np.random.Generator) -> str:
    """Output of a sensor of known sensitivity and zero."""
    angle = float(str(row.get("angle_deg", 0.1 if row.get("flip") else -0.1)))
    output = ZERO + SENSITIVITY * math.sin(math.radians(angle)) + rng.normal(0.0, 30.0)
    return f"{output:.0f}"


def test_a_static_test_is_typed_to_its_card(folder: Path) -> None:
    rng, clock = np.random.default_rng(2), Minutes()
    api.begin_programme(folder, "tilt-static", "t1", now=clock())
    desk = ProgrammeDesk(str(folder), "t1", now=clock)
    with pytest.raises(SurveyError, match="nothing was read"):
        desk.finish("")
    while (here := desk.state.here) is not None:
        if here.kind == "wait":
            clock.time += timedelta(minutes=11)
        desk.record(here.id, answer(dict(here.row), rng) if here.kind == "read" else "")
    assert desk.state.warnings == ()
    assert desk.state.known.undetermined == ()
    found = desk.finish("")
    assert found.met
    assert found.calibration is not None
    value = found.calibration.parameter("sensitivity")
    assert value.sigma is not None
    assert abs((value.value or 0.0) - SENSITIVITY) < 4.0 * value.sigma
    card = read_sensor_card(folder / card_path("t1"))
    assert card.get("zero") == found.calibration.value("zero")
    assert "JJF 1427-2013" in card.notes["procedure"]
    (entry,) = api.open_project(folder).sensor_logs
    assert (entry.id, entry.kind, str(entry.calibrated_on)) == ("t1", "tilt", "2026-03-01")
    with (folder / entry.file).open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [row["test"] for row in rows].count("static") == 39
    desk.undo("misread")  # the last point, read again
    last = desk.state.here
    assert last is not None
    desk.record(last.id, answer(dict(last.row), rng))
    assert desk.finish("").calibration is not None
    assert len(api.open_project(folder).sensor_logs) == 1


def test_what_was_written_outlives_a_kill_in_the_middle_of_a_line(folder: Path) -> None:
    clock = Minutes()
    api.begin_programme(folder, "tilt-static", "t1", now=clock())
    desk = ProgrammeDesk(str(folder), "t1", now=clock)
    desk.record("mount", "")
    desk.record("zero-0", "17")
    path = folder / "sensors" / "t1.programme.csv"
    whole = path.read_bytes()
    path.write_bytes(whole + b"4,2026-03-01T08:0")
    again = ProgrammeDesk(str(folder), "t1", now=clock)
    assert again.state.run.entries == desk.state.run.entries
    again.record("zero-180", "18")
    assert path.read_bytes().startswith(whole)
    assert (folder / "sensors" / "t1.programme.csv.torn").read_bytes() == b"4,2026-03-01T08:0\n"
    assert [s.told for s in again.state.steps if s.step.id.startswith("zero")] == ["17", "18"]


@pytest.mark.parametrize(
    ("step", "text", "what"),
    [
        ("zero-0", "12,5", "not a number"),
        ("zero-0", "1 2", "not a number"),
        ("zero-0", "nan", "not a number"),
        ("zero-0", "", "not a number"),
        ("static-9-01", "5", "nothing is typed in this step"),
        ("mount", "log=nowhere.csv", "typed"),
    ],
)
def test_a_reading_that_is_none_is_told_and_not_written(
    folder: Path, step: str, text: str, what: str
) -> None:
    api.begin_programme(folder, "tilt-static", "t1")
    desk = ProgrammeDesk(str(folder), "t1", now=Minutes())
    before = (folder / "sensors" / "t1.programme.csv").read_bytes()
    with pytest.raises(SurveyError, match=what):
        desk.record(step, text)
    assert (folder / "sensors" / "t1.programme.csv").read_bytes() == before


def test_ids_and_programmes_that_are_none_are_refused(folder: Path) -> None:
    api.begin_programme(folder, "tilt-static", "t1")
    for programme, identity in (("tilt", "t2"), ("tilt-static", "t1"), ("tilt-static", "../x")):
        with pytest.raises(SurveyError):
            api.begin_programme(folder, programme, identity)
    assert free_id(str(folder), "tilt-static") == "tilt-static-1"
    (folder / "sensors" / "bad.programme.csv").write_text("seq,time\n", encoding="utf-8")
    runs, problems = runs_of(str(folder))
    assert [shown.run.id for shown in runs] == ["t1"]
    assert len(problems) == 1


def test_a_growing_log_is_followed_to_the_last_position(folder: Path, tmp_path: Path) -> None:
    api.simulate("rate", tmp_path / "sim", seed=4)
    source = next((tmp_path / "sim" / "sensors").glob("*.csv"))
    lines = source.read_text(encoding="utf-8").splitlines(keepends=True)
    place = lines[0].strip().split(",").index("position")
    where = [line.strip().split(",")[place] for line in lines[1:]]
    growing = tmp_path / "growing.csv"
    growing.write_text("".join(lines[: 1 + where.index("y+")]) + "12.0", encoding="utf-8")
    clock = Minutes()
    api.begin_programme(folder, SIX_POSITION.id, "s1", now=clock())
    desk = ProgrammeDesk(str(folder), "s1", now=clock)
    for step in ("mount", "power", "warm-up"):
        desk.record(step, "")
    assert desk.log_mark() is None
    desk.record("mount", f"log={growing}")
    states = {s.step.id: s for s in desk.state.steps}
    status = [states[k].status for k in ("x+-cloc", "x+-ant", "x--ant", "y+-cloc", "z+-cloc")]
    assert status == ["done", "done", "done", "open", "here"]
    assert "whole" in states["x+-cloc"].told
    assert {"scale_factor_x", "bias_x"} <= set(desk.state.known.determined)
    assert {"scale_factor_z", "bias_y"} <= set(desk.state.known.undetermined)
    growing.write_text("".join(lines), encoding="utf-8")
    assert desk.look().complete
    assert desk.state.known.undetermined == ()
    found = desk.finish("flip-sigma-arcsec=30 table-rate-relative-sigma=1e-5")
    assert found.met
    entry = api.open_project(folder).sensor_logs[0]
    assert (entry.programme, entry.file) == ("six-position", "sensors/s1.csv")
    assert (folder / card_path("s1")).is_file()


async def test_a_programme_is_begun_left_and_gone_on_with_on_the_screen(folder: Path) -> None:
    clock = Minutes()
    app = SurveyApp(str(folder), now=clock)
    async with app.run_test(size=SMALL) as pilot:
        await settle(pilot)
        await pilot.press("l")
        await settle(pilot)
        await pilot.press("3")
        await settle(pilot)
        assert isinstance(app.screen, SensorsScreen)
        table = app.screen.query_one("#programmes DataTable", DataTable)
        assert table.row_count == len(PROGRAMMES)
        await pilot.press("enter")
        await settle(pilot)
        assert isinstance(app.screen, ProgrammeScreen)
        for line in ("", "", "", "17", "x"):
            await pilot.press(*line, "enter")
            await settle(pilot)
        screen = app.screen
        said = str(screen.query_one("#said", Static).content)
        assert "not a number" in said
        assert screen.query_one("#line", Input).value == "x"  # what was typed stays
        steps = screen.query_one("#steps", OptionList)
        assert steps.highlighted == 4
        assert screen.query_one(TitleBar).state == texts.PROGRAMME_COUNT.format(done=4, count=44)
        await pilot.press("backspace", "down", "5", "enter")  # another step first
        await settle(pilot)
        assert steps.highlighted == 4
        assert screen.desk.state.run.live["static-1-01"].value == "5"
        await pilot.press("ctrl+z")
        await settle(pilot)
        assert "static-1-01" not in screen.desk.state.run.live
        await pilot.press("f8")
        await settle(pilot)
        assert isinstance(app.screen, SensorLogScreen)  # as far as it goes, and no card
        assert "without the static test" in str(app.screen.query_one("#found", Static).content)
        assert not list((folder / "sensors").glob("*.toml"))
        await pilot.press("escape")
        await settle(pilot)
        await pilot.press("escape")
        await settle(pilot)
        assert isinstance(app.screen, SensorsScreen)
        table = app.screen.query_one("#programmes DataTable", DataTable)
        assert table.row_count == len(PROGRAMMES) + 1
        assert next(str(c) for c in table.get_row_at(0)) == f"{TILT_STATIC.id}-1"
