"""Record that a step of the procedure is done: who, with which file, readings of a check.

Returns the entry, or None; nothing typed is lost when it is left.
"""

from __future__ import annotations

from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Vertical
from textual.screen import ModalScreen
from textual.widgets import Input, Static

from surveyapp.domain.penetration import STEP_TITLES, ProcedureStep
from surveyapp.tui import texts
from surveyapp.tui.drafts import Draft, keep, put_back
from surveyapp.tui.views.penetration import CHECKS_STEP, typed_reading
from surveyapp.tui.widgets.field import TextField, typed


class RecordStepScreen(ModalScreen[ProcedureStep | None]):
    """One entry of one step."""

    BINDINGS: ClassVar[list[BindingType]] = [Binding("escape", "leave", texts.KEY_LEAVE)]
    DEFAULT_CSS = """
    RecordStepScreen TextField { height: 1; }
    RecordStepScreen .label { width: 18; }
    RecordStepScreen Input { width: 1fr; }
    """

    def __init__(self, step: int, draft: Draft) -> None:
        super().__init__()
        self.step = step
        self.draft = draft

    def compose(self) -> ComposeResult:
        """The fields of an entry."""
        with Vertical(id="dialog"):
            title = f"{self.step} {STEP_TITLES[self.step - 1]}"
            yield Static(title, classes="heading", markup=False)
            yield TextField(texts.R_BY, "by")
            yield TextField(texts.R_FILE, "file", hint=texts.R_FILE_HINT)
            yield TextField(texts.R_NOTE, "note")
            if self.step == CHECKS_STEP:
                yield TextField(texts.R_CENTRE, "centre", hint=texts.R_CENTRE_HINT)
                yield TextField(texts.R_WAIST, "waist", hint=texts.R_WAIST_HINT)
            yield Static(id="wrong", markup=False)
            yield Static(texts.R_KEYS, classes="hint", markup=False)

    def on_mount(self) -> None:
        """What was half typed stands there again."""
        put_back(self, self.draft)

    def on_input_submitted(self, _: Input.Submitted) -> None:
        """Record, if everything can be understood."""
        readings: list[float | None] = [None, None]
        if self.step == CHECKS_STEP:
            try:
                readings = [typed_reading(typed(self, name)) for name in ("centre", "waist")]
            except ValueError:
                self.query_one("#wrong", Static).update(texts.R_NO_NUMBER)
                return
        by = typed(self, "by")
        if not by:
            self.query_one("#wrong", Static).update(texts.R_NOBODY)
            return
        file, note = typed(self, "file"), typed(self, "note")
        self.draft.clear()
        self.dismiss(ProcedureStep(self.step, "", by, note, file, readings[0], readings[1]))

    def action_leave(self) -> None:
        """Record nothing."""
        keep(self, self.draft)
        self.dismiss(None)
