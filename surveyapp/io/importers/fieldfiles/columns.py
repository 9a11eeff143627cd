"""A table as text: separator, decimal sign, columns by name, cells with their unit.

Used for traverse readings and for azimuths of automatic gyros. The surveyor says which column is
what and in which unit; only separator and decimal sign are found by themselves, and both are told.
"""

from __future__ import annotations

import csv
import math
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from typing import Final

from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.io.importers.fieldfiles.lines import FieldText
from surveyapp.io.importers.fieldfiles.units import (
    ANGLES,
    LENGTHS,
    PRESSURES,
    TEMPERATURES,
    celsius,
)
from surveyapp_models.angles import AngleError, AngleUnit, parse_angle

_LEAST_ROWS: Final = 5
_LATEST_HEADER: Final = 50
_SAMPLE: Final = 2000
_SEPARATORS: Final = (",", ";", "\t", "|")
_NUMBER = re.compile(r"[+\-−]?(?:\d+(?:[.,]\d*)?|[.,]\d+)(?:[eE][+-]?\d{1,3})?")


class CellError(ValueError):
    """A cell that cannot be read: what is wrong with it."""


@dataclass(frozen=True, slots=True)
class Quantities:
    """What columns may hold, and which units each of them may have.

    Parameters
    ----------
    names : tuple of str
        In order, for messages.
    required : tuple of str
    angles, lengths : frozenset of str
        These must have a unit.
    """

    names: tuple[str, ...]
    required: tuple[str, ...]
    angles: frozenset[str]
    lengths: frozenset[str] = frozenset()


@dataclass(frozen=True, slots=True)
class Columns:
    """Columns that were found.

    Parameters
    ----------
    places : mapping
        Place of each quantity.
    units : mapping
    comma : bool
        Whether decimals are written with a comma.
    separator : str
    width : int
        Columns of the header.
    header_line : int
    """

    places: Mapping[str, int]
    units: Mapping[str, str]
    comma: bool
    separator: str
    width: int
    header_line: int

    def text(self, cells: Sequence[str], quantity: str) -> str:
        """A cell without blanks around it; empty where the quantity is not mapped."""
        place = self.places.get(quantity)
        return "" if place is None or place >= len(cells) else cells[place].strip()

    def number(self, cells: Sequence[str], quantity: str) -> float | None:
        """A plain number."""
        text = self.text(cells, quantity)
        if not text:
            return None
        if _NUMBER.fullmatch(text) is None or ("." if self.comma else ",") in text:
            raise CellError(f"{quantity} is no number: {text[:40]}")
        value = float(text.replace(",", ".").replace("−", "-"))
        if not math.isfinite(value):
            raise CellError(f"{quantity} is no number: {text[:40]}")
        return value

    def angle(self, cells: Sequence[str], quantity: str) -> float | None:
        """An angle [rad]."""
        unit = self.units[quantity]
        if unit != "dms":
            value = self.number(cells, quantity)
            return None if value is None else value * ANGLES[unit]
        text = self.text(cells, quantity)
        if not text:
            return None
        try:
            return parse_angle(text.replace(",", ".") if self.comma else text, AngleUnit.DMS)
        except AngleError as error:
            raise CellError(f"{quantity} is no angle: {text[:40]}, {error.expected}") from None

    def length(self, cells: Sequence[str], quantity: str) -> float | None:
        """A length [m]."""
        value = self.number(cells, quantity)
        return None if value is None else value * LENGTHS[self.units[quantity]]

    def temperature(self, cells: Sequence[str]) -> float | None:
        """A temperature [degrees Celsius]."""
        value = self.number(cells, "temperature")
        return None if value is None else celsius(value, self.units.get("temperature", "C"))

    def pressure(self, cells: Sequence[str]) -> float | None:
        """A pressure [hPa]."""
        value = self.number(cells, "pressure")
        return None if value is None else value * PRESSURES[self.units.get("pressure", "hPa")]

    @property
    def told(self) -> str:
        """Separator and decimal sign in words."""
        names = {",": "commas", ";": "semicolons", "\t": "tabs", "|": "bars"}
        sign = "comma" if self.comma else "point"
        return f"columns are separated by {names[self.separator]}, decimals by a {sign}"


def check_map(
    quantities: Quantities, columns: Mapping[str, str], units: Mapping[str, str]
) -> list[Problem]:
    """Everything that is wrong with ``--map`` and ``--unit``."""
    problems = []
    for option, given in (("--map", columns), ("--unit", units)):
        for name in given:
            if name not in quantities.names:
                hint = nearest_names(name, quantities.names)
                problems.append(Problem("there is no such quantity", option, name, "", hint))
    missing = [name for name in quantities.required if name not in columns]
    if missing:
        expected = " ".join(f"{name}=COLUMN" for name in missing)
        problems.append(Problem("columns are not mapped", "--map", ", ".join(missing), expected))
    for name in columns:
        allowed = _allowed(quantities, name)
        unit = units.get(name)
        if unit is None and name in quantities.angles | quantities.lengths:
            expected = f"--unit {name}= {' | '.join(allowed)}"
            problems.append(Problem("a unit is not told", "--unit", name, expected))
        elif unit is not None and unit not in allowed:
            expected = " | ".join(allowed) or "no unit"
            problems.append(Problem(f"{name} in an impossible unit", "--unit", unit, expected))
    return problems


def _allowed(quantities: Quantities, name: str) -> tuple[str, ...]:
    if name in quantities.angles:
        sigma = name == "sigma"
        return ("arcsec", "mgon", "gon", "deg") if sigma else ("gon", "deg", "dms", "mil", "rad")
    if name in quantities.lengths:
        return tuple(LENGTHS)
    if name == "time":
        return ("iso",)
    return {"temperature": TEMPERATURES, "pressure": tuple(PRESSURES)}.get(name, ())


def find_columns(
    text: FieldText,
    quantities: Quantities,
    told: tuple[Mapping[str, str], Mapping[str, str]],
) -> Columns:
    """Find the header that holds every mapped column.

    Parameters
    ----------
    text : FieldText
    quantities : Quantities
    told : tuple of mapping
        Columns and units by quantity.

    Raises
    ------
    SurveyError
        All problems of the map and the units; no such header.
    """
    columns, units = told
    problems = check_map(quantities, columns, units)
    if problems:
        raise SurveyError(problems)
    wanted, where = set(columns.values()), text.name
    lines = [line for _, line in islice(text.lines(), _LATEST_HEADER + _SAMPLE)]
    for number, line in enumerate(lines[:_LATEST_HEADER], start=1):
        for separator in _SEPARATORS:
            cells = _split(line, separator)
            if not wanted.issubset(cells):
                continue
            _refuse_twice(cells, wanted, f"{where}, line {number}")
            places = {name: cells.index(column) for name, column in columns.items()}
            sample = [_split(row, separator) for row in lines[number : number + _SAMPLE]]
            comma = separator != "," and _comma(sample, places, quantities)
            return Columns(places, dict(units), comma, separator, len(cells), number)
    raise SurveyError(_no_header(lines, where, wanted))


def _refuse_twice(cells: Sequence[str], wanted: set[str], where: str) -> None:
    twice = sorted(name for name in wanted if cells.count(name) > 1)
    if twice:
        raise SurveyError(Problem("a column stands twice", where, ", ".join(twice), "each once"))


def _no_header(lines: Sequence[str], where: str, wanted: set[str]) -> list[Problem]:
    first = next((line for line in lines if line.strip()), "")
    separator = max(_SEPARATORS, key=first.count)
    found = [cell for cell in _split(first, separator) if cell]
    return [
        Problem("there is no such column", where, name, "", nearest_names(name, found))
        for name in sorted(wanted - set(found))
    ] or [Problem("there is no header with all columns in one line", where, first[:60])]


def _split(line: str, separator: str) -> list[str]:
    try:
        return [c.strip() for c in next(csv.reader([line], delimiter=separator, strict=True), [])]
    except csv.Error:
        return []


def _comma(
    rows: Sequence[Sequence[str]], places: Mapping[str, int], quantities: Quantities
) -> bool:
    """Whether decimals are written with a comma: where any number has one and none a point."""
    numeric = [p for name, p in places.items() if name in quantities.angles | quantities.lengths]
    cells = [row[p] for row in rows for p in numeric if p < len(row)]
    numbers = [cell for cell in cells if _NUMBER.fullmatch(cell)]
    commas = sum("," in cell for cell in numbers)
    return commas > sum("." in cell for cell in numbers)


def cells_of(line: str, columns: Columns) -> list[str]:
    """Cells of a row.

    Raises
    ------
    CellError
        If it has not as many as the header.
    """
    try:
        cells = next(csv.reader([line], delimiter=columns.separator, strict=True), [])
    except csv.Error as error:
        raise CellError(f"the line is no row of a table ({error})") from None
    if len(cells) != columns.width:
        raise CellError(f"{len(cells)} cells instead of {columns.width}")
    return cells


def usual_decimals(text: FieldText, columns: Columns) -> int | None:
    """Decimals of the last column, if the table writes every column with a fixed number of them.

    A spreadsheet that drops idle zeros does so in every column; then nothing can be said.

    Parameters
    ----------
    text : FieldText
    columns : Columns

    Returns
    -------
    int or None
        A last cell with fewer was cut.
    """
    sign = "," if columns.comma else "."
    counts: dict[int, Counter[int]] = {}
    number = 0
    for line_number, line in text.lines():
        if line_number <= columns.header_line:
            continue
        row = _split(line, columns.separator)
        if len(row) != columns.width:
            continue
        number += 1
        if number == 1:
            numeric = [p for p in columns.places.values() if _NUMBER.fullmatch(row[p])]
            counts = {place: Counter() for place in {*numeric, columns.width - 1}}
        for place, count in counts.items():
            count[len(row[place].rpartition(sign)[2]) if sign in row[place] else 0] += 1
    if number < _LEAST_ROWS:
        return None
    last = counts.pop(columns.width - 1)
    usual, most = last.most_common(1)[0]
    if not counts or any(len(found) > 1 for found in counts.values()) or most < 0.8 * number:
        return None
    return usual or None


def cut_short(cells: Sequence[str], usual: int | None, columns: Columns) -> bool:
    """Whether the last cell has lost decimals that every row of the table has."""
    sign = "," if columns.comma else "."
    text = cells[-1].strip()
    if usual is None or not text:
        return False
    return (len(text.rpartition(sign)[2]) if sign in text else 0) < usual
