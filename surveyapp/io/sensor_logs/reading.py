"""Reading a sensor log: which column is what, in which unit, and everything that is wrong with it.

``open_log`` looks at the head of a file; ``LogFile.read`` reads the columns that a calibration
needs. Everything that is wrong with names, units, cells, times and values is raised together.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final, Literal

import numpy as np

from surveyapp.domain.advance import PartDone
from surveyapp.domain.columns import pieces
from surveyapp.domain.sensor_log import (
    NUMBER_COLUMNS,
    SENSOR_COLUMNS,
    TEXT_COLUMNS,
    Array,
    Gap,
    SensorLog,
)
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.io.files import decode, shown, shown_path
from surveyapp.io.sensor_logs import checks
from surveyapp.io.sensor_logs.blocks import Rows, Wrong, count_lines, even_times, read_rows
from surveyapp.io.sensor_logs.layout import LOOKED_AT, Layout, find_layout
from surveyapp.io.sensor_logs.units import COUNTS, DIMENSIONLESS, UNITS, factor_to, unit_in_name
from surveyapp.languages import said

_HEAD_BYTES: Final = 1 << 18


@dataclass(frozen=True, slots=True)
class LogRequest:
    """Which file, and how its columns are to be understood.

    Parameters
    ----------
    path : Path
    where : str
        What messages call it.
    id : str
    columns : mapping of str to str
        Canonical name to the name in the file.
    units : mapping of str to str
        Name in the file, or canonical name, to a unit token.
    scale : mapping of str to float
        Name in the file, or canonical name, to the value of one count in the unit of the column.
    rate_hz : float or None
    header_rows : int or None
    sha256 : str or None
        The file is refused if it has another.
    """

    path: Path
    where: str
    id: str = ""
    columns: Mapping[str, str] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    scale: Mapping[str, float] = field(default_factory=dict)
    rate_hz: float | None = None
    header_rows: int | None = None
    sha256: str | None = None


@dataclass(frozen=True, slots=True)
class Need:
    """What a calibration wants of a log.

    Parameters
    ----------
    columns : tuple of str
        Canonical columns that must be there and finite in each row.
    varying : tuple of str
        Those of them that may not be constant.
    optional : tuple of str or None
        Canonical columns that are read where they are there; None = every one.
    others : tuple of str
        Columns by their name in the file, read as they are.
    timed : str
        ``required``: ``time_s`` or a rate; ``optional``: read and checked where it is there;
        ``no``: not read.
    unit_stated : tuple of str
        Columns that need a stated unit, counts among them.
    biased : bool
        Whether a large bias is part of what is calibrated (counts about the middle of their
        range), so that the size of a vector says nothing of its unit.
    """

    columns: tuple[str, ...] = ()
    varying: tuple[str, ...] = ()
    optional: tuple[str, ...] | None = ()
    others: tuple[str, ...] = ()
    timed: Literal["required", "optional", "no"] = "required"
    unit_stated: tuple[str, ...] = ()
    biased: bool = False


@dataclass(frozen=True, slots=True)
class Place:
    """Where a column stands in the file, and how its cells become values."""

    index: int
    name: str
    unit: str
    factor: float
    stated: bool
    counts: bool


@dataclass(frozen=True, slots=True)
class LogFile:
    """A log whose head has been looked at.

    Parameters
    ----------
    request : LogRequest
    layout : Layout
    places : mapping of str to Place
        Canonical name to its column; other columns by their name in the file.
    problems : tuple of Problem
        Of names and units; raised together with those of the rows.
    """

    request: LogRequest
    layout: Layout
    places: Mapping[str, Place]
    problems: tuple[Problem, ...] = ()

    def has(self, *names: str) -> bool:
        """Whether the file holds all of these canonical columns."""
        return all(name in self.places for name in names)

    def read(self, need: Need, *, progress: PartDone | None = None) -> SensorLog:
        """Read what is needed.

        Raises
        ------
        SurveyError
            With everything that is wrong.
        """
        request, problems = self.request, list(self.problems)
        problems += self._missing(need)
        numbers, texts = self._wanted(need)
        lines, sha256 = count_lines(request.path, where=request.where)
        problems += _pinned(request, sha256)
        wrong = Wrong(request.where)
        indices = ([self.places[n].index for n in numbers], [self.places[n].index for n in texts])
        rows = read_rows(
            request.path, self.layout, indices, lines=lines, wrong=wrong, progress=progress
        )
        problems += wrong.all()
        size = rows.numbers.shape[1] if numbers else len(rows.texts[0]) if texts else 0
        if size == 0 and not problems:
            problems.append(Problem("the log has no row", request.where, "", "rows of numbers"))
        self._scale(numbers, rows)
        columns = dict(zip(numbers, rows.numbers, strict=True))
        if not wrong.count and size:
            problems += self._column_problems(need, columns)
        if problems:
            raise SurveyError(problems)
        return self._log(need, columns, (texts, rows), sha256)

    def _missing(self, need: Need) -> list[Problem]:
        where, problems = self.request.where, []
        wanted = [*need.columns, *need.others]
        if need.timed == "required" and self.request.rate_hz is None:
            wanted.insert(0, "time_s")
        for name in dict.fromkeys(wanted):
            if name in self.places:
                continue
            named = said("`columns` {name}=COLUMN names it", name=name)
            hint = "" if name in need.others else named
            if name == "time_s":
                hint += said("; `rate_hz` replaces it")
            listing = ", ".join(shown(n) for n in self.layout.names)
            what = said("the column {name} is missing", name=name)
            problems.append(Problem(what, where, listing, name, hint))
        for name in need.unit_stated:
            if name in self.places and not self.places[name].stated:
                column = self.places[name].name
                hint = said("`units` {column}=LSB for counts", column=column)
                expected = "a unit for this column"
                what = said("{name} has no unit", name=name)
                problems.append(Problem(what, where, column, expected, hint))
        return problems

    def _wanted(self, need: Need) -> tuple[list[str], list[str]]:
        optional = [*NUMBER_COLUMNS, *TEXT_COLUMNS] if need.optional is None else need.optional
        names = [*need.columns, *optional, *need.others]
        if need.timed != "no":
            names.insert(0, "time_s")
        names = [name for name in dict.fromkeys(names) if name in self.places]
        return [n for n in names if n not in TEXT_COLUMNS], [n for n in names if n in TEXT_COLUMNS]

    def _scale(self, numbers: Sequence[str], rows: Rows) -> None:
        for row, name in enumerate(numbers):
            factor = self.places[name].factor
            if factor != 1.0:
                for piece in pieces(rows.numbers[row]):
                    piece *= factor

    def _column_problems(self, need: Need, columns: Mapping[str, Array]) -> list[Problem]:
        where, first = self.request.where, self.layout.first_row
        problems: list[Problem] = []
        for name, values in columns.items():
            timed = name == "time_s" and need.timed != "no"
            free = not (name in need.columns or name in need.others or timed)
            problems += checks.not_finite(name, values, where=where, first_row=first, blanks=free)
            if name in need.varying:
                problems += checks.constant(name, values, where=where)
        if "time_s" in columns and need.timed != "no":
            problems += checks.bad_times(columns["time_s"], where=where, first_row=first)
        stated = [name for name in columns if self.places[name].stated]
        problems += checks.mixed_units(columns, where=where)
        problems += checks.strange_temperatures(columns, where=where)
        problems += checks.off_circle(columns, where=where)
        if not need.biased or not stated:
            problems += checks.implausible(columns, stated=stated, where=where)
        named = [name for name in columns if self.places[name].name.endswith(_suffix(name))]
        problems += checks.unstated_counts(columns, stated=stated, named=named, where=where)
        return problems

    def _log(
        self,
        need: Need,
        columns: dict[str, Array],
        words: tuple[list[str], Rows],
        sha256: str,
    ) -> SensorLog:
        texts, rows = words
        size = rows.numbers.shape[1] if columns else len(rows.texts[0])
        rate: float | None = self.request.rate_hz
        gaps: tuple[Gap, ...] = ()
        if "time_s" in columns and need.timed != "no":
            interval, gaps = checks.gaps_of(columns["time_s"])
            rate = rate or (1.0 / interval if interval > 0.0 else None)
        elif need.timed != "no" and rate is not None:
            columns["time_s"] = even_times(size, rate)
        clipped = checks.clipped_columns(columns)
        warnings: list[ResultWarning] = checks.gap_warning(gaps) + checks.clip_warning(clipped)
        return SensorLog(
            id=self.request.id or self.request.path.name,
            columns=columns,
            units={n: self.places[n].unit if n in self.places else "s" for n in columns},
            size=size,
            texts={n: tuple(v) for n, v in zip(texts, rows.texts, strict=True)},
            rate_hz=rate,
            gaps=gaps,
            clipped=clipped,
            scaled={n: self.places[n].factor for n in columns if self._counted(n)},
            sha256=sha256,
            path=self.request.where,
            first_line=rows.first_row,
            warnings=tuple(warnings),
        )

    def _counted(self, name: str) -> bool:
        return name in self.places and self.places[name].counts


def open_log(request: LogRequest) -> LogFile:
    """Look at the head of a log.

    Raises
    ------
    SurveyError
        If it cannot be read or holds no table.
    """
    where = request.where
    try:
        if not request.path.is_file():
            what = "this is a folder" if request.path.is_dir() else "the log does not exist"
            raise SurveyError(Problem(what, where, shown_path(request.path), "a file of numbers"))
        with request.path.open("rb") as stream:
            head = stream.read(_HEAD_BYTES)
    except OSError as error:
        what = said("the file cannot be read ({strerror})", strerror=error.strerror or error)
        raise SurveyError(Problem(what, where, shown_path(request.path))) from None
    except ValueError as error:
        raise SurveyError(Problem(said("this is no path ({error})", error=error), where)) from None
    whole = head if len(head) < _HEAD_BYTES else head[: head.rfind(b"\n") + 1]
    lines = decode(whole, where=where).replace("\r\n", "\n").split("\n")[:LOOKED_AT]
    if not whole.strip():
        raise SurveyError(Problem("the log is empty", where, "", "a line of names and rows"))
    layout = find_layout(lines, header_rows=request.header_rows, where=where)
    if layout.first_row == 0:
        raise SurveyError(Problem("the log has no row", where, "", "rows below the names"))
    problems: list[Problem] = []
    places = _places(request, layout, problems)
    return LogFile(request, layout, places, tuple(problems))


def read_log(request: LogRequest, need: Need, *, progress: PartDone | None = None) -> SensorLog:
    """Read the needed columns of a log; see ``LogFile.read``."""
    return open_log(request).read(need, progress=progress)


def _places(request: LogRequest, layout: Layout, problems: list[Problem]) -> dict[str, Place]:
    """Canonical names and those of the file, each with its column."""
    names = layout.names
    where = request.where
    known = (*NUMBER_COLUMNS, *TEXT_COLUMNS)
    mapped: dict[str, int] = {}
    for canonical, column in request.columns.items():
        if canonical not in known:
            place, hint = f"{where}, `columns`", nearest_names(canonical, known)
            expected = "the canonical name of a column"
            problems.append(Problem("there is no such column", place, canonical, expected, hint))
        elif names.count(column) != 1:
            problems.append(_no_column(column, names, f"{where}, `columns` {canonical}"))
        else:
            mapped[canonical] = names.index(column)
    for canonical in known:
        if canonical not in mapped and names.count(canonical) == 1:
            mapped[canonical] = names.index(canonical)
        elif canonical not in mapped and names.count(canonical) > 1:
            problems.append(_no_column(canonical, names, where))
    stated = (*names, *mapped)
    for option, given in (("units", request.units), ("scale", request.scale)):
        place = f"{where}, `{option}`"
        problems += [_no_column(column, names, place) for column in given if column not in stated]
    places = {n: _place(request, n, (names[i], i), problems) for n, i in mapped.items()}
    taken = set(mapped.values())
    for index, name in enumerate(names):
        if index not in taken and names.count(name) == 1 and name not in places:
            places[name] = _place(request, name, (name, index), problems)
    return places


def _suffix(canonical: str) -> str:
    """The end of a canonical name that tells its unit: ``_uT``, ``_m_s2``, ``_arcsec``."""
    ends = ("_uT", "_m_s2", "_rad_s", "_arcsec")
    return next((end for end in ends if canonical.endswith(end)), canonical)


def _no_column(column: str, names: Sequence[str], where: str) -> Problem:
    count = list(names).count(column)
    if count > 1:
        what, hint = said("{number} columns have this name", number=count), "rename one of them"
    else:
        what, hint = "the file has no such column", nearest_names(column, names)
    return Problem(what, where, shown(column), "a column of the file", hint)


def _place(
    request: LogRequest, canonical: str, column: tuple[str, int], problems: list[Problem]
) -> Place:
    name, index = column
    where = f"{request.where}, {name}"
    given = request.units.get(name, request.units.get(canonical))
    scale = request.scale.get(name, request.scale.get(canonical))
    unit = given if given is not None else unit_in_name(name)
    stated = unit is not None or scale is not None
    if unit is not None and unit not in UNITS:
        hint = nearest_names(unit, UNITS)
        problems.append(Problem("this is no known unit", where, unit, "a unit", hint))
        unit = None
    if scale is not None and (not np.isfinite(scale) or scale == 0.0):
        expected = "a number other than 0"
        problems.append(Problem("this is no usable scale", where, f"{scale:g}", expected))
        scale = None
    if canonical not in NUMBER_COLUMNS:
        return Place(index, name, unit or DIMENSIONLESS, scale or 1.0, stated, scale is not None)
    factor = 1.0 if unit is None else factor_to(canonical, unit)
    if factor is None:
        expected = said(
            "a unit of {canonical}, such as {number_columns}",
            canonical=canonical,
            number_columns=NUMBER_COLUMNS[canonical],
        )
        problems.append(Problem("this unit does not fit the column", where, unit or "", expected))
        factor = 1.0
    if unit == COUNTS and scale is None and canonical in SENSOR_COLUMNS and canonical != "output":
        hint = said(
            "`scale` {name}=VALUE, the {number_columns} of one count",
            name=name,
            number_columns=NUMBER_COLUMNS[canonical],
        )
        what = said("{name} is counts without a scale", name=canonical)
        problems.append(Problem(what, where, "LSB", "the value of one count", hint))
    held = unit if canonical == "output" and unit is not None else NUMBER_COLUMNS[canonical]
    return Place(index, name, held, factor * (scale or 1.0), stated, scale is not None)


def _pinned(request: LogRequest, sha256: str) -> list[Problem]:
    if request.sha256 is None or request.sha256.lower() == sha256:
        return []
    hint = "the file was changed or exchanged after it was named; is it the log of this instrument?"
    return [
        Problem(
            "the log is not the one that was pinned", request.where, sha256, request.sha256, hint
        )
    ]
