"""Rows of a field book: text to readings, one line at a time, with every problem kept by row.

This module knows columns, units and tokens. It does not know what a strike does to another row,
nor the sides of a swing.
"""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from typing import Final

from surveyapp.domain.readings import COLUMNS, QUANTITY, Dimension, Face, Reading, ReadingKind, Side
from surveyapp.errors import Problem, nearest_names
from surveyapp.io.files import (
    MAX_COLUMNS,
    has_control,
    shown,
    too_many_columns,
    too_many_lines,
    visible,
)
from surveyapp.languages import said
from surveyapp_models.angles import ARCSEC, TWO_PI, AngleError, AngleUnit, parse_angle

REQUIRED_COLUMNS: Final = ("seq", "kind", "value")

_UNITS: Final = {
    Dimension.ANGLE: ("dms", "gon", "deg"),
    Dimension.DIVISIONS: ("div",),
    Dimension.TILT: ("arcsec",),
    Dimension.SUPPLY: ("V", "Hz", "mA"),
    Dimension.TEMPERATURE: ("C",),
}
_LIMITS: Final = {
    Dimension.DIVISIONS: (-1e4, 1e4),
    Dimension.TILT: (-36000.0, 36000.0),
    Dimension.SUPPLY: (-1e6, 1e6),
    Dimension.TEMPERATURE: (-90.0, 150.0),
}
"""Plausible values, far wider than any instrument: outside is a slip of the pen."""
_STRIKING: Final = (ReadingKind.STRIKE, ReadingKind.UNSTRIKE)
_LARGEST_SEQ: Final = 10**9
_MOST_ROWS: Final = 5_000
"""No set-up has more; a larger file is a sensor log."""
_LARGEST_ELAPSED_S: Final = 1e8
_NUMBER = re.compile(r"[+\-−]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,3})?")
_DECIMAL_COMMA = re.compile(r"[+\-−]?\d+,\d+")
_POINT_HINT: Final = "decimals are written with a point and columns are separated by commas"


@dataclass(slots=True)
class RawBook:
    """The rows of a book with what is wrong with each.

    Parameters
    ----------
    rows : list of Reading
        In the order of the file.
    problems : list of (int or None, Problem)
        With the seq of the row whose value is in question; None where the problem stands whatever
        becomes of the row.
    odd_columns : tuple of str
        Columns that are not known.
    """

    rows: list[Reading] = field(default_factory=list)
    problems: list[tuple[int | None, Problem]] = field(default_factory=list)
    odd_columns: tuple[str, ...] = ()


def parse_rows(text: str, *, angle_unit: AngleUnit, where: str) -> RawBook:
    """Parse the complete lines of a book; the text must end with a newline or be empty."""
    book = RawBook()
    too_many = too_many_lines(text, where)
    if too_many is not None:
        book.problems.append((None, too_many))
        return book
    lines = text.split("\n")
    header: tuple[str, ...] | None = None
    for number, line in enumerate(lines, start=1):
        if not line.strip():
            continue
        place = said("{where}, line {number}", where=where, number=number)
        if has_control(line.rstrip("\r")) or "\r" in line.rstrip("\r"):
            problem = Problem("the line holds control characters", place, shown(line))
            book.problems.append((None, problem))
            continue
        try:
            cells = next(csv.reader([line.rstrip("\r")], strict=True))
        except (csv.Error, StopIteration) as error:
            problem = Problem(said("the line is no CSV ({error})", error=error), place, shown(line))
            book.problems.append((None, problem))
            if header is None:
                return book
            continue
        cells = [cell.strip() for cell in cells]
        if len(book.rows) >= _MOST_ROWS:
            problem = Problem(
                "the book is too long",
                place,
                "",
                said("at most {most_rows} rows", most_rows=_MOST_ROWS),
            )
            book.problems.append((None, problem))
            return book
        if header is None:
            header = tuple(name.lower() for name in cells)
            problems = _header_problems(header, line, place)
            if problems:
                book.problems.extend((None, problem) for problem in problems)
                return book
            book.odd_columns = tuple(n for n in header if n and n not in COLUMNS)
        elif any(cells):
            _RowReader(book, angle_unit, place, number).read(header, cells)
    _check_seq(book, where)
    return book


def _header_problems(header: Sequence[str], line: str, place: str) -> list[Problem]:
    if len(header) > MAX_COLUMNS:
        return [too_many_columns(len(header), place)]
    if ";" in line and "," not in line:
        return [
            Problem(
                "the columns are separated by semicolons", place, shown(line), "commas", _POINT_HINT
            )
        ]
    problems = [
        Problem(
            said("there is no column {name}", name=name),
            place,
            shown(line),
            ",".join(COLUMNS),
            nearest_names(name, [n for n in header if n not in COLUMNS]),
        )
        for name in REQUIRED_COLUMNS
        if name not in header
    ]
    doubled = sorted({name for name in header if name and header.count(name) > 1})
    problems += [
        Problem(said("there are two columns {name}", name=shown(name)), place, shown(line))
        for name in doubled
    ]
    return problems


def _check_seq(book: RawBook, where: str) -> None:
    previous: Reading | None = None
    for row in book.rows:
        if previous is not None and row.seq <= previous.seq:
            what = "twice" if row.seq == previous.seq else "not in increasing order"
            problem = Problem(
                said(
                    "the row numbers do not increase: seq {seq} stands {what}",
                    seq=row.seq,
                    what=what,
                ),
                said("{where}, line {line}", where=where, line=row.line),
                said("{seq} after {seq2}", seq=row.seq, seq2=previous.seq),
                "a seq larger than all above",
            )
            book.problems.append((None, problem))
        if previous is None or row.seq > previous.seq:
            previous = row


class _RowReader:
    """Reads one row; what is wrong goes to the book."""

    __slots__ = ("angle_unit", "book", "line", "place", "seq")

    def __init__(self, book: RawBook, angle_unit: AngleUnit, place: str, line: int) -> None:
        self.book = book
        self.angle_unit = angle_unit
        self.place = place
        self.line = line
        self.seq: int | None = None

    def fail(self, what: str, found: str, expected: str = "", hint: str = "") -> None:
        """A problem of the row as such."""
        self.book.problems.append((None, Problem(what, self.place, shown(found), expected, hint)))

    def fail_value(self, what: str, found: str, expected: str = "", hint: str = "") -> None:
        """A problem of what was read: a strike makes it void."""
        self.book.problems.append(
            (self.seq, Problem(what, self.place, shown(found), expected, hint))
        )

    def read(self, header: Sequence[str], cells: Sequence[str]) -> None:
        """Parse the row and add it to the book, if it can be made out at all."""
        beyond = [cell for cell in cells[len(header) :] if cell]
        beyond += [c for n, c in zip(header, cells, strict=False) if not n and c]
        if beyond:
            self.fail(
                "the row has more values than the header has columns",
                ",".join(cells),
                said("at most {size} values", size=len(header)),
                _POINT_HINT,
            )
            return
        cell = dict.fromkeys(COLUMNS, "")
        cell.update({n: c for n, c in zip(header, cells, strict=False) if n in cell})
        seq = cell["seq"]
        if not (seq.isascii() and seq.isdigit() and len(seq) <= 10 and int(seq) <= _LARGEST_SEQ):
            self.fail("seq is no row number", seq, "a whole number from 0 on")
            return
        self.seq = int(seq)
        self.place += f" (seq {self.seq})"
        try:
            kind = ReadingKind(cell["kind"].lower())
        except ValueError:
            hint = nearest_names(cell["kind"].lower(), [str(k) for k in ReadingKind])
            self.fail("the kind is not known", cell["kind"], "a kind of reading", hint)
            return
        self.book.rows.append(self._reading(self.seq, kind, cell))

    def _reading(self, seq: int, kind: ReadingKind, cell: Mapping[str, str]) -> Reading:
        unit = self._unit(kind, cell["unit"])
        elapsed = self._optional_number(
            cell["elapsed_s"], "elapsed_s", -_LARGEST_ELAPSED_S, _LARGEST_ELAPSED_S
        )
        time = self._time(cell["time"])
        if kind is ReadingKind.TRANSIT and elapsed is None and time is None:
            self.fail_value(
                "a transit needs its moment", cell["elapsed_s"], "elapsed_s in seconds, or time"
            )
        value = None if unit is None else self._value(kind, cell["value"], unit)
        return Reading(
            seq=seq,
            kind=kind,
            value=value,
            text=cell["value"],
            unit=unit or "",
            time=time,
            elapsed_s=elapsed,
            face=self._face(cell["face"]),
            side=self._side(cell["side"]),
            target=cell["target"],
            temperature_c=self._optional_number(
                cell["temperature_c"], "temperature_c", *_LIMITS[Dimension.TEMPERATURE]
            ),
            note=visible(cell["note"]),
            line=self.line,
            strikes=self._strikes(cell["value"]) if kind in _STRIKING else None,
        )

    def _unit(self, kind: ReadingKind, token: str) -> str | None:
        """Unit in force, None where the token cannot be used."""
        quantity = QUANTITY[kind]
        if quantity is Dimension.NONE:
            return ""
        allowed = _UNITS[quantity]
        if not token and quantity is Dimension.SUPPLY:
            self.fail_value("a supply reading needs its unit", "", " | ".join(allowed))
            return None
        if not token:
            return str(self.angle_unit) if quantity is Dimension.ANGLE else allowed[0]
        if token in allowed:
            return token
        hint = _POINT_HINT if token.isdigit() else ""
        self.fail_value(
            said("the unit does not suit {kind}", kind=kind), token, " | ".join(allowed), hint
        )
        return None

    def _value(self, kind: ReadingKind, text: str, unit: str) -> float | None:
        quantity = QUANTITY[kind]
        if quantity is Dimension.NONE:
            if kind is ReadingKind.MISSED and text:
                self.fail_value(
                    "a missed turning point has no value",
                    text,
                    "an empty value",
                    "a point that was read is entered as reversal or scale_reversal",
                )
            return None
        if not text:
            swing = kind in (ReadingKind.REVERSAL, ReadingKind.SCALE_REVERSAL)
            hint = "a turning point that was not read is entered as missed" if swing else ""
            self.fail_value(
                said("{kind} has no value", kind=kind),
                "",
                said("a reading in {unit}", unit=unit),
                hint,
            )
            return None
        if quantity is Dimension.ANGLE:
            return self._angle(text, AngleUnit(unit))
        value = self._number(text, str(kind), *_LIMITS[quantity])
        return value * ARCSEC if value is not None and quantity is Dimension.TILT else value

    def _angle(self, text: str, unit: AngleUnit) -> float | None:
        """Circle reading in [0, 2 pi)."""
        try:
            value = parse_angle(text, unit)
        except AngleError as error:
            hint = error.hint or (_POINT_HINT if _DECIMAL_COMMA.fullmatch(text) else "")
            self.fail_value("the reading is no angle", text, error.expected, hint)
            return None
        if value < 0.0:
            full = "400 gon" if unit is AngleUnit.GON else "360 degrees"
            self.fail_value(
                "a circle reading is not negative", text, said("0 to {full}", full=full)
            )
            return None
        return abs(value) % TWO_PI

    def _number(self, text: str, name: str, low: float, high: float) -> float | None:
        value = float(text.replace("−", "-")) if _NUMBER.fullmatch(text) else math.nan
        if not math.isfinite(value):
            hint = _POINT_HINT if _DECIMAL_COMMA.fullmatch(text) else ""
            self.fail_value(said("{name} is no number", name=name), text, "a plain number", hint)
            return None
        if not low <= value <= high:
            self.fail_value(
                said("{name} is out of range", name=name),
                text,
                said("{low:g} to {high:g}", low=low, high=high),
            )
            return None
        return value

    def _optional_number(self, text: str, name: str, low: float, high: float) -> float | None:
        return self._number(text, name, low, high) if text else None

    def _time(self, text: str) -> datetime | None:
        if not text:
            return None
        expected = "ISO 8601 with UTC offset like 2026-11-22T08:15:30+01:00"
        try:
            time = datetime.fromisoformat(text)
            offset = time.utcoffset()
        except (ValueError, OverflowError):
            self.fail_value("time is no moment", text, expected)
            return None
        if offset is None:
            self.fail_value(
                "time has no UTC offset", text, expected, "add Z for UTC, or your offset"
            )
            return None
        return time

    def _face(self, token: str) -> Face | None:
        if token.upper() in ("L", "R"):
            return Face(token.upper())
        if token:
            self.fail_value("the face is not known", token, "L | R")
        return None

    def _side(self, token: str) -> Side | None:
        if token.upper() in ("L", "R"):
            return Side(token.upper())
        if token:
            self.fail_value("the side is not known", token, "L | R (R = larger reading)")
        return None

    def _strikes(self, text: str) -> int | None:
        if text.isascii() and text.isdigit() and len(text) <= 10:
            return int(text)
        self.fail("a strike names no row", text, "the seq of the row that is struck")
        return None
