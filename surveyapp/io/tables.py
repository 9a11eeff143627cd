"""One parsed TOML table, read key by key: wrong values become problems, unread keys warnings.

A reader asks a ``Table`` for what it knows; what nobody asked for is unknown. No reader of a
table raises for a wrong value: it gets None and goes on, so that all problems of a file come
together.
"""

from __future__ import annotations

import datetime as dt
import math
import re
import tomllib
from collections.abc import Mapping, Sequence
from typing import Final

from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.io.files import has_steering, shown
from surveyapp.io.findings import Findings
from surveyapp.languages import joined, said
from surveyapp_models.angles import TWO_PI, AngleError, AngleUnit, parse_angle

_LONGEST_NAME: Final = 200
_SMALLEST: Final = 1e-9
_MOST_TABLES: Final = 150_000
_MOST_VALUES: Final = 600_000
"""Beyond them memory and time of reading are no longer those of a few letters."""
_MOST_LETTERS: Final = 10_000_000
"""Twice what ten thousand sessions with everything that is told of them need."""
_KEY: Final = re.compile(r"^[^=\n\"'#]*(?==)", re.MULTILINE)
_DEEPEST: Final = 24
_DEEP_KEY: Final = re.compile(r"(?<![A-Za-z0-9_-])(?:[A-Za-z0-9_-]+[ \t]*\.[ \t]*){24}")


def parse_toml(text: str, *, where: str) -> dict[str, object]:
    """Parse TOML; a syntax error becomes a problem that names line and column.

    Raises
    ------
    SurveyError
    """
    if len(text) > _MOST_LETTERS:
        raise SurveyError(
            Problem(
                "this is too much text for a TOML file",
                where,
                said("{size} million letters", size=math.ceil(len(text) / 1e6)),
                said("at most {size} million letters", size=_MOST_LETTERS // 1_000_000),
                "readings and sensor logs stand in files of their own, which it names",
            )
        )
    try:
        if _DEEP_KEY.search(text) is not None or _is_too_much(text):
            raise RecursionError
        data = tomllib.loads(text)
        _check_depth(data)
        return data
    except tomllib.TOMLDecodeError as error:
        raise SurveyError(
            Problem(
                "this is no valid TOML",
                where,
                shown(str(error)),
                "key = value lines and [[table]] headers",
                "texts stand in double quotes, numbers do not",
            )
        ) from None
    except (ValueError, RecursionError, OverflowError):
        raise SurveyError(
            Problem("this is no usable TOML: a number or a nesting is beyond all bounds", where)
        ) from None


def _is_too_much(text: str) -> bool:
    """Whether a text may make more tables or values than a project of 10,000 sessions needs."""
    keys: list[str] = _KEY.findall(text)
    tables = text.count("[") + text.count("{") + sum(key.count(".") for key in keys)
    return tables > _MOST_TABLES or text.count(",") + text.count("=") > _MOST_VALUES


def _check_depth(data: object) -> None:
    """Refuse nesting that no reader of a project needs, before anything descends into it."""
    level: list[object] = [data]
    for _ in range(_DEEPEST):
        below: list[object] = []
        for item in level:
            if isinstance(item, dict):
                below += item.values()
            elif isinstance(item, list):
                below += item
        level = [item for item in below if isinstance(item, dict | list)]
        if not level:
            return
    raise RecursionError


class Table:
    """A mapping of one file with the place it came from.

    Parameters
    ----------
    data : mapping
        The parsed table.
    where : str
        Place for messages.
    findings : Findings
        Where problems and warnings go.
    """

    __slots__ = ("_asked", "data", "findings", "where")

    def __init__(self, data: Mapping[str, object], where: str, findings: Findings) -> None:
        self.data = data
        self.where = where
        self.findings = findings
        self._asked: set[str] = set()

    def __contains__(self, key: str) -> bool:
        return key in self.data

    def problem(self, what: str, found: object = "", expected: str = "", hint: str = "") -> None:
        """Note a problem of this table."""
        self.findings.problems.append(Problem(what, self.where, shown(found), expected, hint))

    def get(self, key: str) -> object:
        """Value as it stands, None where absent; the key counts as known."""
        self._asked.add(key)
        return self.data.get(key)

    def text(self, key: str, *, required: bool = False, multiline: bool = False) -> str | None:
        """Text, or None. A present text may not be blank where it is required."""
        value = self.get(key)
        if value is None:
            if required:
                self.problem(said("{key} is missing", key=key), "", f'{key} = "..."')
            return None
        if not isinstance(value, str):
            self.problem(said("{key} is no text", key=key), value, "a text in double quotes")
            return None
        if (not value.strip() and required) or (
            has_steering(value) or (not multiline and ("\n" in value or len(value) > _LONGEST_NAME))
        ):
            self.problem(
                said("{key} is no usable text", key=key), value, "one line of printable characters"
            )
            return None
        return value

    def choice(self, key: str, choices: Sequence[str], *, required: bool = False) -> str | None:
        """One of the given words, or None."""
        value = self.text(key, required=required)
        if value is None or value in choices:
            return value
        self.problem(
            said("{key} is not known", key=key),
            value,
            " | ".join(choices),
            nearest_names(value, choices),
        )
        return None

    def number(
        self,
        key: str,
        *,
        low: float = -1e12,
        high: float = 1e12,
        required: bool = False,
        positive: bool = False,
    ) -> float | None:
        """Finite number within [low, high], or None.

        ``positive`` excludes zero as well, and what is so small that no measurement can be meant.
        """
        value = self.get(key)
        if value is None:
            if required:
                self.problem(
                    said("{key} is missing", key=key), "", said("{key} = a number", key=key)
                )
            return None
        number = as_number(value)
        if number is None:
            self.problem(
                said("{key} is no number", key=key), value, "a finite number without quotes"
            )
            return None
        small = positive and number < _SMALLEST
        if small or not low <= number <= high:
            expected = "more than 0" if small else said("{low:g} to {high:g}", low=low, high=high)
            self.problem(said("{key} is out of range", key=key), value, expected)
            return None
        return number

    def boolean(self, key: str, *, default: bool = False) -> bool:
        """``true`` or ``false``."""
        value = self.get(key)
        if value is None or isinstance(value, bool):
            return default if value is None else value
        self.problem(said("{key} is neither true nor false", key=key), value, "true | false")
        return default

    def angle(self, key: str, unit: AngleUnit) -> float | None:
        """Direction in [0, 2 pi) [rad]: angle text, or a number where the unit is gon or deg."""
        value = self.get(key)
        if value is None:
            return None
        number = as_number(value)
        if isinstance(value, str) or (number is not None and unit is not AngleUnit.DMS):
            text = value if isinstance(value, str) else f"{number:.12f}"
            try:
                angle = parse_angle(text, unit)
            except AngleError as error:
                self.problem(said("{key} is no angle", key=key), value, error.expected, error.hint)
                return None
            return angle % TWO_PI
        self.problem(
            said("{key} is no angle", key=key),
            value,
            said("angle text in {unit}, in double quotes", unit=unit),
        )
        return None

    def date(self, key: str) -> dt.date | None:
        """Calendar date, or None; a date and time gives its date."""
        value = self.get(key)
        if isinstance(value, str):
            try:
                value = dt.date.fromisoformat(value.strip())
            except ValueError:
                self.problem(said("{key} is no date", key=key), value, "a date like 2015-10-26")
                return None
        if isinstance(value, dt.datetime):
            return value.date()
        if value is None or isinstance(value, dt.date):
            return value
        self.problem(said("{key} is no date", key=key), value, "a date like 2015-10-26")
        return None

    def table(self, key: str) -> Table | None:
        """Sub-table, or None."""
        value = self.get(key)
        if value is None:
            return None
        if not isinstance(value, Mapping):
            self.problem(
                said("{key} is no table", key=key),
                value,
                said("{key} = {{ ... }} or [{key}]", key=key),
            )
            return None
        return Table(value, joined(", ", (self.where, key)), self.findings)

    def tables(self, key: str, lines: Sequence[int] = ()) -> list[Table]:
        """Every ``[[key]]`` table; ``lines`` are the lines of their headers where known."""
        value = self.get(key)
        if value is None:
            return []
        if not isinstance(value, list) or not all(isinstance(item, Mapping) for item in value):
            self.problem(
                said("{key} is no list of tables", key=key), value, f"[[{key}]]", "two brackets"
            )
            return []
        placed = lines if len(lines) == len(value) else [0] * len(value)
        found = []
        for index, (item, line) in enumerate(zip(value, placed, strict=True), start=1):
            name = item.get("id", item.get("name"))
            label = shown(name) if isinstance(name, str) and name else said("number {n}", n=index)
            place = said("{where} line {line}", where=self.where, line=line) if line else self.where
            where = said("{place}, {table} {label}", place=place, table=f"[[{key}]]", label=label)
            found.append(Table(item, where, self.findings))
        return found

    def unread(self) -> list[str]:
        """Keys that nobody has asked for."""
        return [key for key in self.data if key not in self._asked]

    def warn_unknown(self, *also_known: str) -> None:
        """Note a warning for every key that nobody has asked for."""
        known = self._asked.union(also_known)
        for key in self.data:
            if key not in known:
                self.findings.unknown_key(key, where=self.where, known=known)

    def refuse_unknown(self, *also_known: str) -> None:
        """Note a problem for every key that nobody has asked for.

        For tables in which a key that is not used would change what is judged.
        """
        known = self._asked.union(also_known)
        for key in self.unread():
            hint = nearest_names(key, known)
            self.problem(said("{key} is not known", key=shown(key)), hint=hint)


def as_number(value: object) -> float | None:
    """Finite float of a TOML integer or float, None for anything else."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    try:
        number = float(value)
    except OverflowError:
        return None
    return number if math.isfinite(number) else None
