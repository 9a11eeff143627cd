"""What to do here, in the trade's words, with a picture."""

from __future__ import annotations

from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import VerticalScroll
from textual.screen import ModalScreen
from textual.widgets import Static

from surveyapp.tui import texts
from surveyapp.tui.texts import help_texts
from surveyapp.tui.views.words import refilled


class HelpScreen(ModalScreen[None]):
    """Explains one thing: a heading, words and a picture."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("escape,f1,enter", "leave", texts.KEY_CLOSE),
    ]

    def __init__(self, heading: str, words: str) -> None:
        super().__init__()
        self.heading = heading
        self.words = words

    def compose(self) -> ComposeResult:
        """The words and the picture."""
        with VerticalScroll(id="dialog"):
            yield Static(self.heading, classes="heading", markup=False)
            yield Static(self.words, id="words", classes="picture", markup=False)
            yield Static(help_texts.close_hint(), classes="hint", markup=False)

    def on_resize(self) -> None:
        """In a narrow window the words take its width; a picture stays what it is."""
        self.call_after_refresh(self._fill)

    def _fill(self) -> None:
        room = self.query_one("#dialog").scrollable_content_region.width
        if room:
            self.query_one("#words", Static).update(refilled(self.words, room))

    def action_leave(self) -> None:
        """Close."""
        self.dismiss(None)
