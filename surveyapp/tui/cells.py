"""Columns of a terminal: Chinese letters take two, so a text is padded and cut by its cells."""

from __future__ import annotations

from rich.cells import cell_len, set_cell_size

from surveyapp.report.text import filled


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


def lines_of(text: str, width: int, most: int = 2) -> list[str]:
    """A text in lines of a width [columns], no more than some: the last one is cut then."""
    lines = filled(text, max(width, 1)).split("\n")
    return (
        lines
        if len(lines) <= most
        else [*lines[: most - 1], cut(" ".join(lines[most - 1 :]), width)]
    )
