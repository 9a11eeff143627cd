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
from surveyapp.languages import said
from surveyapp_models.angles import AngleError, AngleUnit, parse_angle

_LEAST_ROWS: Final = 5
_USUAL: Final = 0.9
_LEAST_CELLS: Final = 40
"""Of so many numbers without idle zeros (one in ten ends in one) at least two are shorter: 92 %."""
_MOST_OTHERS: Final = 0.03
_LATEST_HEADER: Final = 50
_SAMPLE: Final = 2000
_SEPARATORS: Final = (",", ";", "\t", "|")
_NUMBER = re.compile(r"[+\-−]?(?:\d+(?:[.,]\d*)?|[.,]\d+)(?:[eE][+-]?\d{1,3})?")
_SIXTY = re.compile(r"(.*[-: '′])60(?:\.0*)?([\"″]?)")


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
            raise CellError(
                said("{quantity} is no number: {text}", quantity=quantity, text=text[:40])
            )
        value = float(text.replace(",", ".").replace("−", "-"))
        if not math.isfinite(value):
            raise CellError(
                said("{quantity} is no number: {text}", quantity=quantity, text=text[:40])
            )
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
            plain = text.replace(",", ".") if self.comma else text
            sixty = _SIXTY.fullmatch(plain)  # others round 59.96 so: carried over
            if sixty is not None:
                return parse_angle(f"{sixty[1]}0{sixty[2]}", AngleUnit.DMS) + ANGLES["deg"] / 60.0
            return parse_angle(plain, AngleUnit.DMS)
        except AngleError as error:
            raise CellError(
                said(
                    "{quantity} is no angle: {text}, {expected}",
                    quantity=quantity,
                    text=text[:40],
                    expected=error.expected,
                )
            ) from None

    def carries(self, cells: Sequence[str], quantity: str) -> bool:
        """Whether an angle has 60 seconds."""
        sixty = self.units.get(quantity) == "dms"
        return sixty and _SIXTY.fullmatch(self.text(cells, quantity).replace(",", ".")) is not None

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

    def is_number(self, place: int, text: str) -> bool:
        """Whether a cell holds a number, or an angle in degrees, minutes and seconds."""
        if _NUMBER.fullmatch(text) is not None:
            return True
        sixties = {self.places[name] for name, unit in self.units.items() if unit == "dms"}
        return place in sixties and text[:1].isdigit()

    @property
    def told(self) -> str:
        """Separator and decimal sign in words."""
        names = {",": "commas", ";": "semicolons", "\t": "tabs", "|": "bars"}
        sign = "comma" if self.comma else "point"
        return f"columns are separated by {names[self.separator]}, decimals by a {sign}"


def check_map(
    quantities: Quantities, columns: Mapping[str, str], units: Mapping[str, str]
) -> list[Problem]:
    """Everything that is wrong with columns and units."""
    problems = []
    for option, given in (("columns", columns), ("units", units)):
        for name in given:
            if name not in quantities.names:
                hint = nearest_names(name, quantities.names)
                problems.append(Problem("there is no such quantity", option, name, "", hint))
    missing = [name for name in quantities.required if name not in columns]
    if missing:
        expected = " ".join(f"{name}=COLUMN" for name in missing)
        problems.append(Problem("columns are not mapped", "columns", ", ".join(missing), expected))
    for name in columns:
        allowed = _allowed(quantities, name)
        unit = units.get(name)
        if unit is None and name in quantities.angles | quantities.lengths:
            expected = said("`units` {name}= {names}", name=name, names=" | ".join(allowed))
            problems.append(Problem("a unit is not told", "units", name, expected))
        elif unit is not None and unit not in allowed:
            expected = " | ".join(allowed) or "no unit"
            problems.append(
                Problem(said("{name} in an impossible unit", name=name), "units", unit, expected)
            )
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
            _refuse_twice(cells, wanted, said("{where}, line {number}", where=where, number=number))
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
        raise CellError(said("the line is no row of a table ({error})", error=error)) from None
    if len(cells) != columns.width:
        raise CellError(
            said("{size} cells instead of {width}", size=len(cells), width=columns.width)
        )
    return cells


@dataclass(frozen=True, slots=True)
class Style:
    """How a table writes its cells.

    Parameters
    ----------
    decimals : mapping
        Decimals by the place of a column, where the table keeps idle zeros.
    filled : frozenset of int
        Columns of heights that nearly all rows fill.
    """

    decimals: Mapping[int, int]
    filled: frozenset[int]


def style_of(table: FieldText, columns: Columns) -> Style:
    """How a table writes its cells.

    A spreadsheet that drops idle zeros does so with every tenth number; then nothing can be said
    of decimals. A number that is written again (a height) tells nothing more.

    Parameters
    ----------
    table : FieldText
    columns : Columns
    """
    counts: dict[int, Counter[int]] = {place: Counter() for place in columns.places.values()}
    heights = [place for name, place in columns.places.items() if name in ("hi", "ht")]
    given: Counter[int] = Counter()
    told: dict[int, set[str]] = {place: set() for place in counts}
    rows = 0
    for line_number, line in table.lines():
        if line_number <= columns.header_line:
            continue
        row = _split(line, columns.separator)
        if len(row) != columns.width:
            continue
        rows += 1
        given.update(place for place in heights if row[place])
        for place, count in counts.items():
            text = row[place]
            if text not in told[place] and columns.is_number(place, text):
                count[decimals_of(text, comma=columns.comma)] += 1
                if len(told[place]) < _SAMPLE:
                    told[place].add(text)
    filled = frozenset(
        place for place in heights if rows >= _LEAST_ROWS and given[place] >= _USUAL * rows
    )
    return Style(_fixed_decimals(counts), filled)


def _fixed_decimals(counts: Mapping[int, Counter[int]]) -> dict[int, int]:
    usual = {p: c.most_common(1)[0][0] for p, c in counts.items() if c.total() >= _LEAST_ROWS}
    fixed = [place for place, decimals in usual.items() if decimals > 0]
    cells = sum(counts[place].total() for place in fixed)
    others = cells - sum(counts[place][usual[place]] for place in fixed)
    if cells < _LEAST_CELLS or others > max(1.0, _MOST_OTHERS * cells):
        return {}
    return {place: usual[place] for place in fixed}


def decimals_of(text: str, *, comma: bool) -> int:
    """Decimals of a number, or of the seconds of an angle."""
    sign = "," if comma else "."
    return len(text.rstrip("\"' ").rpartition(sign)[2]) if sign in text else 0


def check_style(cells: Sequence[str], style: Style, columns: Columns) -> None:
    """Refuse a row that is written otherwise than nearly all of its table.

    Raises
    ------
    CellError
        With what is wrong.
    """
    for place, decimals in style.decimals.items():
        text = cells[place].strip()
        if columns.is_number(place, text):
            found = decimals_of(text, comma=columns.comma)
            if found != decimals:
                raise CellError(
                    said(
                        "{text} has {found} decimals, its column {decimals}",
                        text=text[:40],
                        found=found,
                        decimals=decimals,
                    )
                )
    for place in style.filled:
        if not cells[place].strip():
            raise CellError("a height is missing that nearly every other row has")
