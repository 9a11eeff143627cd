"""Type the folder of a project."""

from __future__ import annotations

from collections.abc import Iterable

from textual.widget import Widget

from surveyapp.tui import texts
from surveyapp.tui.screens.lines import LinesScreen, heading, line


class FolderScreen(LinesScreen[str]):
    """Returns the folder, or None."""

    def lines(self) -> Iterable[Widget]:
        """One line."""
        yield heading(texts.HOME_FOLDER_TITLE)
        yield line("folder", texts.HOME_FOLDER)

    def answer(self) -> str | None:
        """The folder."""
        return self.typed() or None
