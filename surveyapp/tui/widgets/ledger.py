"""The readings of a step as they stand in the book: struck ones stay visible."""

from __future__ import annotations

from collections.abc import Sequence

from rich.text import Text
from textual.app import ComposeResult
from textual.containers import Vertical, VerticalScroll
from textual.widgets import Static

from surveyapp.tui import texts
from surveyapp.tui.cells import columns, padded
from surveyapp.tui.views.words import refilled

STATE, RESIDUAL = 4, 5
RIGHT = (0, RESIDUAL)


class Ledger(Vertical):
    """A heading, and the readings with the latest always in sight."""

    def __init__(self) -> None:
        super().__init__()
        self.hint = ""

    def compose(self) -> ComposeResult:
        """Heading and rows."""
        yield Static(id="ledger-head", markup=False)
        with VerticalScroll(can_focus=False):
            yield Static(id="ledger-rows", markup=False)

    def on_resize(self) -> None:
        """Keep the end in sight where an alarm or a longer forecast takes lines from the ledger."""
        self.show_hint()
        self.to_end()

    def show_hint(self) -> None:
        """What is to be done where there are no rows, its lines ended between words."""
        if self.hint:
            width = self.content_size.width or columns(self.hint)
            self.query_one("#ledger-rows", Static).update(refilled(self.hint, width))

    def to_end(self) -> None:
        """Scroll to the latest reading, once everything has its place."""
        self.call_after_refresh(self.query_one(VerticalScroll).scroll_end, animate=False)

    def show(self, rows: Sequence[Sequence[str]], *, hint: str = "", scale: bool = False) -> None:
        """Replace all rows; without any, say what is to be done. ``scale``: v in divisions."""
        self.hint = "" if rows else hint
        if not rows:
            self.query_one("#ledger-head", Static).update("")
            self.query_one("#ledger-rows", Static).update("")
            self.show_hint()
            return
        head = texts.LEDGER_COLUMNS_DIV if scale else texts.LEDGER_COLUMNS
        table = [head, *rows]
        shown = [i for i in range(len(head)) if any(row[i] for row in rows)]
        widths = {i: max(columns(row[i]) for row in table if not _reason(row, i)) for i in shown}
        lines = [
            " ".join(padded(row[i], width, right=i in RIGHT) for i, width in widths.items())
            for row in table
        ]
        self.query_one("#ledger-head", Static).update(Text(lines[0], style="bold underline"))
        text = Text()
        for line, row in zip(lines[1:], rows, strict=True):
            text.append(f"{line}\n", style="strike" if row[STATE] == texts.LEDGER_STRUCK else "")
        text.rstrip()
        self.query_one("#ledger-rows", Static).update(text)
        self.to_end()


def _reason(row: Sequence[str], column: int) -> bool:
    """Whether a cell holds the reason of a strike, which may hang over."""
    return column == RESIDUAL and row[STATE] == texts.LEDGER_STRUCK
