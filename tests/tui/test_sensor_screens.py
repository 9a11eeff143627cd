"""Sensors on the screen: logs, tasks that run and are cancelled, cards, adding a log."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from textual.pilot import Pilot
from textual.widgets import DataTable, Input, OptionList, Static, TabbedContent

from surveyapp import api
from surveyapp.domain.advance import PartDone
from surveyapp.errors import SurveyError
from surveyapp.observation.sensors import tasks
from surveyapp.observation.sensors.desk import card_path
from surveyapp.observation.sensors.options import told_options
from surveyapp.tui import texts
from surveyapp.tui.app import SurveyApp
from surveyapp.tui.screens.add_log import AddLogScreen
from surveyapp.tui.screens.confirm import ConfirmScreen
from surveyapp.tui.screens.sensor_log import TASK_KEYS, SensorLogScreen
from surveyapp.tui.screens.sensors import SensorsScreen
from surveyapp.tui.widgets.chart import ChartPane
from surveyapp.tui.widgets.titlebar import TitleBar
from tests.tui.helpers_tui import (
    LARGE,
    SMALL,
    Clock,
    settle,
)

PROJECTS = Path(__file__).resolve().parents[2] / "projects"


@pytest.fixture
def compass(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    api.simulate("compass", tmp_path / "mine", effects=["hard_iron=12"], seed=3)
    return tmp_path / "mine"


def app_on(folder: Path) -> SurveyApp:
    clock = Clock()
    return SurveyApp(str(folder), now=clock.now, steady=clock.steady)


async def open_log(pilot: Pilot[int]) -> SensorLogScreen:
    await settle(pilot)
    await pilot.press("l")
    await settle(pilot)
    assert isinstance(pilot.app.screen, SensorsScreen)
    await pilot.press("enter")
    await settle(pilot)
    assert isinstance(pilot.app.screen, SensorLogScreen)
    return pilot.app.screen


def shown(screen: SensorLogScreen) -> str:
    return str(screen.query_one("#found", Static).visual)


async def test_a_compass_is_calibrated_drawn_and_its_card_saved(compass: Path) -> None:
    app = app_on(compass)
    async with app.run_test(size=LARGE) as pilot:
        screen = await open_log(pilot)
        await pilot.press("c")
        await settle(pilot)
        assert screen.found is not None
        assert screen.found.calibration is not None
        sensor = screen.entry.id
        expected = api.calibrate("compass", compass, sensor=sensor)
        assert screen.found.calibration.parameters == expected.parameters
        assert screen.query_one(TitleBar).state == texts.TASK_DONE.format(
            task=texts.TASK_NAMES["calibrate"]
        )
        await pilot.press("v")
        await pilot.pause()
        assert screen.query_one(TabbedContent).active == "pictures"
        assert screen.query_one(ChartPane).picture is screen.found.pictures[0]
        await pilot.press("v")
        assert screen.query_one(ChartPane).picture is screen.found.pictures[1]
        await pilot.press("k")
        await settle(pilot)
        assert isinstance(app.screen, ConfirmScreen)
        await pilot.press("enter")
        await settle(pilot)
        assert (compass / card_path(sensor)).is_file()
        await pilot.press("escape")
        await settle(pilot)
        assert isinstance(app.screen, SensorsScreen)
        await pilot.press("2")
        await settle(pilot)
        table = app.screen.query_one("#cards DataTable", DataTable)
        assert [str(cell) for cell in table.get_row_at(0)][:2] == [card_path(sensor), "compass"]


async def test_every_task_has_a_key_and_says_what_it_lacks(compass: Path) -> None:
    assert {task for _, task, *_ in TASK_KEYS} == set(tasks.TASKS)
    app = app_on(compass)
    async with app.run_test(size=SMALL) as pilot:
        screen = await open_log(pilot)
        for key, lacks in (("s", "column"), ("m", "gyr_x_rad_s"), ("n", "method"), ("p", "latit")):
            await pilot.press(key)
            await settle(pilot)
            assert screen.query_one(TitleBar).state == texts.TASK_REFUSED
            assert lacks in str(screen.query_one("#found", Static).content)
        await pilot.press("k")  # nothing was calibrated: told, nothing written
        await settle(pilot)
        assert app.screen is screen


async def test_options_are_told_in_one_line(compass: Path) -> None:
    app = app_on(compass)
    async with app.run_test(size=SMALL) as pilot:
        screen = await open_log(pilot)
        screen.query_one("#options", Input).value = "column=mag_x_uT"
        await pilot.press("s")
        await settle(pilot)
        assert screen.found is not None
        assert screen.found.task == "spectrum"
        screen.query_one("#options", Input).value = "colum=mag_x_uT latitude=here"
        await pilot.press("n")
        await settle(pilot)
        text = str(screen.query_one("#found", Static).content)
        assert "no such option of north" in text
        assert "no number" in text


async def test_a_cancelled_task_shows_nothing(
    compass: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    app = app_on(compass)
    async with app.run_test(size=SMALL) as pilot:
        screen = await open_log(pilot)

        def slow(*_: object, progress: PartDone | None = None) -> tasks.Examined:
            assert progress is not None
            app.call_from_thread(screen.action_cancel)
            progress(0.5)
            raise AssertionError("went on after it was cancelled")

        monkeypatch.setattr("surveyapp.tui.screens.sensor_log.examine", slow)
        await pilot.press("c")
        await settle(pilot)
        assert screen.found is None
        assert screen.query_one(TitleBar).state == texts.TASK_CANCELLED


async def test_a_log_is_added_with_its_columns_named(
    tmp_path: Path, compass: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    source = next((compass / "sensors").glob("*.csv"))
    place = tmp_path / "stick"
    place.mkdir()
    head, *rows = source.read_text(encoding="utf-8").splitlines()
    renamed = head.replace("mag_x_uT", "mx")
    (place / "turn.csv").write_text("\n".join([renamed, *rows]) + "\n", encoding="utf-8")
    monkeypatch.chdir(place)
    app = app_on(compass)
    async with app.run_test(size=SMALL) as pilot:
        await settle(pilot)
        await pilot.press("l")
        await settle(pilot)
        await pilot.press("a")
        await settle(pilot)
        screen = app.screen
        assert isinstance(screen, AddLogScreen)
        screen.query_one("#files", OptionList).highlighted = 1
        await pilot.press("enter")
        await settle(pilot)
        assert "mx" in str(screen.query_one("#preview Static", Static).content)
        line = screen.query_one("#options", Input)
        line.value = "id=second kind=compass map.mag_x_uT=mx unit.mx=uT"
        line.focus()
        await pilot.press("enter")
        await settle(pilot)
        assert screen.query_one(TitleBar).state == texts.ADD_LOG_GOOD
        await pilot.press("f8")
        await settle(pilot)
        assert screen.query_one(TitleBar).state == texts.ADD_LOG_TAKEN.format(
            path="sensors/second.csv"
        )
        await pilot.press("escape")
        await settle(pilot)
        assert app.screen.query_one("#logs DataTable", DataTable).row_count == 2
    assert [e.id for e in api.open_project(compass).sensor_logs][-1] == "second"
    assert api.calibrate("compass", compass, sensor="second").met


async def test_a_broken_card_is_told_not_hidden(compass: Path) -> None:
    (compass / "sensors" / "old.card.toml").write_text("id = 'x'\n", encoding="utf-8")
    app = app_on(compass)
    async with app.run_test(size=SMALL) as pilot:
        await settle(pilot)
        await pilot.press("l")
        await settle(pilot)
        await pilot.press("2")
        await settle(pilot)
        table = app.screen.query_one("#cards DataTable", DataTable)
        assert texts.SENSOR_CARD_BROKEN in [str(cell) for cell in table.get_row_at(0)]


def test_a_measured_sample_is_diagnosed_as_on_the_command_line(tmp_path: Path) -> None:
    folder = shutil.copytree(PROJECTS / "broad-attached-magnet", tmp_path / "broad")
    entry = api.open_project(folder).sensor_logs[0]
    found = tasks.examine(str(folder), entry, "diagnose", "")
    document = api.diagnose_log(folder, sensor=entry.id).to_dict()
    assert found.adoptable == tuple(item["effect"] for item in document["adopted"])


async def test_what_was_named_is_adopted_once_and_stands_in_the_project(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    folder = Path(shutil.copytree(PROJECTS / "broad-attached-magnet", tmp_path / "broad"))
    app = app_on(folder)
    async with app.run_test(size=SMALL) as pilot:
        screen = await open_log(pilot)
        await pilot.press("a")  # nothing was diagnosed yet
        await settle(pilot)
        assert app.screen is screen
        await pilot.press("d")
        await settle(pilot)
        task = texts.TASK_NAMES["diagnose"]
        assert screen.query_one(TitleBar).state == texts.TASK_NAMED.format(task=task)
        await pilot.press("a")
        await settle(pilot)
        assert isinstance(app.screen, ConfirmScreen)
        await pilot.press("enter")
        await settle(pilot)
    (entry,) = api.open_project(folder).sensor_logs
    assert [effect.id for effect in entry.effects] == ["interference_step"]
    written, refused = tasks.adopt_effects(str(folder), entry)
    assert written == ()
    assert "interference_step" in refused[0]
    assert "interference step" in api.report_text(folder)


def test_numbers_and_words_of_options_keep_their_kind() -> None:
    told = told_options("north", "latitude=47.5 method=indexing track scale.c=0.1 rate-hz=100")
    assert dict(told.own) == {"latitude": 47.5, "method": "indexing", "track": True}
    assert told.log.scale == {"c": 0.1}
    assert told.log.rate_hz == 100.0


def test_a_word_alone_or_with_true_is_a_flag() -> None:
    for line in ("path snap", "path=true snap=TRUE"):
        assert dict(told_options("motion", line).own) == {"path": True, "snap": True}
    assert dict(told_options("motion", "path=false").own) == {"path": False}
    with pytest.raises(SurveyError, match="neither true nor false"):
        told_options("motion", "path=perhaps")


@pytest.mark.parametrize(
    ("kind", "programme", "task"),
    [("vehicle", None, "motion"), ("indexing", "one-stop", "north")],
)
async def test_enter_asks_of_a_log_what_its_entry_is_for(
    tmp_path: Path, kind: str, programme: str | None, task: str
) -> None:
    folder = tmp_path / kind
    api.simulate(kind, folder, programme=programme, seed=2)
    app = app_on(folder)
    async with app.run_test(size=SMALL) as pilot:
        screen = await open_log(pilot)
        screen.query_one("#options", Input).focus()
        await pilot.press("enter")
        await settle(pilot)
        assert screen.found is not None, shown(screen)
        assert screen.found.task == task
