"""Tables on paper: column widths, wrapping cells, struck rows."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any, Final

from reportlab.lib.enums import TA_CENTER, TA_RIGHT
from reportlab.lib.pagesizes import A4
from reportlab.lib.styles import ParagraphStyle
from reportlab.lib.units import mm
from reportlab.platypus import Flowable
from reportlab.platypus import Paragraph as Text
from reportlab.platypus import Table as Grid

from surveyapp.report.blocks import Table
from surveyapp.report.pdf.fonts import BASE, Faces
from surveyapp.report.pdf.style import CELL, INK, QUIET, RULE, TINT, WIDTH, style_of


def column_widths(natural: Sequence[float], smallest: Sequence[float], room: float) -> list[float]:
    """Widths of columns: natural ones where they fit, else all give way in proportion.

    Parameters
    ----------
    natural, smallest : sequence of float
        Width without wrapping, and width of the longest word, below which no column goes while
        there is room.
    room : float
        What the page has.
    """
    if sum(natural) <= room:
        return list(natural)
    if sum(smallest) >= room:
        return [width * room / sum(smallest) for width in smallest]
    floors = [
        min(width, max(least, _COMFORT)) for width, least in zip(natural, smallest, strict=True)
    ]
    if sum(floors) >= room:
        floors = list(smallest)
    low, high = 0.0, 1.0
    for _ in range(50):  # the factor at which the scaled columns just fill the room
        middle = 0.5 * (low + high)
        total = sum(max(f, middle * w) for f, w in zip(floors, natural, strict=True))
        low, high = (middle, high) if total <= room else (low, middle)
    return [max(f, low * w) for f, w in zip(floors, natural, strict=True)]


_COMFORT: Final = 75.0
"""A column of text [points] is not made narrower than this while there is room."""
_PADDING: Final = 3.0
_ABOVE, _BELOW = 1.2, 1.8


def table_flowable(block: Table, faces: Faces) -> Flowable:
    """A table: columns as wide as their text, the widest wrapped where the page is too narrow."""
    size = CELL if len(block.head) < 9 else CELL - 0.7
    align = block.align or "l" * len(block.head)
    columns = list(zip(block.head, *block.rows, strict=True))
    natural = [max(faces.width(c, size) for c in column) + 2 * _PADDING + 1 for column in columns]
    smallest = [
        min(
            max((faces.width(w, size) for c in column for w in c.split()), default=4.0)
            + 2 * _PADDING
            + 1,
            0.5 * WIDTH,
        )
        for column in columns
    ]
    widths = column_widths(natural, smallest, WIDTH)
    if block.lined:
        widths = [width * WIDTH / sum(widths) for width in widths]
    cell = _cell_maker(faces, size, align, widths)
    headed = any(text.strip() for text in block.head)
    rows = [[cell(i, text, None) for i, text in enumerate(block.head)]] if headed else []
    for index, row in enumerate(block.rows):
        mark = "strike" if index in block.struck else None
        rows.append([cell(i, text, mark) for i, text in enumerate(row)])
    heights = row_heights(rows, 1.25 * size, _ABOVE + _BELOW)
    if block.row_height_mm is not None:
        heights = [*([None] if headed else []), *[block.row_height_mm * mm] * len(block.rows)]
    tall = is_tall(faces, block.rows, widths, size)
    grid = Grid(
        rows,
        colWidths=widths,
        rowHeights=heights,
        repeatRows=int(headed),
        hAlign="LEFT",
        splitInRow=int(tall),
    )
    grid.setStyle(_table_style(block, align, size, headed=headed))
    return grid


def is_tall(
    faces: Faces, rows: Iterable[Sequence[str]], widths: Sequence[float], size: float
) -> bool:
    """Whether a cell may become taller than a page: only then a row is divided between two."""
    room = 0.7 * A4[1] / (1.32 * size)
    return any(
        faces.width(text, size) / max(width - 2.0 * _PADDING, 1.0) > room
        for row in rows
        for text, width in zip(row, widths, strict=True)
        if len(text) > _LONG_CELL
    )


_LONG_CELL: Final = 200


def _cell_maker(
    faces: Faces, size: float, align: str, widths: Sequence[float]
) -> Callable[[int, str, str | None], object]:
    """Cells of a table, from their column, text and mark."""
    alignment = {"l": 0, "c": TA_CENTER, "r": TA_RIGHT}
    styles = {letter: style_of(size, alignment=value) for letter, value in alignment.items()}
    quiet = {
        letter: style_of(size, alignment=value, textColor=QUIET)
        for letter, value in alignment.items()
    }

    def cell(column: int, text: str, mark: str | None) -> object:
        if mark is not None:
            inner = faces.markup(text)
            return Text(f"<strike>{inner}</strike>" if inner else "", quiet[align[column]])
        return plain_or_wrapped(faces, text, widths[column] - 2 * _PADDING, styles[align[column]])

    return cell


def plain_or_wrapped(faces: Faces, text: str, room: float, style: ParagraphStyle) -> str | Flowable:
    """Plain text where it fits and the base face draws it, else a wrapping paragraph."""
    fits = faces.width(text, style.fontSize) <= room
    return text if fits and faces.is_base(text) else Text(faces.markup(text), style)


def row_heights(
    rows: Sequence[Sequence[object]], leading: float, padding: float
) -> list[float | None]:
    """Heights of rows of plain text in one line [points], None where a cell has to be wrapped."""
    plain = [all(isinstance(cell, str) for cell in row) for row in rows]
    return [leading + padding if one_line else None for one_line in plain]


def _table_style(block: Table, align: str, size: float, *, headed: bool) -> list[Any]:
    names = {"l": "LEFT", "c": "CENTER", "r": "RIGHT"}
    style: list[Any] = [
        ("FONT", (0, 0), (-1, -1), BASE, size),
        ("TEXTCOLOR", (0, 0), (-1, -1), INK),
        ("LEADING", (0, 0), (-1, -1), 1.25 * size),
        ("VALIGN", (0, 0), (-1, -1), "TOP"),
        ("LEFTPADDING", (0, 0), (-1, -1), _PADDING),
        ("RIGHTPADDING", (0, 0), (-1, -1), _PADDING),
        ("TOPPADDING", (0, 0), (-1, -1), _ABOVE),
        ("BOTTOMPADDING", (0, 0), (-1, -1), _BELOW),
        ("LINEBELOW", (0, -1), (-1, -1), 0.4, RULE),
    ]
    if headed:
        style.append(("BACKGROUND", (0, 0), (-1, 0), TINT))
        style.append(("LINEBELOW", (0, 0), (-1, 0), 0.6, INK))
    style += [("ALIGN", (i, 0), (i, -1), names[letter]) for i, letter in enumerate(align)]
    for index in sorted(block.strong):
        style.append(("BACKGROUND", (0, index + 1), (-1, index + 1), TINT))
        style.append(("LINEABOVE", (0, index + 1), (-1, index + 1), 0.6, INK))
    if block.lined:
        style.append(("GRID", (0, 0), (-1, -1), 0.4, RULE))
    return style
