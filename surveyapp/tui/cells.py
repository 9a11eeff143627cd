"""Columns of a terminal: Chinese letters take two, so a text is padded and cut by its cells."""

from __future__ import annotations

from rich.cells import cell_len, set_cell_size


def columns(text: str) -> int:
    """Columns that a text takes."""
    return cell_len(text)


def padded(text: str, width: int, *, right: bool = False) -> str:
    """A text with blanks up to a width [columns]; a wider one is left as it is."""
    gap = " " * max(0, width - cell_len(text))
    return gap + text if right else text + gap


def cut(text: str, width: int) -> str:
    """As much of a text as a width [columns] holds."""
    return text if cell_len(text) <= width else set_cell_size(text, max(width, 0))
