"""Type the folder of a project."""

from __future__ import annotations

from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Vertical
from textual.screen import ModalScreen
from textual.widgets import Input, Static

from surveyapp.tui import texts
from surveyapp.tui.drafts import Draft, keep, put_back


class FolderScreen(ModalScreen[str | None]):
    """Returns the folder, or None."""

    BINDINGS: ClassVar[list[BindingType]] = [Binding("escape", "leave", texts.KEY_LEAVE)]

    def __init__(self, draft: Draft) -> None:
        super().__init__()
        self.draft = draft

    def compose(self) -> ComposeResult:
        """One line."""
        with Vertical(id="dialog"):
            yield Static(texts.HOME_FOLDER_TITLE, classes="heading", markup=False)
            line = Input(placeholder=texts.HOME_FOLDER, compact=True, select_on_focus=False)
            line.cursor_blink = False
            yield line

    def on_mount(self) -> None:
        """What was half typed stands there again."""
        put_back(self, self.draft)

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Open it."""
        self.draft.clear()
        self.dismiss(event.value.strip() or None)

    def action_leave(self) -> None:
        """Open nothing."""
        keep(self, self.draft)
        self.dismiss(None)
