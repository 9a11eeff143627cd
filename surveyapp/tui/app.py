"""The application: opens the first screen and holds what all screens share."""

from __future__ import annotations

import asyncio
import contextlib
import signal
from collections.abc import Callable, Iterable
from datetime import datetime
from functools import partial
from pathlib import Path
from typing import ClassVar

from textual.app import App, SystemCommand
from textual.binding import Binding, BindingType
from textual.screen import Screen

from surveyapp.errors import SurveyError
from surveyapp.io.fieldbook.clock import local_now, steady_seconds
from surveyapp.io.settings import read_settings
from surveyapp.languages import LANGUAGES, current, shown
from surveyapp.observation import home as api_home
from surveyapp.observation import practice as api_practice
from surveyapp.observation import preferences
from surveyapp.observation.practice import Practice
from surveyapp.observation.session import SessionDesk
from surveyapp.tui import texts
from surveyapp.tui.entry_desk import Pending
from surveyapp.tui.messages import ResultWanted, SessionLeft
from surveyapp.tui.screens.help import HelpScreen
from surveyapp.tui.screens.home import HomeScreen
from surveyapp.tui.screens.project import ProjectScreen
from surveyapp.tui.screens.result import ResultScreen
from surveyapp.tui.screens.session import SessionScreen
from surveyapp.tui.texts import help_texts
from surveyapp.tui.themes import THEMES

OTHER_LANGUAGE = -2
"""What ``run_app`` returns when another language was chosen: run again, in that one."""
UNLISTED = ("command_palette", "app.focus_previous", "app.focus_next", "screen.copy_text")
"""Actions of the keyboard as such, which nobody looks for in the palette."""


class SurveyApp(App[int]):
    """The terminal screens.

    Parameters
    ----------
    folder : str or None
        Project folder to open; None begins with the home screen.
    now, steady : callable
        Wall clock, and seconds that never go back; for tests and pictures.
    practice : Practice or None
        A practice session to begin with.
    """

    CSS_PATH = "app.tcss"
    TITLE = texts.APP_TITLE
    ENABLE_COMMAND_PALETTE = True
    HORIZONTAL_BREAKPOINTS = [(0, "-tiny"), (70, "-narrow"), (110, "-wide")]  # noqa: RUF012
    VERTICAL_BREAKPOINTS = [(0, "-low"), (22, "-high")]  # noqa: RUF012
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("f1", "help", texts.KEY_HELP),
        Binding("f9", "next_theme", texts.KEY_THEME, show=False),
        Binding("f10", "sound", texts.KEY_SOUND, show=False),
        Binding("ctrl+q", "quit", texts.KEY_QUIT, priority=True, show=False),
    ]

    def __init__(
        self,
        folder: str | None,
        *,
        now: Callable[[], datetime] = local_now,
        steady: Callable[[], float] = steady_seconds,
        practice: Practice | None = None,
    ) -> None:
        super().__init__()
        self.folder = folder
        self.clocks = now, steady
        self.now, self.steady = now, steady
        self.practice = practice
        self.drafts: dict[str, Pending] = {}
        self.settings = read_settings()

    def on_mount(self) -> None:
        """Show the first screen."""
        self._end_by_signal()
        for theme in THEMES:
            self.register_theme(theme)
        known = [theme.name for theme in THEMES]
        self.theme = self.settings.theme if self.settings.theme in known else known[0]
        if self.folder is None:
            self.push_screen(HomeScreen())
            if self.practice is not None:
                self.observe_practice(self.practice)
        else:
            self.open_folder(self.folder)

    def _end_by_signal(self) -> None:
        """Give the terminal back as it was when the system ends the program."""
        if self.is_headless:
            return
        loop = asyncio.get_running_loop()
        for name in ("SIGTERM", "SIGHUP", "SIGQUIT"):
            number = getattr(signal, name, None)  # Windows has not all of them
            if number is not None:
                with contextlib.suppress(NotImplementedError, RuntimeError, ValueError):
                    loop.add_signal_handler(number, self.exit, 128 + int(number))

    def get_system_commands(self, screen: Screen[object]) -> Iterable[SystemCommand]:
        """Every action of the screen that is open, then those of the program."""
        for active in screen.active_bindings.values():
            binding = active.binding
            if not binding.description or binding.action in UNLISTED or not active.enabled:
                continue
            if active.node in (screen, self):
                run = partial(self.run_action, binding.action, active.node)
                name = binding.tooltip or binding.description
                yield SystemCommand(name, self.get_key_display(binding), run)

    def action_help(self) -> None:
        """Explain the screen that is open; a session explains its step itself."""
        page = help_texts.page_of(type(self.screen).__name__)
        if page is not None:
            self.push_screen(HelpScreen(*page))

    def action_next_theme(self) -> None:
        """Dark, light, high contrast, and round again."""
        names = [theme.name for theme in THEMES]
        self.theme = names[(names.index(self.theme) + 1) % len(names)]
        preferences.keep_theme(self.theme)

    def action_sound(self) -> None:
        """Let the countdown be heard, or not; remembered."""
        self.settings = preferences.keep_sound(sound=not self.settings.sound)
        self.notify(texts.SOUND_ON if self.settings.sound else texts.SOUND_OFF, markup=False)

    def action_language(self) -> None:
        """The next language; remembered, and the screens begin again in it."""
        codes = list(LANGUAGES)
        wanted = codes[(codes.index(current()) + 1) % len(codes)]
        if preferences.keep_language(wanted):
            self.exit(OTHER_LANGUAGE)
        else:
            self.notify(texts.LANGUAGE_NOT_KEPT, severity="warning", markup=False)

    def open_folder(self, folder: str) -> None:
        """Open a project and remember it."""
        self.folder = str(Path(folder).expanduser())
        self.practice = None
        self.now, self.steady = self.clocks
        self.settings = api_home.remember(self.folder)
        self.push_screen(ProjectScreen(self.folder, Path(self.folder).resolve().name))

    def on_home_screen_folder_chosen(self, message: HomeScreen.FolderChosen) -> None:
        """Open what was chosen."""
        self.open_folder(message.folder)
        if message.importing:
            from surveyapp.tui.screens.exchange import ImportScreen

            self.push_screen(ImportScreen(message.folder))

    def open_session(self, session: str) -> None:
        """Open a session of the project for observing."""
        if self.folder is None:
            return
        try:
            observation = SessionDesk(self.folder, session, now=self.now, steady=self.steady)
        except SurveyError as error:
            self.notify(shown(error.text), severity="error", markup=False)
            return
        draft = self.drafts.pop(session, None)
        self.push_screen(SessionScreen(observation, draft, self.practice))

    def on_project_screen_session_chosen(self, message: ProjectScreen.SessionChosen) -> None:
        """Observe a session of the project."""
        self.open_session(message.session)

    async def on_session_left(self, message: SessionLeft) -> None:
        """Back to the project; what was half typed waits for the next opening."""
        if message.draft is not None:
            self.drafts[message.session] = message.draft
        await self.action_pop_screen()
        if isinstance(self.screen, ProjectScreen):
            self.screen.action_reload()

    async def on_result_wanted(self, message: ResultWanted) -> None:
        """Show what the session says; the right to write is given back first."""
        if self.folder is not None and isinstance(self.screen, SessionScreen):
            self.screen.observation.close()
            await self.switch_screen(ResultScreen(self.folder, message.session, self.practice))

    def observe_practice(self, practice: Practice) -> None:
        """Open the session screen on a simulated instrument."""
        self.practice = practice
        self.folder = practice.folder
        self.now, self.steady = practice.now, practice.steady
        self.open_session(api_practice.SESSION)

    def on_home_screen_practice_chosen(self, message: HomeScreen.PracticeChosen) -> None:
        """Practise as wished."""
        wish = message.wish
        try:
            practice = api_practice.begin(
                api_practice.practice_folder(),
                method=wish.method,
                speed=wish.speed,
                disturbed=wish.disturbed,
            )
        except SurveyError as error:
            self.notify(shown(error.text), severity="error", markup=False)
            return
        self.observe_practice(practice)

    def on_run_pane_near(self) -> None:
        """The next turning point is near: make it heard."""
        if self.settings.sound:
            self.bell()

    async def action_leave(self) -> None:
        """Leave a project: back to where one came from, or out."""
        if len(self.screen_stack) > 2:
            await self.action_pop_screen()
        else:
            self.exit(0)


def run_app(folder: str | None) -> int:
    """Run the screens until they are left.

    Parameters
    ----------
    folder : str or None
        Project folder to open; None begins with the home screen.

    Returns
    -------
    int
        Exit code of the program.
    """
    result = SurveyApp(folder).run()
    return 0 if result is None else result


def run_practice(practice: Practice) -> int:
    """Run the screens on a practice session until they are left; the exit code."""
    result = SurveyApp(None, practice=practice).run()
    return 0 if result is None else result
