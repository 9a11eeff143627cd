"""In every language no key, title, tab, label or text of any screen is cut, in three windows.

One application a language walks through all screens; each is looked at in three sizes. The screens
read their texts when their modules are loaded: each language loads them anew.
"""

from __future__ import annotations

import os
import shutil
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest
from textual.pilot import Pilot
from textual.screen import Screen
from textual.widgets import Static, Tab, TabbedContent
from textual.widgets._footer import FooterKey

from surveyapp import languages
from surveyapp.core.simulate.session import book_text
from surveyapp.report.text import display_width
from tests.tui.helpers_tui import LARGE, SMALL, Clock, make_project, simulated

ROOT = Path(__file__).resolve().parents[2]
SCREENS = "surveyapp.tui"
NARROW = (60, 18)
EVERY_SIZE = "SURVEYAPP_FIT_EVERY_SIZE"
"""With this variable (``make fit``) every language is looked at in every window, two minutes; else
each walk is gone in these, in which all languages and all windows have their turn (of English, the
shortest, the pictures are looked at)."""
LANGUAGES = ("en", "de", "ru", "zh")
WALKS = {
    "home": {"de": NARROW, "zh": SMALL},
    "project": {"de": NARROW, "zh": SMALL},
    "session": {"de": NARROW, "ru": SMALL},
    "sensors": {"de": SMALL},
    "results": {"ru": LARGE},
    "settings": {"ru": SMALL},
}


def languages_of(walk: str) -> pytest.MarkDecorator:
    """The languages in which a walk is gone."""
    chosen = LANGUAGES if os.environ.get(EVERY_SIZE) else tuple(WALKS[walk])
    return pytest.mark.parametrize("language", chosen, indirect=True)


def sizes_of(walk: str, language: str) -> tuple[tuple[int, int], ...]:
    """Windows in which it is looked at in a language."""
    return (LARGE, SMALL, NARROW) if os.environ.get(EVERY_SIZE) else (WALKS[walk][language],)


def _loaded() -> dict[str, Any]:
    return {name: module for name, module in sys.modules.items() if name.startswith(SCREENS)}


@pytest.fixture
def language(
    request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[str]:
    """Screens in one language; afterwards those of the other tests are put back."""
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    monkeypatch.setenv("TEXTUAL_ANIMATIONS", "none")
    monkeypatch.setattr(Screen, "_compositor_refresh", lambda _screen: None)  # nothing is painted
    before = _loaded()
    for name in before:
        del sys.modules[name]
    languages.use(request.param)
    yield str(request.param)
    languages.use("en")
    for name in _loaded():
        del sys.modules[name]
    sys.modules.update(before)
    sys.modules["surveyapp"].tui = before.get(SCREENS)  # type: ignore[attr-defined]


def cut_parts(app: Any) -> list[str]:
    """What of the open screen is cut by its place or by the edge of the window."""
    screen: Any = app.screen
    width: int = app.size.width
    found = [f"key {key.render()}" for key in screen.query(FooterKey) if key.region.right > width]
    keys = {key.key for key in screen.query(FooterKey)}
    way_out = screen.active_bindings.get("escape")
    if keys and way_out is not None and way_out.binding.show and "escape" not in keys:
        found.append("no key leads out")
    for tab in screen.query(Tab):
        shown = _on_screen(tab) and tab.region.right > width
        found += [f"tab {tab.label}"] if shown else []
    for listing in screen.query("DataTable, VerticalScroll, TextArea"):  # choices are wrapped
        if _on_screen(listing) and listing.max_scroll_x > 0 and not listing.query("#words"):
            found.append(f"{listing!r} is {listing.max_scroll_x} columns wider than its place")
    for text in screen.query(Static):
        found += _cut_text(text, narrow=width < SMALL[0])
    for dialog in screen.query("#dialog"):
        inside = [child for child in dialog.children if child.region.height]
        lowest = max(child.region.bottom for child in inside)
        if lowest > dialog.region.bottom and not dialog.allow_vertical_scroll:
            found.append(f"the window hides {lowest - dialog.region.bottom} rows")
    return found


def _on_screen(widget: Any) -> bool:
    return bool(widget.region.height and widget.region.width) and all(
        parent.display for parent in widget.ancestors_with_self if hasattr(parent, "display")
    )


def _cut_text(text: Any, *, narrow: bool) -> list[str]:
    """A line that is wider than its place, and rows that a text has too many."""
    if not _on_screen(text) or isinstance(text, Tab):
        return []
    plain = str(text.render())
    room = text.content_size
    ellipsis = text.id in ("title", "state")
    if narrow and (ellipsis or text.id == "words"):
        return []  # a long name ends in dots there, and a picture of F1 is moved sideways
    if room.height == 1 and "\n" not in plain and display_width(plain.rstrip()) > room.width:
        return [f"{plain!r} in {room.width} columns"]
    if text.styles.text_wrap == "nowrap":
        widest = max((display_width(line.rstrip()) for line in plain.split("\n")), default=0)
        return [f"{plain!r} is {widest} wide in {room.width}"] if widest > room.width else []
    return []


async def settle(pilot: Pilot[int]) -> None:
    for _ in range(2):
        await pilot.pause()
    while any(not worker.is_finished for worker in pilot.app.workers):
        await pilot.app.workers.wait_for_complete()
        await pilot.pause()


def text_of(app: Any) -> str:
    lines = app.screen._compositor.render_strips()
    return "\n".join("".join(segment.text for segment in strip) for strip in lines)


class Walk:
    """Goes from screen to screen; looks at each in one window after the other."""

    def __init__(self, pilot: Pilot[int], sizes: Sequence[tuple[int, int]]) -> None:
        self.pilot = pilot
        self.sizes = sizes
        self.cut: list[str] = []
        self.seen: set[str] = set()

    async def press(self, *keys: str) -> None:
        """Press keys, each after the last computation has been shown."""
        for key in keys:
            await settle(self.pilot)
            await self.pilot.press(key)
        await settle(self.pilot)

    async def look(self, pages: int = 0) -> None:
        """What is cut on this screen, or on its pages."""
        for size in self.sizes:
            if self.pilot.app.size != size:
                await self.pilot.resize_terminal(*size)
                await settle(self.pilot)
                await self.pilot.pause()
            for number in range(1, pages + 1):
                await self.press(str(number))
                self.note()
            if not pages:
                self.note()

    def note(self) -> None:
        """Keep what is cut in this window."""
        app = self.pilot.app
        name = type(app.screen).__name__
        self.seen.add(name)
        for tabs in app.screen.query(TabbedContent):
            name = f"{name} {tabs.active}"
        where = f"{name} in {app.size.width}x{app.size.height}: "
        self.cut += [f"{where}{part[-120:]}" for part in cut_parts(app)]

    def ended(self) -> None:
        """Nothing was cut."""
        if self.cut:
            pytest.fail("\n".join(self.cut))

    async def open(self, *keys: str) -> None:
        """Open a screen, look at it, and come back."""
        before = self.pilot.app.screen
        await self.press(*keys)
        await self.look()
        for _ in range(4):
            if self.pilot.app.screen is before:
                return
            await self.press("escape")
        raise AssertionError(f"no way back to {before}")


def own_copy(tmp_path: Path, name: str) -> str:
    return str(shutil.copytree(ROOT / "projects" / name, tmp_path / name))


def app_on(folder: str | None) -> Any:
    from surveyapp.tui.app import SurveyApp

    clock = Clock()
    clock.pass_by(4210.0)
    return SurveyApp(folder, now=clock.now, steady=clock.steady)


@languages_of("home")
async def test_home_and_its_forms(language: str, tmp_path: Path) -> None:
    app = app_on(None)
    async with app.run_test(size=SMALL) as pilot:
        walk = Walk(pilot, sizes_of("home", language))
        await walk.look()
        assert languages.translated("Recent projects") in text_of(app)
        for key in ("f1", "n", "o", "p"):
            await walk.open(key)
        walk.ended()
        assert len(walk.seen) == 5


@languages_of("project")
async def test_a_project_and_everything_it_opens(language: str, tmp_path: Path) -> None:
    app = app_on(None)
    folder = own_copy(tmp_path, "synthetic-breakthrough")
    async with app.run_test(size=SMALL) as pilot:
        walk = Walk(pilot, sizes_of("project", language))
        for screen, pages, keys in screens_of(folder):
            app.push_screen(screen)
            await settle(pilot)
            await walk.look(pages)
            for key in keys:
                await walk.press(key)
                await walk.look()
            while app.screen is not screen:
                await walk.press("escape")
            app.pop_screen()
        walk.ended()
        assert len(walk.seen) == 13, walk.seen


def screens_of(folder: str) -> Iterator[tuple[Any, int, tuple[str, ...]]]:
    """Every screen that a project opens, its pages, and keys that open a window before it."""
    from surveyapp import api
    from surveyapp.tui.screens.add_log import AddLogScreen
    from surveyapp.tui.screens.correct import ChooseTableScreen, CorrectScreen
    from surveyapp.tui.screens.diagnosis import DiagnosisScreen
    from surveyapp.tui.screens.exchange import ImportScreen
    from surveyapp.tui.screens.export import ExportScreen
    from surveyapp.tui.screens.new_session import NewSessionScreen
    from surveyapp.tui.screens.penetration import PenetrationScreen
    from surveyapp.tui.screens.project import ProjectScreen
    from surveyapp.tui.screens.shaft import ShaftScreen
    from surveyapp.tui.screens.traverse import TraverseScreen

    project = api.open_project(folder)
    unit = project.angle_unit
    yield ProjectScreen(folder, "synthetic-breakthrough"), 5, ("f1",)
    yield TraverseScreen(folder, ("A", "B"), unit), 5, ("f1",)
    yield PenetrationScreen(folder), 4, ("d", "escape", "f1")
    yield ShaftScreen(folder, unit), 4, ("f1",)
    yield DiagnosisScreen(folder, "synthetic-breakthrough", unit), 0, ("f1",)
    yield NewSessionScreen(folder, project, {}), 0, ("f1",)
    yield ImportScreen(folder), 0, ("f1",)
    yield ExportScreen(folder), 0, ("f1",)
    yield AddLogScreen(folder), 0, ("f1",)
    choice = ChooseTableScreen(folder)
    yield choice, 0, ()
    yield CorrectScreen(folder, choice.tables[-1]), 0, ("f1",)


@languages_of("session")
async def test_a_session_its_windows_and_its_result(language: str, tmp_path: Path) -> None:
    folder = make_project(tmp_path / "ramp-3")
    book = folder / "observations" / "r1.csv"
    book.write_text(book_text(simulated(points=12).rows[:17]), encoding="utf-8")
    app = app_on(str(folder))
    async with app.run_test(size=SMALL) as pilot:
        walk = Walk(pilot, sizes_of("session", language))
        await walk.press("enter")
        await walk.look()
        for key in ("f1", "f6", "ctrl+n"):
            await walk.open(key)
        for _ in range(4):  # back to the set-up
            await walk.press("f7")
            await walk.look()
        await walk.press(*["f8"] * 4)
        for _ in range(4):
            await walk.press("f8")
            await walk.look()
        assert "SessionScreen" in walk.seen
        await walk.open("f6")
        walk.ended()
        assert {"HelpScreen", "StrikeScreen", "RemarkScreen"} <= walk.seen
        assert {"ResultScreen", "SignatureScreen"} <= walk.seen


@languages_of("sensors")
async def test_sensor_logs_and_programmes(language: str, tmp_path: Path) -> None:
    app = app_on(own_copy(tmp_path, "mpu6050-static"))
    async with app.run_test(size=SMALL) as pilot:
        walk = Walk(pilot, sizes_of("sensors", language))
        await walk.press("l")
        await walk.look()
        await walk.press("enter")
        await walk.look()
        await walk.press("l", "v")
        await walk.look()
        await walk.press("escape")
        await walk.open("3", "enter")
        walk.ended()
        assert {"SensorLogScreen", "ProgrammeScreen"} <= walk.seen


@languages_of("results")
async def test_results_are_told_and_not_only_menus(language: str, tmp_path: Path) -> None:
    app = app_on(own_copy(tmp_path, "tongjin-2015"))
    async with app.run_test(size=LARGE) as pilot:
        walk = Walk(pilot, sizes_of("results", language))
        await walk.press("4")
        assert languages.translated("NOT MET") in text_of(app)
        await walk.press("2")
        lines = text_of(app)
        assert languages.translated("known azimuth") in lines  # a source of the budget
        assert language == "en" or "known azimuth" not in lines
        with (Path(app.folder) / "project.toml").open("a", encoding="utf-8") as file:
            file.write("\n[[station]\n")
        await walk.press("f5")
        assert languages.translated("this project cannot be used as it stands") in text_of(app)
        await walk.look()
        walk.ended()


@languages_of("settings")
async def test_another_language_is_remembered_and_begins_anew(
    language: str, tmp_path: Path
) -> None:
    from surveyapp.io.settings import read_settings
    from surveyapp.tui.app import OTHER_LANGUAGE, SurveyApp

    app = SurveyApp(None)
    async with app.run_test(size=SMALL) as pilot:
        await pilot.press("l")
        await pilot.pause()
    assert app.return_value == OTHER_LANGUAGE
    codes = list(languages.LANGUAGES)
    following = codes[(codes.index(language) + 1) % len(codes)]
    assert read_settings().language == following
    assert languages.preferred(read_settings().language) == following
