"""A labelled field of a form: one line, some lines, or one of some choices."""

from __future__ import annotations

from collections.abc import Mapping

from textual.app import ComposeResult
from textual.containers import Horizontal, Vertical
from textual.widget import Widget
from textual.widgets import Input, Select, Static, TextArea


class TextField(Horizontal):
    """A label and a line to type in."""

    def __init__(self, label: str, name: str, *, hint: str = "", value: str = "") -> None:
        super().__init__(name=name)
        self.label = label
        self.hint = hint
        self.start = value

    def compose(self) -> ComposeResult:
        """Label and line."""
        yield Static(self.label, classes="label", markup=False)
        line = Input(
            self.start, placeholder=self.hint, compact=True, id=self.name, select_on_focus=False
        )
        line.cursor_blink = False
        yield line


class AreaField(Vertical):
    """A label, some lines to type or paste in, and what may stand there."""

    def __init__(self, label: str, name: str, *, hint: str) -> None:
        super().__init__(name=name)
        self.label = label
        self.hint = hint

    def compose(self) -> ComposeResult:
        """Label beside the lines, the hint below."""
        with Horizontal():
            yield Static(self.label, classes="label", markup=False)
            yield TextArea(id=self.name, compact=True, tab_behavior="focus")
        yield Static(self.hint, classes="told", markup=False)


class ChoiceField(Horizontal):
    """A label and a choice; keys are values, texts are shown."""

    def __init__(self, label: str, name: str, choices: Mapping[str, str]) -> None:
        super().__init__(name=name)
        self.label = label
        self.choices = dict(choices)

    def compose(self) -> ComposeResult:
        """Label and choice."""
        yield Static(self.label, classes="label", markup=False)
        options = [(text, key) for key, text in self.choices.items()]
        yield Select[str](options, allow_blank=False, compact=True, id=self.name)


def typed(form: Widget, name: str) -> str:
    """What stands in a text field of a form."""
    return form.query_one(f"#{name}", Input).value.strip()


def chosen(form: Widget, name: str) -> str:
    """What is chosen in a choice field of a form."""
    value = form.query_one(f"#{name}", Select).value
    return value if isinstance(value, str) else ""
