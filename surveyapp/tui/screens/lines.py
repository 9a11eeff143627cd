"""A small window with a heading and some lines to type in: Enter answers, Escape keeps the text."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterable
from typing import ClassVar, Generic, TypeVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Vertical
from textual.screen import ModalScreen
from textual.widget import Widget
from textual.widgets import Input, Static

from surveyapp.tui import texts
from surveyapp.tui.drafts import Draft, keep, put_back

Answer = TypeVar("Answer")


class LinesScreen(ModalScreen[Answer | None], Generic[Answer]):
    """Returns an answer, or None.

    Parameters
    ----------
    draft : dict
        What was half typed, by field; the screen that opens this one owns it.
    """

    BINDINGS: ClassVar[list[BindingType]] = [Binding("escape", "leave", texts.KEY_LEAVE)]

    def __init__(self, draft: Draft) -> None:
        super().__init__()
        self.draft = draft
        self.wrong = ""
        """Why the latest answer is none."""

    @abstractmethod
    def lines(self) -> Iterable[Widget]:
        """Heading, words and fields."""

    @abstractmethod
    def answer(self) -> Answer | None:
        """What is typed as an answer; None where it is none yet."""

    def compose(self) -> ComposeResult:
        """The window."""
        with Vertical(id="dialog"):
            yield from self.lines()
            yield Static(id="wrong", markup=False)

    def on_mount(self) -> None:
        """What was half typed stands there again."""
        put_back(self, self.draft)
        self.query(Input).first().focus()

    def on_input_submitted(self, _: Input.Submitted) -> None:
        """Answer, if it is one."""
        answer = self.answer()
        if answer is None:
            self.query_one("#wrong", Static).update(self.wrong or texts.LINE_MISSING)
            return
        self.draft.clear()
        self.dismiss(answer)

    def action_leave(self) -> None:
        """Answer nothing; what was typed waits for the next opening."""
        keep(self, self.draft)
        self.dismiss(None)

    def typed(self) -> str:
        """What stands in the first line."""
        return self.query(Input).first().value.strip()


def heading(text: str) -> Static:
    """The heading of a window."""
    return Static(text, classes="heading", markup=False)


def hint(text: str) -> Static:
    """What its keys do."""
    return Static(text, classes="hint", markup=False)


def line(name: str, placeholder: str = "") -> Input:
    """A line to type in."""
    field = Input(placeholder=placeholder, id=name, compact=True, select_on_focus=False)
    field.cursor_blink = False
    return field
