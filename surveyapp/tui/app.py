"""The application: opens the first screen and holds what all screens share."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

from textual.app import App
from textual.binding import Binding, BindingType

from surveyapp.tui import texts
from surveyapp.tui.screens.home import HomeScreen
from surveyapp.tui.screens.project import ProjectScreen


class SurveyApp(App[int]):
    """The terminal screens.

    Parameters
    ----------
    folder : str or None
        Project folder to open; None begins with the home screen.
    """

    CSS_PATH = "app.tcss"
    TITLE = texts.APP_TITLE
    ENABLE_COMMAND_PALETTE = True
    HORIZONTAL_BREAKPOINTS = [(0, "-narrow"), (110, "-wide")]  # noqa: RUF012
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("ctrl+q", "quit", texts.KEY_QUIT, priority=True),
    ]

    def __init__(self, folder: str | None) -> None:
        super().__init__()
        self.folder = folder

    def on_mount(self) -> None:
        """Show the first screen."""
        if self.folder is None:
            self.push_screen(HomeScreen())
        else:
            self.push_screen(ProjectScreen(self.folder, Path(self.folder).resolve().name))

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
