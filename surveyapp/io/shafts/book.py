"""Rows of a shaft book: text to numbers, with every problem by line.

Columns ``kind,place,at,from,to,value,unit,sigma,sigma_unit,set,note`` (penetration.md section 6).
"""

from __future__ import annotations

import csv
import math
from typing import Final, Literal, cast

from surveyapp.domain.shaft import ShaftRow, ShaftRowKind
from surveyapp.errors import Problem, nearest_names
from surveyapp.io.files import shown, too_many_lines
from surveyapp.io.measures import MEASURES, is_measure
from surveyapp.languages import either, said
from surveyapp_models.angles import ARCSEC, AngleError, AngleUnit, parse_angle

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
_UNITS: Final = {"dms": AngleUnit.DMS, "gon": AngleUnit.GON, "deg": AngleUnit.DEG}
_MGON: Final = math.pi / 200_000.0
_SIGMA_UNITS: Final = {
    K.ANGLE: {"arcsec": ARCSEC, "mgon": _MGON},
    K.AZIMUTH: {"arcsec": ARCSEC, "mgon": _MGON},
    K.DISTANCE: {"mm": 1e-3, "m": 1.0},
    K.DEPTH: {"mm": 1e-3, "m": 1.0},
    K.SWING: {"mm": 1.0},
}
_LENGTH_UNITS: Final = {
    K.DISTANCE: {"": 1.0, "m": 1.0, "mm": 1e-3},
    K.DEPTH: {"": 1.0, "m": 1.0},
    K.SWING: {"": 1.0, "mm": 1.0},
}


class _Row:
    """Cells of one row and where its problems go."""

    __slots__ = ("cells", "problems", "where")

    def __init__(self, cells: dict[str, str], where: str, problems: list[Problem]) -> None:
        self.cells, self.where, self.problems = cells, where, problems

    def problem(self, what: str, found: str, expected: str, hint: str = "") -> None:
        self.problems.append(Problem(what, self.where, shown(found), expected, hint))

    def number(self, key: str) -> float | None:
        text = self.cells[key]
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

    def value(self, kind: ShaftRowKind, default: AngleUnit) -> float | None:
        text, unit = self.cells["value"], self.cells["unit"]
        if not text:
            self.problem("the value is missing", "", "what was observed")
            return None
        if kind in (K.ANGLE, K.AZIMUTH):
            if unit and unit not in _UNITS:
                self.problem(said("{kind} in a wrong unit", kind=kind), unit, "dms, gon or deg")
                return None
            try:
                return parse_angle(text, _UNITS[unit] if unit else default)
            except AngleError as error:
                self.problem(
                    said("{kind} is no angle", kind=kind), text, error.expected, error.hint
                )
                return None
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


def _read(row: _Row, default: AngleUnit, line: int) -> ShaftRow | None:
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
        line,
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
    too_many = too_many_lines(text, where)
    if too_many is not None:
        return [], [too_many]
    problems: list[Problem] = []
    rows: list[ShaftRow] = []
    header: list[str] | None = None
    reader = csv.reader(text.splitlines(), strict=True)
    try:
        for cells in reader:
            stripped = [cell.strip() for cell in cells]
            if not any(stripped) or stripped[0].startswith("#"):
                continue
            place = said("{where}, line {line_num}", where=where, line_num=reader.line_num)
            if header is None:
                header = [name.lower() for name in stripped]
                missing = [name for name in REQUIRED if name not in header]
                if missing:
                    what = said("there is no column {names}", names=", ".join(missing))
                    problems.append(Problem(what, place, shown(",".join(cells)), ",".join(COLUMNS)))
                    return rows, problems
                continue
            if len(stripped) > len(header):
                hint = "decimals are written with a point"
                found = shown(",".join(cells))
                problems.append(Problem("more values than columns", place, found, "", hint))
                continue
            named = dict.fromkeys(COLUMNS, "")
            named.update(zip(header, stripped, strict=False))
            row = _read(_Row(named, place, problems), angle_unit, reader.line_num)
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
