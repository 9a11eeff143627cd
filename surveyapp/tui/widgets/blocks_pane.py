"""Blocks of the record below each other, as wide as the screen."""

from __future__ import annotations

from rich.text import Text
from textual.app import ComposeResult
from textual.containers import VerticalScroll
from textual.widgets import Static

from surveyapp.report.blocks import Block
from surveyapp.tui.views.blocks import blocks_as_text


class BlocksPane(VerticalScroll):
    """Shows blocks; a sentence where there are none.

    Parameters
    ----------
    empty : str
    can_focus : bool
        Whether the keys that move a text may come here.
    """

    def __init__(self, *, empty: str = "", can_focus: bool = True) -> None:
        super().__init__(can_focus=can_focus)
        self.empty = empty
        self.blocks: tuple[Block, ...] | None = None

    def compose(self) -> ComposeResult:
        """The text."""
        yield Static(markup=False)

    def show(self, blocks: tuple[Block, ...]) -> None:
        """Show other blocks."""
        self.blocks = blocks
        self._tell()

    def on_resize(self) -> None:
        """Another width breaks the lines anew."""
        self._tell()

    def _tell(self) -> None:
        if self.blocks is None:
            return
        width = self.scrollable_content_region.width
        text = blocks_as_text(self.blocks, width) if self.blocks else Text(self.empty)
        self.query_one(Static).update(text)
