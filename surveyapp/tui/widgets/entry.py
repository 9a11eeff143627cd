"""The line in which a reading is typed: what is asked for, what is typed, how it is understood."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from textual.actions import parse
from textual.app import ComposeResult
from textual.containers import Horizontal, Vertical
from textual.events import Key, Paste
from textual.widgets import Input, Static


class ReadingInput(Input):
    """An input that works off its keys strictly in their order.

    Enter and the keys of the screen are done with before the next key is looked at, not sent round
    as messages: on a slow machine a surveyor types ahead, and a reading must neither take in the
    digits of the next one nor slip into another step.

    Parameters
    ----------
    enter : callable
        Takes the text; whether it was written.
    actions : mapping
        Action of the screen by key.
    """

    def __init__(self, enter: Callable[[str], bool], actions: Mapping[str, str]) -> None:
        super().__init__(id="reading", compact=True, select_on_focus=False)
        self.cursor_blink = False
        self.enter = enter
        self.actions = dict(actions)

    async def _on_key(self, event: Key) -> None:
        key = event.key
        if key == "space" and not self.value:
            key = "empty_space"
        if key == "enter":
            event.stop()
            event.prevent_default()
            if self.enter(self.value):
                self.value = ""
            else:
                self.select_all()
        elif key in self.actions:
            event.stop()
            event.prevent_default()
            action = self.actions[key]
            _, name, parameters = parse(action)
            if self.screen.check_action(name, parameters):
                await self.app.run_action(action, default_namespace=self.screen)
        else:
            await super()._on_key(event)

    def _on_paste(self, event: Paste) -> None:
        """Take the first line that holds anything, without control characters."""
        lines = ("".join(filter(str.isprintable, line)).strip() for line in event.text.splitlines())
        super()._on_paste(Paste(next((line for line in lines if line), "")))
        event.stop()
        event.prevent_default()


class EntryLine(Vertical):
    """Prompt, input, and two lines below: how it is understood, and what became of it.

    Parameters
    ----------
    enter, actions
        As in ``ReadingInput``.
    """

    def __init__(self, enter: Callable[[str], bool], actions: Mapping[str, str]) -> None:
        super().__init__()
        self.enter = enter
        self.actions = actions

    def compose(self) -> ComposeResult:
        """The parts."""
        with Horizontal(id="entry-row"):
            yield Static(id="prompt", markup=False)
            yield ReadingInput(self.enter, self.actions)
            yield Static(id="understood", markup=False)
        yield Static(id="message", markup=False)

    def ask(self, prompt: str, hint: str) -> None:
        """Say what is to be read."""
        self.query_one("#prompt", Static).update(prompt)
        self.query_one(ReadingInput).placeholder = hint

    def understood(self, text: str) -> None:
        """Say how the typed text is understood."""
        self.query_one("#understood", Static).update(text)

    def tell(self, text: str, *, serious: bool = False) -> None:
        """Say what became of it; words are enough, the style only helps."""
        message = self.query_one("#message", Static)
        message.update(text)
        message.set_class(serious, "serious")

    @property
    def text(self) -> str:
        """What stands in the line."""
        return self.query_one(ReadingInput).value

    @text.setter
    def text(self, value: str) -> None:
        reading = self.query_one(ReadingInput)
        reading.value = value
        reading.cursor_position = len(value)
