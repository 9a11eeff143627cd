"""F1 explains every screen, the palette names every action, Escape loses nothing typed."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from textual.pilot import Pilot
from textual.screen import ModalScreen, Screen
from textual.widgets import Input, Select, Static, TextArea

from surveyapp.core.geodesy import open_grid
from surveyapp.core.simulate.session import book_text
from surveyapp.domain.readings import Face
from surveyapp.errors import SurveyError
from surveyapp.observation import home as api_home
from surveyapp.observation.station_lines import NewStation, read_stations
from surveyapp.report.numbers import signed_angle
from surveyapp.tui import screens
from surveyapp.tui.app import SurveyApp
from surveyapp.tui.screens.help import HelpScreen
from surveyapp.tui.screens.home import HomeScreen
from surveyapp.tui.screens.new_project import NewProjectScreen
from surveyapp.tui.screens.session import SessionScreen
from surveyapp.tui.screens.strike import StrikeScreen
from surveyapp.tui.texts import help_texts
from surveyapp.tui.views.ledger import ledger_rows
from surveyapp.tui.widgets.entry import EntryLine
from surveyapp_models.angles import ARCSEC, AngleUnit, parse_angle
from tests.tui.helpers_tui import (
    SMALL,
    make_project,
    open_session,
    settle,
    simulated,
)

PROJECTS = Path(__file__).resolve().parents[2] / "projects"


def classes_of_screens() -> set[str]:
    import importlib
    import pkgutil

    found = set()
    for module in pkgutil.iter_modules(screens.__path__):
        names = vars(importlib.import_module(f"{screens.__name__}.{module.name}"))
        found |= {
            name
            for name, item in names.items()
            if isinstance(item, type)
            and issubclass(item, Screen)
            and item.__module__.endswith(module.name)
            and not issubclass(item, ModalScreen)
        }
    return found


COMMON = {"FilesScreen", "FormScreen", "LinesScreen", "PagedScreen"}
"""What several screens are, none of them itself."""


def test_every_screen_has_its_page_of_help() -> None:
    assert set(help_texts.PAGES) | {"SessionScreen"} == classes_of_screens() - COMMON
    for _, words in help_texts.PAGES.values():
        assert max(map(len, words.splitlines())) <= 74
        assert len(words.splitlines()) <= 17


@pytest.mark.parametrize("key", ["", "n", "p"])
async def test_f1_explains_the_screens_without_a_project(key: str) -> None:
    app = SurveyApp(None)
    async with app.run_test(size=SMALL) as pilot:
        await settle(pilot)
        if key:
            await pilot.press(key)
            await settle(pilot)
        explained = help_texts.PAGES[type(app.screen).__name__]
        await pilot.press("f1")
        await settle(pilot)
        assert isinstance(app.screen, HelpScreen)
        assert app.screen.heading == explained[0]
        await pilot.press("escape")
        await settle(pilot)
        assert type(app.screen).__name__ in help_texts.PAGES


async def palette(pilot: Pilot[int]) -> set[str]:
    app = pilot.app
    return {command.title for command in app.get_system_commands(app.screen)}


async def test_the_palette_names_what_the_keys_do(tmp_path: Path) -> None:
    folder = shutil.copytree(PROJECTS / "tongjin-2015", tmp_path / "p")
    app = SurveyApp(str(folder))
    async with app.run_test(size=SMALL) as pilot:
        await settle(pilot)
        names = await palette(pilot)
        pages = {f"Page {n} {t}" for n, t in enumerate(("Sessions", "Lines", "Constants"), 1)}
        assert pages <= names
        assert {"Observe this session", "New session", "Quit"} <= names
        assert not any("focus" in name.lower() or name == "palette" for name in names)
        await pilot.press("o")
        await settle(pilot)
        assert isinstance(app.screen, SessionScreen)
        names = await palette(pilot)
        assert {"Undo: strike the latest reading", "Strike a reading, with a reason"} <= names
        assert "Another kind of reading" in names


async def test_escape_keeps_a_half_filled_form(tmp_path: Path) -> None:
    app = SurveyApp(None)
    async with app.run_test(size=SMALL) as pilot:
        await settle(pilot)
        await pilot.press("n")
        await settle(pilot)
        await pilot.press(*"Ramp 3")
        app.screen.query_one("#stations", TextArea).text = "A 1 2"
        app.screen.query_one("#unit", Select).value = "gon"
        await pilot.press("escape")
        await settle(pilot)
        assert isinstance(app.screen, HomeScreen)
        await pilot.press("n")
        await settle(pilot)
        form = app.screen
        assert isinstance(form, NewProjectScreen)
        assert form.query_one("#name", Input).value == "Ramp 3"
        assert form.query_one("#stations", TextArea).text == "A 1 2"
        assert form.query_one("#unit", Select).value == "gon"
        form.query_one("#folder", Input).value = str(tmp_path / "made")
        await pilot.press("f8")
        await settle(pilot)
        await pilot.press("escape", "n")
        await settle(pilot)
        assert app.screen.query_one("#name", Input).value == ""
    assert (tmp_path / "made" / "project.toml").is_file()


async def test_escape_keeps_a_half_typed_reason(tmp_path: Path) -> None:
    folder = make_project(tmp_path / "p")
    text = book_text(simulated(points=8).rows[:12])
    (folder / "observations" / "r1.csv").write_text(text, encoding="utf-8")
    app = SurveyApp(str(folder))
    async with app.run_test(size=SMALL) as pilot:
        screen = await open_session(pilot)
        await pilot.press("f6", *"slipp", "escape", "f6")
        await settle(pilot)
        assert isinstance(app.screen, StrikeScreen)
        await pilot.press(*"ed", "enter")
        await settle(pilot)
        assert screen.observation.book.rows[-1].note == "slipped"
        struck = ledger_rows(screen.observation.book, None, screen.observation.book.rows)
        assert [row[5] for row in struck if row[4] == "struck"] == ["slipped"]


async def test_a_step_that_has_all_it_needs_says_so(tmp_path: Path) -> None:
    app = SurveyApp(str(make_project(tmp_path / "p")))
    async with app.run_test(size=SMALL) as pilot:
        await settle(pilot)
        await pilot.press("enter")
        await settle(pilot)
        await pilot.press("f8")
        said = []
        for text in ("179-01-56", "02 12"):
            app.screen.query_one(EntryLine).text = text
            await pilot.press("enter")
            await settle(pilot)
            said.append(str(app.screen.query_one("#message", Static).content))
    assert "complete" not in said[0]
    assert said[1].endswith("complete: F8 goes on")


async def test_a_doubt_about_one_target_is_none_about_another(tmp_path: Path) -> None:
    app = SurveyApp(str(make_project(tmp_path / "p")))
    async with app.run_test(size=SMALL) as pilot:
        screen = await open_session(pilot)
        await pilot.press("f8")
        for text in ("179-01-56", "59-02-12"):
            screen.query_one(EntryLine).text = text
            await pilot.press("enter")
            await settle(pilot)
        assert screen.desk.asked == "59-02-12"
        assert "-60°00'16.00" in str(screen.query_one("#message", Static).content)
        await pilot.press("f3")
        assert screen.desk.asked is None
        assert screen.desk.what().face is Face.LEFT


@pytest.mark.parametrize(
    ("angle", "text"),
    [
        ("0-00-05.25", '+5.25"'),
        ("0-04-17.94", "+4'17.94\""),
        ("1-04-17.94", "+1°04'17.94\""),
        ("119-59-44.00", "+119°59'44.00\""),
    ],
)
def test_no_degrees_are_dropped_from_a_difference(angle: str, text: str) -> None:
    value = parse_angle(angle, AngleUnit.DMS)
    assert signed_angle(value) == text
    assert signed_angle(-value) == text.replace("+", "-")
    assert signed_angle(0.0 * ARCSEC) == '+0.00"'


def test_grids_lie_where_east_and_north_lie() -> None:
    here = (NewStation("A", e=37_431_630.0, n=3_811_452.0),)
    codes = {grid.code for grid in api_home.find_grids("CGCS2000 3-degree", here)}
    assert "EPSG:4525" in codes  # zone 37, its number in the easting
    assert "EPSG:4546" not in codes  # the same meridian without it
    assert len(api_home.find_grids("Gauss")) == api_home.MOST_GRIDS


def test_a_bare_code_is_an_epsg_code(tmp_path: Path) -> None:
    form = api_home.NewProject(folder=str(tmp_path / "p"), name="p", crs="4546")
    folder = api_home.create_project(form)
    assert 'crs = "EPSG:4546"' in (Path(folder) / "project.toml").read_text(encoding="utf-8")


async def test_the_sound_is_switched_and_remembered(monkeypatch: pytest.MonkeyPatch) -> None:
    bells: list[int] = []
    app = SurveyApp(None)
    monkeypatch.setattr(app, "bell", lambda: bells.append(1))
    async with app.run_test(size=SMALL) as pilot:
        await settle(pilot)
        app.on_run_pane_near()
        await pilot.press("f10")
        app.on_run_pane_near()
    assert bells == [1]
    assert not SurveyApp(None).settings.sound


@pytest.mark.parametrize("words", ["portugal bonne", "utm grid system", "faroe"])
def test_a_grid_of_the_register_that_cannot_be_computed_with_is_not_offered(words: str) -> None:
    here = read_stations("K1 180000 240000")
    assert api_home.find_grids(words, here) == ()


def test_a_project_on_such_a_grid_says_so() -> None:
    with pytest.raises(SurveyError, match="cannot be computed with"):
        open_grid("EPSG:2963")
