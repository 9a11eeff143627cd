"""A remark for the field book, at any time."""

from __future__ import annotations

from collections.abc import Iterable

from textual.widget import Widget
from textual.widgets import Static

from surveyapp.tui import texts
from surveyapp.tui.screens.lines import LinesScreen, heading, hint, line


class RemarkScreen(LinesScreen[str]):
    """Returns the remark, or None."""

    def lines(self) -> Iterable[Widget]:
        """What it is for, and one line."""
        yield heading(texts.REMARK_TITLE)
        yield Static(texts.REMARK_MEANING, markup=False)
        yield line("remark")
        yield hint(texts.REMARK_KEYS)

    def answer(self) -> str | None:
        """The remark."""
        return self.typed() or None
