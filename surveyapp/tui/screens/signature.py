"""Close a session: who signs."""

from __future__ import annotations

from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Vertical
from textual.screen import ModalScreen
from textual.widgets import Input, Static

from surveyapp.tui import texts
from surveyapp.tui.drafts import Draft, keep, put_back


class SignatureScreen(ModalScreen[str | None]):
    """Returns the name, or None."""

    BINDINGS: ClassVar[list[BindingType]] = [Binding("escape", "leave", texts.KEY_LEAVE)]

    def __init__(self, draft: Draft, told: str = "") -> None:
        super().__init__()
        self.told = told
        self.draft = draft

    def compose(self) -> ComposeResult:
        """What closing means, and one line."""
        with Vertical(id="dialog"):
            yield Static(texts.SIGN_TITLE, classes="heading", markup=False)
            yield Static(texts.SIGN_MEANING, markup=False)
            if self.told:
                yield Static(self.told, id="trouble", markup=False)
            line = Input(placeholder=texts.SIGN_NAME, compact=True, select_on_focus=False)
            line.cursor_blink = False
            yield line
            yield Static(texts.SIGN_KEYS, classes="hint", markup=False)

    def on_mount(self) -> None:
        """What was half typed stands there again."""
        put_back(self, self.draft)

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Sign."""
        if event.value.strip():
            self.draft.clear()
            self.dismiss(event.value.strip())

    def action_leave(self) -> None:
        """Sign nothing."""
        keep(self, self.draft)
        self.dismiss(None)
