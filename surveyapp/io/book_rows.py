"""Rows of the books that hold one observation a row: traverses and shafts.

What is common to them: how a file becomes rows of named cells, and how a cell becomes a number
or an angle. What a row means is in ``io.traverse.rows`` and ``io.shafts.book``.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator, Sequence
from typing import Final, TypeVar

from surveyapp.errors import Problem, nearest_names
from surveyapp.io.files import MAX_COLUMNS, shown, too_many_columns, too_many_lines, visible
from surveyapp.io.measures import MEASURES, is_measure
from surveyapp.languages import said
from surveyapp_models.angles import AngleError, AngleUnit, parse_angle

ANGLE_UNITS: Final = {"dms": AngleUnit.DMS, "gon": AngleUnit.GON, "deg": AngleUnit.DEG}
"""Units of an angle by the word in the column ``unit``."""
MGON: Final = math.pi / 200_000.0
"""One milligon in radians."""


class BookRow:
    """Cells of one row, and where its problems go."""

    __slots__ = ("cells", "line", "problems", "where")

    def __init__(
        self, cells: dict[str, str], where: str, line: int, problems: list[Problem]
    ) -> None:
        self.cells, self.where, self.line, self.problems = cells, where, line, problems

    def problem(self, what: str, found: str, expected: str, hint: str = "") -> None:
        """Tell what is wrong with this row."""
        place = said("{where}, line {line}", where=self.where, line=self.line)
        self.problems.append(Problem(what, place, shown(found), expected, hint))

    def number(self, key: str) -> float | None:
        """Number in a cell; None for an empty cell, and where a problem was told."""
        text = self.cells[key]
        if not text:
            return None
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if is_measure(value):
            return value
        if math.isfinite(value):
            self.problem(said("{key} is beyond all measures", key=key), text, MEASURES)
            return None
        hint = "decimals are written with a point" if "," in text else ""
        self.problem(said("{key} is no number", key=key), text, "a number", hint)
        return None

    def angle(self, kind: str, default: AngleUnit) -> float | None:
        """Angle in the cells ``value`` and ``unit`` [rad], None where a problem was told."""
        text, unit = self.cells["value"], self.cells["unit"]
        if unit and unit not in ANGLE_UNITS:
            hint = nearest_names(unit, ANGLE_UNITS)
            self.problem(said("{kind} in a wrong unit", kind=kind), unit, "dms, gon or deg", hint)
            return None
        try:
            return parse_angle(text, ANGLE_UNITS[unit] if unit else default)
        except AngleError as error:
            self.problem(said("{kind} is no angle", kind=kind), text, error.expected, error.hint)
            return None


Row = TypeVar("Row", bound=BookRow)


def rows_of(
    kind: type[Row],
    text: str,
    *,
    columns: Sequence[str],
    required: Sequence[str],
    where: str,
    problems: list[Problem],
) -> Iterator[Row]:
    """Rows of a book, with every column of ``columns`` among their cells.

    Parameters
    ----------
    kind : type
        The row that each becomes.
    text : str
    columns : sequence of str
        All that a book may have; those that it lacks are empty cells.
    required : sequence of str
        Those that its header must name.
    where : str
        What messages call the book.
    problems : list of Problem
        Where everything that is wrong is told.
    """
    too_many = too_many_lines(text, where)
    if too_many is not None:
        problems.append(too_many)
        return
    header: list[str] | None = None
    reader = csv.reader(visible(text).splitlines(), strict=True)
    try:
        for cells in reader:
            stripped = [cell.strip() for cell in cells]
            if not any(stripped) or stripped[0].startswith("#"):
                continue
            place = said("{where}, line {line_num}", where=where, line_num=reader.line_num)
            if header is None:
                header = [name.lower() for name in stripped]
                wrong = _header_problems(header, ",".join(cells), place, (columns, required))
                problems.extend(wrong)
                if wrong:
                    return
                continue
            if len(stripped) > len(header):
                hint = "decimals are written with a point"
                found = shown(",".join(cells))
                problems.append(Problem("more values than columns", place, found, "", hint))
                continue
            named = dict.fromkeys(columns, "")
            named.update(zip(header, stripped, strict=False))
            yield kind(named, where, reader.line_num, problems)
    except csv.Error as error:
        place = said("{where}, line {line_num}", where=where, line_num=reader.line_num)
        problems.append(Problem(said("no CSV ({error})", error=error), place))
    if header is None:
        problems.append(Problem("the book is empty", where, "", ",".join(columns)))


def _header_problems(
    header: list[str], line: str, place: str, known: tuple[Sequence[str], Sequence[str]]
) -> list[Problem]:
    columns, required = known
    if len(header) > MAX_COLUMNS:
        return [too_many_columns(len(header), place)]
    if ";" in line and "," not in line:
        what = "the columns are separated by semicolons"
        return [Problem(what, place, shown(line), "commas")]
    problems = []
    missing = [name for name in required if name not in header]
    if missing:
        what = said("there is no column {names}", names=", ".join(missing))
        problems.append(Problem(what, place, shown(line), ",".join(columns)))
    doubled = sorted({name for name in header if name and header.count(name) > 1})
    problems += [
        Problem(said("there are two columns {name}", name=shown(name)), place, shown(line))
        for name in doubled
    ]
    return problems
