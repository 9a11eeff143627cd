"""Rows of a traverse book: text to numbers in radians and metres, with every problem by line.

Knows columns, kinds and units; what sigma a row gets where it states none is decided where the
network is made (``core.network.traverse_network``).
"""

from __future__ import annotations

import csv
import math
from typing import Final

from surveyapp.domain.observations import ANGULAR, KINDS, ObservationKind
from surveyapp.domain.traverse_book import TraverseRow
from surveyapp.errors import Problem, nearest_names
from surveyapp.io.files import MAX_COLUMNS, shown, too_many_columns, too_many_lines, visible
from surveyapp.io.measures import MEASURES, is_measure
from surveyapp.languages import either, said
from surveyapp_models.angles import ARCSEC, AngleError, AngleUnit, parse_angle

COLUMNS: Final = (
    "kind",
    "at",
    "from",
    "to",
    "value",
    "unit",
    "sigma",
    "sigma_unit",
    "set",
    "hi",
    "ht",
    "note",
)
OPTIONAL: Final = ("length_m",)
"""Columns that a book may have beside them: length of a levelled section."""
REQUIRED: Final = ("kind", "at", "to", "value")
BOOK_KINDS: Final = {str(item.kind): item for item in KINDS if item.book}
"""Kinds that a row may have, by the word in its column."""
_ANGLE_UNITS: Final = {"dms": AngleUnit.DMS, "gon": AngleUnit.GON, "deg": AngleUnit.DEG}
MGON: Final = math.pi / 200_000.0
MM: Final = 1e-3


class _Row:
    """Cells of one row and the place for messages."""

    __slots__ = ("cells", "line", "problems", "where")

    def __init__(
        self, cells: dict[str, str], where: str, line: int, problems: list[Problem]
    ) -> None:
        self.cells, self.where, self.line, self.problems = cells, where, line, problems

    def problem(self, what: str, found: str, expected: str, hint: str = "") -> None:
        self.problems.append(
            Problem(
                what,
                said("{where}, line {line}", where=self.where, line=self.line),
                shown(found),
                expected,
                hint,
            )
        )

    def number(self, key: str) -> float | None:
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

    def value(self, kind: ObservationKind, default: AngleUnit) -> float | None:
        text, unit = self.cells["value"], self.cells["unit"]
        if BOOK_KINDS[kind].book == "none":
            return None
        if not text:
            self.problem("the value is missing", "", "what was observed")
            return None
        if kind not in ANGULAR:
            if unit not in ("", "m"):
                self.problem(said("{kind} in a wrong unit", kind=kind), unit, "m")
                return None
            return self.number("value")
        if unit and unit not in _ANGLE_UNITS:
            hint = nearest_names(unit, _ANGLE_UNITS)
            self.problem(said("{kind} in a wrong unit", kind=kind), unit, "dms, gon or deg", hint)
            return None
        try:
            return parse_angle(text, _ANGLE_UNITS[unit] if unit else default)
        except AngleError as error:
            self.problem(said("{kind} is no angle", kind=kind), text, error.expected, error.hint)
            return None

    def sigma(self, kind: ObservationKind, value: float | None) -> float | None:
        text, unit = self.cells["sigma"], self.cells["sigma_unit"]
        if not text:
            return None
        allowed = ("arcsec", "mgon") if kind in ANGULAR else ("mm", "mm+ppm")
        unit = unit or allowed[0]
        if unit not in allowed:
            self.problem("the sigma has a wrong unit", unit, either(allowed))
            return None
        if unit == "mm+ppm":
            return self._mm_ppm(text, value)
        number = self.number("sigma")
        if number is None:
            return None
        if number <= 0.0:
            self.problem("the sigma is not positive", text, "a number above 0")
            return None
        return number * {"arcsec": ARCSEC, "mgon": MGON, "mm": MM}[unit]

    def _mm_ppm(self, text: str, value: float | None) -> float | None:
        parts = text.split("+")
        try:
            mm, ppm = (float(part) for part in parts)
        except ValueError:
            self.problem("the sigma is no mm+ppm", text, "two numbers like 2+2")
            return None
        if value is None:
            return None
        sigma = math.hypot(mm * MM, ppm * 1e-6 * value)
        if mm < 0.0 or ppm < 0.0 or sigma <= 0.0 or not is_measure(sigma):
            self.problem("the sigma is not positive", text, "numbers from 0 on, not both 0")
            return None
        return sigma


def _read(row: _Row, default: AngleUnit) -> TraverseRow | None:
    before = len(row.problems)
    cells = row.cells
    known = BOOK_KINDS.get(cells["kind"])
    if known is None:
        hint = nearest_names(cells["kind"], BOOK_KINDS)
        row.problem("the kind is not known", cells["kind"], "a kind of observation", hint)
        return None
    kind = known.kind
    value = row.value(kind, default)
    sigma = row.sigma(kind, value)
    hi, ht = row.number("hi") or 0.0, row.number("ht") or 0.0
    if kind is ObservationKind.ZENITH and value is not None and not 0.0 < value < math.pi:
        hint = "Reduce both faces to face left first."
        row.problem("no zenith angle", cells["value"], "between 0 and 180 degrees", hint)
    length = row.number("length_m") if kind is ObservationKind.HEIGHT_DIFFERENCE else None
    if length is not None and length <= 0.0:
        row.problem("a levelled section has no length", cells["length_m"], "metres above 0")
    if len(row.problems) > before:
        return None
    back = cells["from"] if kind is ObservationKind.ANGLE else ""
    return TraverseRow(
        kind,
        cells["at"],
        back,
        cells["to"],
        value,
        sigma,
        cells["set"],
        hi,
        ht,
        cells["note"],
        row.line,
        length,
    )


def _header(cells: list[str], line: str, where: str, problems: list[Problem]) -> bool:
    place = said("{where}, line 1", where=where)
    if ";" in line and "," not in line:
        problems.append(
            Problem("the columns are separated by semicolons", place, shown(line), "commas")
        )
        return False
    missing = [name for name in REQUIRED if name not in cells]
    if missing:
        expected = ",".join(COLUMNS)
        problems.append(
            Problem(
                said("there is no column {names}", names=", ".join(missing)),
                place,
                shown(line),
                expected,
            )
        )
    return not missing


def parse_traverse(
    text: str, *, angle_unit: AngleUnit, where: str
) -> tuple[list[TraverseRow], list[Problem]]:
    """Parse a traverse book.

    Parameters
    ----------
    text : str
    angle_unit : AngleUnit
        Unit of angles whose row names none.
    where : str
        What messages call the book.

    Returns
    -------
    rows, problems
    """
    too_many = too_many_lines(text, where)
    if too_many is not None:
        return [], [too_many]
    problems: list[Problem] = []
    rows: list[TraverseRow] = []
    header: list[str] | None = None
    reader = csv.reader(visible(text).splitlines(), strict=True)
    try:
        for cells in reader:
            stripped = [cell.strip() for cell in cells]
            if not any(stripped) or stripped[0].startswith("#"):
                continue
            if header is None:
                header = [name.lower() for name in stripped]
                if len(header) > MAX_COLUMNS:
                    problems.append(too_many_columns(len(header), where))
                    break
                if not _header(header, ",".join(cells), where, problems):
                    return rows, problems
                continue
            if len(stripped) > len(header):
                place = said("{where}, line {line_num}", where=where, line_num=reader.line_num)
                hint = "decimals are written with a point"
                problems.append(
                    Problem("more values than columns", place, shown(",".join(cells)), "", hint)
                )
                continue
            named = dict.fromkeys((*COLUMNS, *OPTIONAL), "")
            named.update(zip(header, stripped, strict=False))
            row = _read(_Row(named, where, reader.line_num, problems), angle_unit)
            if row is not None:
                rows.append(row)
    except csv.Error as error:
        problems.append(
            Problem(
                said("no CSV ({error})", error=error),
                said("{where}, line {line_num}", where=where, line_num=reader.line_num),
            )
        )
    if header is None:
        problems.append(Problem("the book is empty", where, "", ",".join(COLUMNS)))
    return rows, problems
