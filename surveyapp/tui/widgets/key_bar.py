"""The last line of every screen: its keys; what finds no room is named by the palette and F1."""

from __future__ import annotations

from textual.app import ComposeResult
from textual.events import Resize
from textual.widgets import Footer
from textual.widgets._footer import FooterKey

from surveyapp.tui.cells import columns

LAST = ("escape", "f1", "f8", "q")
"""Keys that stay in the narrowest window: help, the way on, the way out."""


class KeyBar(Footer):
    """A footer of whole keys: help, the ways on and out in any case, others as there is room.

    Parameters
    ----------
    palette : bool
        Whether the key of the palette stands at the right.
    """

    def __init__(self, *, palette: bool = False) -> None:
        super().__init__(show_command_palette=palette, compact=True)
        self.room = 0

    def on_resize(self, event: Resize) -> None:
        """Another width has room for other keys."""
        if event.size.width != self.room:
            self.room = event.size.width
            self.call_after_refresh(self.recompose)

    def compose(self) -> ComposeResult:
        """The keys of the screen, as many as there is room for."""
        keys = list(super().compose())
        left = self.app.size.width - sum(_width(key) for key in keys if _stays(key))
        full = False
        for key in keys:
            if not _stays(key):
                left -= _width(key)
                full = full or left < 0  # no gap in the order of the keys
                if full:
                    continue
            yield key


def _stays(key: object) -> bool:
    """Whether a key is shown in any case."""
    if not isinstance(key, FooterKey):
        return False
    return key.key in LAST or key.has_class("-command-palette")


def _width(key: object) -> int:
    """Columns of a key with its name and the gap behind it."""
    if not isinstance(key, FooterKey):
        return 0
    gap = 2 if key.has_class("-command-palette") else 1
    return columns(key.key_display) + bool(key.description) + columns(key.description) + gap
