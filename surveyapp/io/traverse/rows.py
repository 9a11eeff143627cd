"""Rows of a traverse book: text to numbers in radians and metres, with every problem by line.

Knows columns, kinds and units; what sigma a row gets where it states none is decided where the
network is made (``core.network.traverse_network``).
"""

from __future__ import annotations

import math
from typing import Final

from surveyapp.domain.observations import ANGULAR, KINDS, ObservationKind
from surveyapp.domain.traverse_book import TraverseRow
from surveyapp.errors import Problem, nearest_names
from surveyapp.io.book_rows import MGON, BookRow, rows_of
from surveyapp.io.measures import is_measure
from surveyapp.languages import either, said
from surveyapp_models.angles import ARCSEC, AngleUnit

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
MM: Final = 1e-3


class _Row(BookRow):
    """One row of a traverse book."""

    __slots__ = ()

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
        return self.angle(kind, default)

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
    problems: list[Problem] = []
    columns = (*COLUMNS, *OPTIONAL)
    found = rows_of(_Row, text, columns=columns, required=REQUIRED, where=where, problems=problems)
    read = [_read(row, angle_unit) for row in found]
    return [row for row in read if row is not None], problems
