"""A field file is looked at, then taken by one key; an export is written beside the project."""

from __future__ import annotations

from pathlib import Path

import pytest
from textual.pilot import Pilot
from textual.widgets import Input, OptionList, Static

from surveyapp.observation.exchange import Entry
from surveyapp.tui.app import SurveyApp
from surveyapp.tui.screens.exchange import ImportScreen
from surveyapp.tui.screens.export import ExportScreen
from surveyapp.tui.screens.project import ProjectScreen
from surveyapp.tui.views.exchange import entry_text
from surveyapp.tui.widgets.titlebar import TitleBar
from tests.formats import field_writers as w
from tests.formats.importing import field_file, project, tree
from tests.tui.helpers_tui import (
    LARGE,
    SMALL,
    settle,
)

SETUPS, SIGHTS = w.simulated()


def shown(pilot: Pilot[int]) -> str:
    return str(pilot.app.screen.query_one("#preview Static", Static).content)


async def choose(pilot: Pilot[int], name: str) -> None:
    screen = pilot.app.screen
    assert isinstance(screen, ImportScreen)
    files = screen.query_one("#files", OptionList)
    files.highlighted = next(i for i, e in enumerate(screen.entries) if e.name == name)
    files.focus()
    await pilot.press("enter")
    await settle(pilot)


@pytest.mark.parametrize("size", [SMALL, LARGE])
async def test_a_file_is_previewed_and_taken(
    tmp_path: Path, size: tuple[int, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = project(tmp_path / "p")
    (tmp_path / "field").mkdir()
    field_file(tmp_path / "field", "day.gsi", w.gsi(SETUPS, SIGHTS, code="21"))
    (tmp_path / "field" / "picture.jpg").write_bytes(b"x")
    monkeypatch.chdir(tmp_path)
    app = SurveyApp(str(folder))
    async with app.run_test(size=size) as pilot:
        await settle(pilot)
        await pilot.press("i")
        await settle(pilot)
        await choose(pilot, "field/")
        screen = app.screen
        assert isinstance(screen, ImportScreen)
        assert [e.name for e in screen.entries] == ["../", "day.gsi"]
        await choose(pilot, "day.gsi")
        assert "no station is named" in shown(pilot)
        assert "21 (3 times)" in shown(pilot)
        app.screen.query_one("#options", Input).value = "station-code=21 traverse=main"
        app.screen.query_one("#options", Input).focus()
        await pilot.press("enter")
        await settle(pilot)
        assert "24 readings, 36 rows" in shown(pilot)
        assert list(tree(folder)) == ["project.toml"]
        await pilot.press("f8")
        await settle(pilot)
        assert "taken" in app.screen.query_one(TitleBar).state
        assert "observations/main.csv" in tree(folder)
        await pilot.press("escape")
        await settle(pilot)
        assert isinstance(app.screen, ProjectScreen)
        assert app.screen.project is not None
        assert len(app.screen.project.stations) == 5


async def test_an_export_is_written_and_never_over_a_file(tmp_path: Path) -> None:
    folder = project(tmp_path / "p", '[[station]]\nname = "A"\ne = 1.0\nn = 2.0\n')
    app = SurveyApp(str(folder))
    async with app.run_test(size=SMALL) as pilot:
        await settle(pilot)
        await pilot.press("x")
        await settle(pilot)
        screen = app.screen
        assert isinstance(screen, ExportScreen)
        formats = screen.query_one("#formats", OptionList)
        formats.highlighted = list(screen.formats).index("dxf")
        await settle(pilot)
        await pilot.press("f8")
        await settle(pilot)
        assert (tmp_path / "p.dxf").exists()
        await pilot.press("f8")
        await settle(pilot)
        assert "exists" in str(screen.query_one("#told", Static).content)


async def test_a_new_project_may_begin_with_a_field_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    app = SurveyApp(None)
    async with app.run_test(size=LARGE) as pilot:
        await settle(pilot)
        app.screen.action_new()  # type: ignore[attr-defined]
        await settle(pilot)
        app.screen.query_one("#name", Input).value = "heading"
        await pilot.press("f9")
        await settle(pilot)
        assert isinstance(app.screen, ImportScreen)
        assert (tmp_path / "heading" / "project.toml").exists()


def test_a_small_file_has_a_size() -> None:
    assert entry_text(Entry("a.gsi", "a.gsi", "gsi", 0.34)) == "a.gsi  0.3 kB"
    assert entry_text(Entry("b.gsi", "b.gsi", "gsi", 34.4)) == "b.gsi  34 kB"
