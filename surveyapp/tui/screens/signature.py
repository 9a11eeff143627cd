"""Close a session: who signs."""

from __future__ import annotations

from collections.abc import Iterable

from textual.widget import Widget
from textual.widgets import Static

from surveyapp.tui import texts
from surveyapp.tui.drafts import Draft
from surveyapp.tui.screens.lines import LinesScreen, heading, hint, line


class SignatureScreen(LinesScreen[str]):
    """Returns the name, or None.

    Parameters
    ----------
    draft : dict
    told : str
        What must be known before signing.
    """

    def __init__(self, draft: Draft, told: str = "") -> None:
        super().__init__(draft)
        self.told = told

    def lines(self) -> Iterable[Widget]:
        """What closing means, and one line."""
        yield heading(texts.SIGN_TITLE)
        yield Static(texts.SIGN_MEANING, markup=False)
        if self.told:
            yield Static(self.told, id="trouble", markup=False)
        yield line("name", texts.SIGN_NAME)
        yield hint(texts.SIGN_KEYS)

    def answer(self) -> str | None:
        """The name."""
        return self.typed() or None
