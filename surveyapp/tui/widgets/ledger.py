"""The readings of a step as they stand in the book: struck ones stay visible."""

from __future__ import annotations

from collections.abc import Sequence

from rich.text import Text
from textual.app import ComposeResult
from textual.containers import Vertical, VerticalScroll
from textual.widgets import Static

from surveyapp.tui import texts

STATE = 4
RIGHT = (0, 5)


class Ledger(Vertical):
    """A heading, and the readings with the latest always in sight."""

    def compose(self) -> ComposeResult:
        """Heading and rows."""
        yield Static(id="ledger-head", markup=False)
        with VerticalScroll(can_focus=False):
            yield Static(id="ledger-rows", markup=False)

    def on_resize(self) -> None:
        """Keep the end in sight where an alarm or a longer forecast takes lines from the ledger."""
        self.to_end()

    def to_end(self) -> None:
        """Scroll to the latest reading, once everything has its place."""
        self.call_after_refresh(self.query_one(VerticalScroll).scroll_end, animate=False)

    def show(self, rows: Sequence[Sequence[str]], *, scale: bool = False) -> None:
        """Replace all rows; ``scale``: residuals are divisions."""
        head = texts.LEDGER_COLUMNS_DIV if scale else texts.LEDGER_COLUMNS
        table = [head, *rows]
        widths = [max(len(row[i]) for row in table) for i in range(len(texts.LEDGER_COLUMNS))]
        lines = [
            " ".join(
                cell.rjust(width) if i in RIGHT else cell.ljust(width)
                for i, (cell, width) in enumerate(zip(row, widths, strict=True))
            )
            for row in table
        ]
        self.query_one("#ledger-head", Static).update(Text(lines[0], style="bold underline"))
        text = Text()
        for line, row in zip(lines[1:], rows, strict=True):
            text.append(f"{line}\n", style="strike" if row[STATE] == texts.LEDGER_STRUCK else "")
        text.rstrip()
        self.query_one("#ledger-rows", Static).update(text)
        self.to_end()
