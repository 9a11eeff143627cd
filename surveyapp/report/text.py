"""Blocks as text for a terminal: the same record without paper."""

from __future__ import annotations

import textwrap
import unicodedata
from collections.abc import Callable, Iterable
from itertools import pairwise
from typing import Final

from surveyapp.report.blocks import (
    Block,
    Document,
    Figure,
    Heading,
    KeyValues,
    Label,
    Line,
    Marker,
    PageBreak,
    Paragraph,
    Polyline,
    Signature,
    Table,
)
from surveyapp.report.in_words import in_words

WIDTH: Final = 100
_NARROWEST: Final = 8
"""Columns below which no text is squeezed."""
_GAP: Final = 2
_MM_PER_COLUMN: Final = 2.0
_MM_PER_ROW: Final = 4.0
_INK: Final = {"axis": ".", "grid": " ", "data": "-", "mean": "=", "limit": "~", "bar": "|"}
_MARK: Final = {"circle": "o", "dot": "*", "cross": "x", "square": "#"}


def document_text(document: Document) -> str:
    """The whole document as text."""
    document = in_words(document)
    parts = [document.title, "=" * display_width(document.title), *document.foot]
    return "\n".join(parts) + "\n\n" + blocks_text(document.blocks) + "\n"


def blocks_text(blocks: Iterable[Block], width: int = WIDTH) -> str:
    """Blocks as text, an empty line between them.

    Parameters
    ----------
    blocks : iterable of Block
    width : int
        Columns of the terminal: texts are wrapped, and texts of tables where they must be.
    """
    told = in_words(tuple(blocks))
    return "\n\n".join(part for block in told if (part := block_text(block, width)))


def block_text(block: Block, width: int = WIDTH) -> str:
    """One block as text."""
    match block:
        case Heading():
            rule = "-" if block.level == 1 else "."
            return f"{block.text}\n{rule * display_width(block.text)}"
        case Paragraph():
            mark = "! " if block.tone == "warning" else ""
            return textwrap.fill(mark + block.text, width, break_on_hyphens=False)
        case KeyValues():
            return _facts(block, width)
        case Table():
            return table_text(block, width)
        case Figure():
            return _figure(block)
        case Signature():
            return "\n\n".join(f"  {role}: ______________________" for role in block.roles)
        case PageBreak():
            return ""


def display_width(text: str) -> int:
    """Columns that a text takes in a terminal: East Asian wide characters take two."""
    return sum(2 if unicodedata.east_asian_width(c) in "WF" else 1 for c in text)


def _padded(text: str, width: int, align: str = "l") -> str:
    gap = " " * max(0, width - display_width(text))
    return gap + text if align == "r" else text + gap


def _facts(block: KeyValues, width: int) -> str:
    first = max((display_width(key) for key, _ in block.pairs), default=0)
    lines = []
    for key, value in block.pairs:
        wrapped = _wrapped(value, max(width - first - 4, _NARROWEST))
        lines.append(f"  {_padded(key, first)}  {wrapped[0]}")
        lines += [f"  {'':{first}}  {more}" for more in wrapped[1:]]
    return "\n".join(line.rstrip() for line in lines)


def table_text(table: Table, width: int = WIDTH, *, indent: int = 2) -> str:
    """A table: columns as wide as needed, the widest texts wrapped where the terminal ends."""
    align = table.align or "l" * len(table.head)
    rows = [
        tuple(f"~{cell}~" if cell else "" for cell in row) if index in table.struck else row
        for index, row in enumerate(table.rows)
    ]
    everything = (table.head, *rows) if any(table.head) else tuple(rows)
    widths = [max(display_width(row[i]) for row in everything) for i in range(len(align))]
    room = width - indent - _GAP * (len(align) - 1)
    words = [max(_longest_word(row[i]) for row in everything) for i in range(len(align))]
    _squeeze(widths, align, [max(_NARROWEST, word) for word in words], room)
    narrow = list(widths)
    _squeeze(narrow, align, [_NARROWEST] * len(align), room)
    if sum(narrow) <= room:  # words are broken only where that helps
        widths = narrow
    lines = []
    for row in everything:
        cells = [_wrapped(c, w) for c, w in zip(row, widths, strict=True)]
        for i in range(max((len(cell) for cell in cells), default=0)):
            shown = [
                _padded(cell[i] if i < len(cell) else "", w, a)
                for cell, w, a in zip(cells, widths, align, strict=True)
            ]
            lines.append((" " * indent + (" " * _GAP).join(shown)).rstrip())
    return "\n".join(lines)


def _longest_word(cell: str) -> int:
    return max((display_width(word) for word in cell.split()), default=0)


def _squeeze(widths: list[int], align: str, floors: list[int], available: int) -> None:
    """Take columns from the widest texts until the table fits, or no text has any left."""
    while sum(widths) > available:
        texts = [i for i, letter in enumerate(align) if letter != "r" and widths[i] > floors[i]]
        if not texts:
            return
        widths[max(texts, key=lambda i: widths[i])] -= 1


def _wrapped(cell: str, width: int) -> list[str]:
    if display_width(cell) <= width:
        return [cell]
    return textwrap.wrap(cell, width) or [""]


def _figure(figure: Figure) -> str:
    columns = max(1, round(figure.width_mm / _MM_PER_COLUMN)) + 1
    rows = max(1, round(figure.height_mm / _MM_PER_ROW)) + 1
    canvas = [[" "] * columns for _ in range(rows)]

    def put(x: float, y: float, ink: str) -> None:
        column, row = round(x / _MM_PER_COLUMN), rows - 1 - round(y / _MM_PER_ROW)
        if ink != " " and 0 <= row < rows and 0 <= column < columns:
            canvas[row][column] = ink

    for item in figure.primitives:
        match item:
            case Line():
                _draw(put, (item.start, item.end), _INK[item.stroke])
            case Polyline():
                _draw(put, item.points, _INK[item.stroke])
            case _:
                continue
    for item in figure.primitives:
        if isinstance(item, Marker):
            put(*item.at, _MARK[item.shape])
        elif isinstance(item, Label) and not item.upright:
            shift = {"start": 0.0, "middle": 0.5, "end": 1.0}[item.anchor] * len(item.text)
            for index, character in enumerate(item.text):
                put(item.at[0] + (index - shift) * _MM_PER_COLUMN, item.at[1], character)
    return "\n".join([figure.title, *("".join(row).rstrip() for row in canvas)])


def _draw(
    put: Callable[[float, float, str], None], points: tuple[tuple[float, float], ...], ink: str
) -> None:
    for (x1, y1), (x2, y2) in pairwise(points):
        steps = int(max(abs(x2 - x1) / _MM_PER_COLUMN, abs(y2 - y1) / _MM_PER_ROW)) + 1
        for k in range(steps + 1):
            put(x1 + (x2 - x1) * k / steps, y1 + (y2 - y1) * k / steps, ink)
