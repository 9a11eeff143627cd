"""The first line of every screen: what is open on the left, its state on the right."""

from __future__ import annotations

from textual.app import ComposeResult
from textual.containers import Horizontal
from textual.reactive import reactive
from textual.widgets import Static


class TitleBar(Horizontal):
    """One line; ``state`` may be changed at any time."""

    state: reactive[str] = reactive("")

    def __init__(self, title: str) -> None:
        super().__init__()
        self.title = title

    def compose(self) -> ComposeResult:
        """Title and state."""
        yield Static(self.title, id="title", markup=False)
        yield Static("", id="state", markup=False)

    def watch_state(self, state: str) -> None:
        """Show the new state."""
        if self.is_mounted:
            self.query_one("#state", Static).update(state)
