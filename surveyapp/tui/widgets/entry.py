"""The line in which a reading is typed: what is asked for, what is typed, how it is understood."""

from __future__ import annotations

from textual.app import ComposeResult
from textual.containers import Horizontal, Vertical
from textual.events import Key
from textual.message import Message
from textual.widgets import Input, Static


class ReadingInput(Input):
    """An input that passes a space at its beginning on, for timed passages."""

    class Passage(Message):
        """Space was pressed in the empty line."""

    async def _on_key(self, event: Key) -> None:
        if event.key == "space" and not self.value:
            event.stop()
            event.prevent_default()
            self.post_message(self.Passage())
            return
        await super()._on_key(event)


class EntryLine(Vertical):
    """Prompt, input, and two lines below: how it is understood, and what became of it."""

    def compose(self) -> ComposeResult:
        """The parts."""
        with Horizontal(id="entry-row"):
            yield Static(id="prompt", markup=False)
            yield ReadingInput(id="reading", compact=True, select_on_focus=False)
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
