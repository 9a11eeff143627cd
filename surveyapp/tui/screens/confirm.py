"""One question, answered by Enter or Escape."""

from __future__ import annotations

from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Vertical
from textual.screen import ModalScreen
from textual.widgets import Static

from surveyapp.tui import texts


class ConfirmScreen(ModalScreen[bool]):
    """Returns True for Enter, False for Escape."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("enter", "answer(True)", texts.KEY_YES),
        Binding("escape", "answer(False)", texts.KEY_LEAVE),
    ]

    def __init__(self, question: str) -> None:
        super().__init__()
        self.question = question

    def compose(self) -> ComposeResult:
        """The question and its keys."""
        with Vertical(id="dialog"):
            yield Static(self.question, classes="heading", markup=False)
            yield Static(texts.CONFIRM_KEYS, classes="hint", markup=False)

    def action_answer(self, confirmed: bool) -> None:
        """Return the answer."""
        self.dismiss(confirmed)
