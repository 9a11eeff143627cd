"""Blocks as text for a terminal: the same record without paper."""

from __future__ import annotations

import math
import re
import textwrap
import unicodedata
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import pairwise
from typing import Final

from surveyapp.report.blocks import (
    Block,
    Document,
    Figure,
    ForWidth,
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
_LEAST_TEXT: Final = 14
"""Columns below which a last text stands below its row."""
_BELOW: Final = 4
"""Columns by which it is set in."""
_GAP: Final = 2
_MM_PER_COLUMN: Final = 2.0
_MM_PER_ROW: Final = 4.0
_CLOSING: Final = "。，、；：？！）》」』】”’"
_PIECES: Final = re.compile(
    rf"[\u2e80-\u9fff\uf900-\ufaff\uff00-\uffef\u3000-\u303f][{_CLOSING}]*\s*"
    rf"|[^\s\u2e80-\u9fff\uf900-\ufaff\uff00-\uffef]+[{_CLOSING}]*\s*|\s+"
)
"""What a line does not break: a wide character or a word, with the marks behind it."""
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
    text, last = "", None
    for block in in_words(tuple(blocks)):
        part = block_text(block, width)
        if not part:
            continue
        # remarks of one kind stand close together
        close = isinstance(block, Paragraph) and block.tone == last != "body"
        text += (("\n" if close else "\n\n") if text else "") + part
        last = block.tone if isinstance(block, Paragraph) else None
    return text


def block_text(block: Block, width: int = WIDTH) -> str:
    """One block as text."""
    match block:
        case Heading():
            rule = "-" if block.level == 1 else "."
            return f"{block.text}\n{rule * display_width(block.text)}"
        case Paragraph():
            mark = "! " if block.tone == "warning" else ""
            set_in = "" if block.tone == "body" else "  "
            return filled(mark + block.text, width, set_in=set_in)
        case KeyValues():
            return _facts(block, width)
        case Table():
            return table_text(block, width)
        case Figure():
            return _figure(block)
        case Signature():
            return "\n\n".join(f"  {role}: ______________________" for role in block.roles)
        case ForWidth():
            return blocks_text(block.narrow, width)
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
    return "\n".join(line for _, line in table_lines(table, width, indent=indent))


def table_lines(
    table: Table, width: int = WIDTH, *, indent: int = 2
) -> Iterator[tuple[int | None, str]]:
    """The lines of a table, each with the number of its row; None for the head.

    Texts of a last column that would be squeezed together stand below their rows instead.
    """
    align = table.align or "l" * len(table.head)
    rows = [
        tuple(f"~{cell}~" if cell else "" for cell in row) if index in table.struck else row
        for index, row in enumerate(table.rows)
    ]
    headed = any(table.head)
    everything = (table.head, *rows) if headed else tuple(rows)
    below = _finds_no_room(everything, align, width - indent)
    shown = [row[:-1] for row in everything] if below else list(everything)
    widths, gap = _layout(shown, align[: len(align) - below], width - indent)
    for place, row in enumerate(shown):
        number = place - headed if place >= headed else None
        cells = [_wrapped(c, w) for c, w in zip(row, widths, strict=True)]
        for i in range(max((len(cell) for cell in cells), default=0)):
            parts = [
                _padded(cell[i] if i < len(cell) else "", w, a)
                for cell, w, a in zip(cells, widths, align, strict=False)
            ]
            yield number, (" " * indent + (" " * gap).join(parts)).rstrip()
        if below and number is not None and everything[place][-1]:
            for line in _wrapped(everything[place][-1], width - indent - _BELOW):
                yield number, " " * (indent + _BELOW) + line


def _finds_no_room(rows: Sequence[Sequence[str]], align: str, room: int) -> bool:
    """Whether the texts of the last column would have less than their least width."""
    if len(align) < 2 or not align.endswith("l") or not rows:
        return False
    floors = [w if a == "r" else min(w, f) for w, f, a in _columns(rows, align)]
    widest = max(display_width(row[-1]) for row in rows)
    floors[-1] = min(widest, max(floors[-1], _LEAST_TEXT))
    return sum(floors) + _GAP * (len(align) - 1) > room


def _columns(rows: Sequence[Sequence[str]], align: str) -> list[tuple[int, int, str]]:
    """Width of each column, the least that leaves its words whole, and its alignment."""
    widths = [max(display_width(row[i]) for row in rows) for i in range(len(align))]
    words = [max(_longest_word(row[i]) for row in rows) for i in range(len(align))]
    return [(w, max(_NARROWEST, f), a) for w, f, a in zip(widths, words, align, strict=True)]


def _layout(rows: Sequence[Sequence[str]], align: str, room: int) -> tuple[list[int], int]:
    """Columns of each cell and between cells.

    What does not fit is squeezed step by step: texts to their words, heads of numbers to their
    words, the gaps, texts to their parts before and after hyphens. Numbers stay whole.
    """
    if not rows:
        return [0] * len(align), _GAP
    columns = _columns(rows, align)
    widths = [width for width, _, _ in columns]
    numbers = [
        max((display_width(row[i]) for row in rows[1:]), default=0) for i in range(len(align))
    ]
    heads = [
        max(number, _longest_word(cell)) for number, cell in zip(numbers, rows[0], strict=True)
    ]
    halves = [
        max(_longest_word(row[i].replace("-", "- ")) for row in rows) for i in range(len(align))
    ]
    texts = [width if a == "r" else floor for width, floor, a in columns]
    whole = [
        head if a == "r" else floor for head, (_, floor, a) in zip(heads, columns, strict=True)
    ]
    parts = [
        head if a == "r" else max(_NARROWEST, half)
        for head, half, a in zip(heads, halves, align, strict=True)
    ]
    least = [head if a == "r" else _NARROWEST for head, a in zip(heads, align, strict=True)]
    for floors, gap in ((texts, _GAP), (whole, _GAP), (whole, 1), (parts, 1), (least, 1)):
        _squeeze(widths, floors, room - gap * (len(align) - 1))
        if sum(widths) + gap * (len(align) - 1) <= room:
            return widths, gap
    return widths, 1


def _longest_word(cell: str) -> int:
    words = cell.split() if display_width(cell) == len(cell) else _PIECES.findall(cell)
    return max((display_width(word.rstrip()) for word in words), default=0)


def _squeeze(widths: list[int], floors: Sequence[int], available: int) -> None:
    """Take columns from the widest cells until the row fits, or none has any left."""
    while sum(widths) > available:
        free = [i for i, width in enumerate(widths) if width > floors[i]]
        if not free:
            return
        widths[max(free, key=lambda i: widths[i])] -= 1


def _wrapped(cell: str, width: int) -> list[str]:
    if display_width(cell) <= width:
        return [cell]
    if display_width(cell) > len(cell):
        return _wrapped_wide(cell, width)
    whole = _longest_word(cell) <= width
    return textwrap.wrap(cell, width, break_on_hyphens=not whole) or [""]


def filled(text: str, width: int, *, set_in: str = "") -> str:
    """A text in lines of a width [columns], all but the first set in."""
    if display_width(text) == len(text):
        return textwrap.fill(text, width, subsequent_indent=set_in, break_on_hyphens=False)
    return f"\n{set_in}".join(_wrapped_wide(text, width - len(set_in)))


def _wrapped_wide(text: str, width: int) -> list[str]:
    """Lines of a text with wide characters, between any two of which a line may end.

    What may not begin a line (closing marks) hangs over with the character before it.
    """
    lines, line, room = [], "", width
    for piece in _PIECES.findall(text):
        size = display_width(piece.rstrip())
        if line and size > room:
            lines.append(line.rstrip())
            line, room = "", width
        line += piece
        room -= display_width(piece)
    return [*lines, line.rstrip()] if line else lines or [""]


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
            shift = {"start": 0.0, "middle": 0.5, "end": 1.0}[item.anchor]
            first = item.at[0] / _MM_PER_COLUMN - shift * display_width(item.text)
            column = math.floor(first + 0.5)
            for character in item.text:
                for ink in (character, "")[: display_width(character)]:  # a wide one fills two
                    put(column * _MM_PER_COLUMN, item.at[1], ink)
                    column += 1
    return "\n".join([figure.title, *("".join(row).rstrip() for row in canvas)])


def _draw(
    put: Callable[[float, float, str], None], points: tuple[tuple[float, float], ...], ink: str
) -> None:
    for (x1, y1), (x2, y2) in pairwise(points):
        steps = int(max(abs(x2 - x1) / _MM_PER_COLUMN, abs(y2 - y1) / _MM_PER_ROW)) + 1
        for k in range(steps + 1):
            put(x1 + (x2 - x1) * k / steps, y1 + (y2 - y1) * k / steps, ink)
