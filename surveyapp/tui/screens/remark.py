"""A remark for the field book, at any time."""

from __future__ import annotations

from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Vertical
from textual.screen import ModalScreen
from textual.widgets import Input, Static

from surveyapp.tui import texts
from surveyapp.tui.drafts import Draft, keep, put_back


class RemarkScreen(ModalScreen[str | None]):
    """Returns the remark, or None."""

    BINDINGS: ClassVar[list[BindingType]] = [Binding("escape", "leave", texts.KEY_LEAVE)]

    def __init__(self, draft: Draft) -> None:
        super().__init__()
        self.draft = draft

    def compose(self) -> ComposeResult:
        """What it is for, and one line."""
        with Vertical(id="dialog"):
            yield Static(texts.REMARK_TITLE, classes="heading", markup=False)
            yield Static(texts.REMARK_MEANING, markup=False)
            line = Input(id="remark", compact=True, select_on_focus=False)
            line.cursor_blink = False
            yield line
            yield Static(texts.REMARK_KEYS, classes="hint", markup=False)

    def on_mount(self) -> None:
        """What was half typed stands there again."""
        put_back(self, self.draft)
        self.query_one(Input).focus()

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Write it."""
        if event.value.strip():
            self.draft.clear()
            self.dismiss(event.value.strip())

    def action_leave(self) -> None:
        """Write nothing."""
        keep(self, self.draft)
        self.dismiss(None)
