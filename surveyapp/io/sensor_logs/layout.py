"""How a log is laid out: lines before the names, separator, names of the columns, first row.

Makers put titles and settings before the table (``Fs,100``); the table begins with the first line
whose cells are numbers and whose neighbours have as many cells.
"""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from surveyapp.domain.sensor_log import TEXT_COLUMNS
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.files import shown

SEPARATORS: Final = (",", ";", "\t")
LOOKED_AT: Final = 200
"""Lines at the head of a file among which the table must begin."""


@dataclass(frozen=True, slots=True)
class Layout:
    """Where the table of a file begins.

    Parameters
    ----------
    separator : str
    names : tuple of str
        Of the columns; numbers from 1 where the file has none.
    first_row : int
        Line number (from 1) of the first row of data; 0 = there is none.
    """

    separator: str
    names: tuple[str, ...]
    first_row: int


def find_layout(lines: Sequence[str], *, header_rows: int | None, where: str) -> Layout:
    """Find the table among the first lines of a file.

    Parameters
    ----------
    lines : sequence of str
        The first lines without their ends.
    header_rows : int or None
        Lines before the line of names, where it is known.
    where : str
        For messages.

    Raises
    ------
    SurveyError
        If there is no table.
    """
    if not any(line.strip() for line in lines):
        raise SurveyError(Problem("the log is empty", where, "no line", "a line of names and rows"))
    if header_rows is not None:
        if header_rows >= len(lines):
            found, expected = str(header_rows), "less than the lines of the file"
            raise SurveyError(Problem("header_rows is too large", where, found, expected))
        return _named(lines, header_rows)
    for index in range(len(lines) - 1):
        separator = _separator(lines[index])
        cells, below = _cells(lines[index], separator), _cells(lines[index + 1], separator)
        canonical_texts = any(name in TEXT_COLUMNS for name in cells)
        if len(cells) != len(below) or not (_numeric(below) or canonical_texts):
            continue
        if _numeric(cells) and not _empty(cells):
            if index > 0 or (len(cells) == 1 and not _all_single(lines)):
                continue
            return _unnamed(lines, index, separator)
        if len(cells) > 1 and _fits_rest(lines[index + 1 :], separator, len(cells)):
            return _named(lines, index)
    return _fallback(lines, where)


def _all_single(lines: Sequence[str]) -> bool:
    """Whether every line is one number: a column without a name, and no setting above a table."""
    return all(_numeric([line]) for line in lines)


def _fallback(lines: Sequence[str], where: str) -> Layout:
    """The first line that is not blank names the columns."""
    first = next(i for i, line in enumerate(lines) if line.strip())
    layout = _named(lines, first)
    if layout.first_row == 0:
        found = shown(lines[first])
        raise SurveyError(Problem("the log has no row", where, found, "rows below the names"))
    return layout


def _fits_rest(lines: Sequence[str], separator: str, width: int) -> bool:
    """Whether the lines that follow have as many cells, so that this is the table itself."""
    following = [line for line in lines[:20] if line.strip()]
    same = sum(len(_cells(line, separator)) == width for line in following)
    return 2 * same > len(following)


def _named(lines: Sequence[str], index: int) -> Layout:
    separator = _separator(lines[index])
    names = tuple(cell.strip() for cell in _cells(lines[index], separator))
    rest = [i for i in range(index + 1, len(lines)) if lines[i].strip()]
    return Layout(separator, names, rest[0] + 1 if rest else 0)


def _unnamed(lines: Sequence[str], index: int, separator: str) -> Layout:
    width = len(_cells(lines[index], separator))
    return Layout(separator, tuple(str(i + 1) for i in range(width)), index + 1)


def _separator(line: str) -> str:
    return max(SEPARATORS, key=line.count)


def _cells(line: str, separator: str) -> list[str]:
    try:
        return next(csv.reader([line], delimiter=separator), [])
    except csv.Error:  # no row of a table
        return [line]


def _empty(cells: Sequence[str]) -> bool:
    return not any(cell.strip() for cell in cells)


def _numeric(cells: Sequence[str]) -> bool:
    """Whether every cell is a number or empty."""
    for cell in cells:
        try:
            float(cell.strip() or "0")
        except ValueError:
            return False
    return bool(cells)
