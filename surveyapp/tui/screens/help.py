"""What to do in a step, in the trade's words, with a picture."""

from __future__ import annotations

from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import VerticalScroll
from textual.screen import ModalScreen
from textual.widgets import Static

from surveyapp.core.steps import Step
from surveyapp.tui import help_texts, texts


class HelpScreen(ModalScreen[None]):
    """Explains one step of one method."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("escape,f1,enter", "leave", texts.KEY_CLOSE),
    ]

    def __init__(self, step: Step, method: str) -> None:
        super().__init__()
        self.step = step
        self.method = method

    def compose(self) -> ComposeResult:
        """The words and the picture."""
        name = texts.STEP_NAMES[self.step]
        if self.step is Step.SWING:
            name = texts.SWING_NAMES[self.method]
        with VerticalScroll(id="dialog"):
            yield Static(name, classes="heading", markup=False)
            yield Static(
                help_texts.help_of(self.step, self.method), classes="picture", markup=False
            )
            yield Static(help_texts.CLOSE_HINT, classes="hint", markup=False)

    def action_leave(self) -> None:
        """Close."""
        self.dismiss(None)
