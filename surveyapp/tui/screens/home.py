"""Where one begins: recent projects and samples."""

from __future__ import annotations

from textual.app import ComposeResult
from textual.screen import Screen
from textual.widgets import Footer, Static

from surveyapp.tui import texts
from surveyapp.tui.widgets.titlebar import TitleBar


class HomeScreen(Screen[None]):
    """The first screen without a project."""

    def compose(self) -> ComposeResult:
        """Title and what can be opened."""
        yield TitleBar(texts.HOME_TITLE)
        yield Static(texts.HOME_EMPTY, classes="empty", markup=False)
        yield Footer()
