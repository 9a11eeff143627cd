"""Rows of a shaft book: text to numbers, with every problem by line.

Columns ``kind,place,at,from,to,value,unit,sigma,sigma_unit,set,note`` (penetration.md section 6).
"""

from __future__ import annotations

from typing import Final, Literal, cast

from surveyapp.domain.shaft import ShaftRow, ShaftRowKind
from surveyapp.errors import Problem, nearest_names
from surveyapp.io.book_rows import MGON, BookRow, rows_of
from surveyapp.languages import either, said
from surveyapp_models.angles import ARCSEC, AngleUnit

COLUMNS: Final = (
    "kind",
    "place",
    "at",
    "from",
    "to",
    "value",
    "unit",
    "sigma",
    "sigma_unit",
    "set",
    "note",
)
REQUIRED: Final = ("kind", "value")
PLACES: Final = ("surface", "underground")
K = ShaftRowKind
_SIGMA_UNITS: Final = {
    K.ANGLE: {"arcsec": ARCSEC, "mgon": MGON},
    K.AZIMUTH: {"arcsec": ARCSEC, "mgon": MGON},
    K.DISTANCE: {"mm": 1e-3, "m": 1.0},
    K.DEPTH: {"mm": 1e-3, "m": 1.0},
    K.SWING: {"mm": 1.0},
}
_LENGTH_UNITS: Final = {
    K.DISTANCE: {"": 1.0, "m": 1.0, "mm": 1e-3},
    K.DEPTH: {"": 1.0, "m": 1.0},
    K.SWING: {"": 1.0, "mm": 1.0},
}


class _Row(BookRow):
    """One row of a shaft book."""

    __slots__ = ()

    def value(self, kind: ShaftRowKind, default: AngleUnit) -> float | None:
        text, unit = self.cells["value"], self.cells["unit"]
        if not text:
            self.problem("the value is missing", "", "what was observed")
            return None
        if kind in (K.ANGLE, K.AZIMUTH):
            return self.angle(kind, default)
        units = _LENGTH_UNITS[kind]
        if unit not in units:
            self.problem(
                said("{kind} in a wrong unit", kind=kind), unit, either(u for u in units if u)
            )
            return None
        number = self.number("value")
        if number is not None and number <= 0.0 and kind is not K.SWING:
            self.problem(said("{kind} is not positive", kind=kind), text, "above 0 m")
            return None
        return None if number is None else number * units[unit]

    def sigma(self, kind: ShaftRowKind) -> float | None:
        text, unit = self.cells["sigma"], self.cells["sigma_unit"]
        if not text:
            if kind is K.AZIMUTH:
                self.problem("the azimuth has no sigma", "", "sigma in arcsec")
            return None
        units = _SIGMA_UNITS[kind]
        unit = unit or next(iter(units))
        if unit not in units:
            self.problem("the sigma has a wrong unit", unit, either(units))
            return None
        number = self.number("sigma")
        if number is not None and number <= 0.0:
            self.problem("the sigma is not positive", text, "a number above 0")
            return None
        return None if number is None else number * units[unit]


def _points(row: _Row, kind: ShaftRowKind) -> None:
    """Every point that a kind needs is named, and no sight ends where it begins."""
    needed = {
        K.ANGLE: ("at", "from", "to"),
        K.DISTANCE: ("at", "to"),
        K.AZIMUTH: ("at", "to"),
        K.SWING: ("at",),
        K.DEPTH: (),
    }[kind]
    cells = row.cells
    for key in needed:
        if not cells[key]:
            row.problem(said("{key} is missing", key=key), "", "the name of a point")
    names = [cells[key] for key in needed if cells[key]]
    if len(set(names)) < len(names):
        row.problem("a sight to itself", ", ".join(names), "different points")
    if kind is K.SWING and cells["set"] not in ("x", "y"):
        row.problem("the axis of the swing is not known", cells["set"], "set = x or y")


def _read(row: _Row, default: AngleUnit) -> ShaftRow | None:
    before, cells = len(row.problems), row.cells
    if cells["kind"] not in [str(kind) for kind in K]:
        hint = nearest_names(cells["kind"], [str(kind) for kind in K])
        row.problem("the kind is not known", cells["kind"], "a kind of a shaft book", hint)
        return None
    kind = K(cells["kind"])
    place = cells["place"] or ("underground" if kind is K.AZIMUTH else "")
    if place not in PLACES and not (place == "" and kind in (K.SWING, K.DEPTH)):
        row.problem("the place is not known", place, either(PLACES))
    _points(row, kind)
    value, sigma = row.value(kind, default), row.sigma(kind)
    if len(row.problems) > before or value is None:
        return None
    back = cells["from"] if kind is K.ANGLE else ""
    return ShaftRow(
        kind,
        cast("Literal['surface', 'underground', '']", place),
        cells["at"],
        back,
        cells["to"] if kind is not K.SWING else "",
        value,
        sigma,
        cells["set"],
        cells["note"],
        row.line,
    )


def parse_shaft_book(
    text: str, *, angle_unit: AngleUnit, where: str
) -> tuple[list[ShaftRow], list[Problem]]:
    """Parse a shaft book.

    Parameters
    ----------
    text : str
    angle_unit : AngleUnit
        Unit of angles whose row names none.
    where : str
        What messages call the book.
    """
    problems: list[Problem] = []
    found = rows_of(_Row, text, columns=COLUMNS, required=REQUIRED, where=where, problems=problems)
    read = [_read(row, angle_unit) for row in found]
    return [row for row in read if row is not None], problems
