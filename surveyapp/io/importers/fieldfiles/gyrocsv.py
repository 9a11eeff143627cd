"""Printouts of automatic gyros as a table: one azimuth a row, with its line, time and sigma.

The azimuth is what the instrument shows: gyro azimuth of the line, its own constant not removed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Final

from surveyapp.domain.fieldfile import SkippedLine
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.importers.fieldfiles.columns import (
    CellError,
    Columns,
    Quantities,
    cells_of,
    check_style,
    find_columns,
    style_of,
)
from surveyapp.io.importers.fieldfiles.gathering import (
    Gathering,
    ReadOptions,
    gathering,
)
from surveyapp.io.importers.fieldfiles.lines import look_through
from surveyapp.languages import said

QUANTITIES: Final = Quantities(
    names=("station", "target", "azimuth", "time", "sigma", "temperature", "note"),
    required=("station", "target", "azimuth"),
    angles=frozenset({"azimuth", "sigma"}),
)


@dataclass(frozen=True, slots=True)
class GyroReading:
    """One azimuth as shown by an automatic gyro.

    Parameters
    ----------
    line : int
    station, target : str
    azimuth : float
        [rad].
    time : str
        ISO 8601, empty where there is none.
    sigma : float or None
        [rad].
    temperature_c : float or None
    note : str
    """

    line: int
    station: str
    target: str
    azimuth: float
    time: str
    sigma: float | None
    temperature_c: float | None
    note: str


@dataclass(frozen=True, slots=True)
class GyroFile:
    """Azimuths of a file in their order."""

    variant: str
    readings: tuple[GyroReading, ...]
    skipped: tuple[SkippedLine, ...]
    warnings: tuple[ResultWarning, ...]


def read_gyro_csv(path: Path, options: ReadOptions) -> GyroFile:
    """Read a table of azimuths.

    Raises
    ------
    SurveyError
        Everything wrong with map and units; every damaged row; no row at all.
    """
    gathered = gathering(path, options)
    table = look_through(path)
    columns = find_columns(table, QUANTITIES, (options.columns, options.units))
    readings: list[GyroReading] = []
    style = style_of(table, columns)
    for number, line in gathered.lines(table):
        if (
            number <= columns.header_line
            or not line.strip(" \t,;|")
            or line.lstrip().startswith("#")
        ):
            continue
        try:
            cells = cells_of(line, columns)
            check_style(cells, style, columns)
            reading = _reading(columns, number, cells)
            if options.wants(number) and gathered.parts.takes(number, ""):
                readings.append(reading)
        except CellError as error:
            gathered.damaged(number, error.args[0], line)
    _refuse(gathered, readings)
    gathered.warn("table_layout", columns.told)
    return GyroFile(
        f"table, {columns.told}",
        tuple(readings),
        tuple(gathered.skipped),
        tuple(gathered.warnings),
    )


def _refuse(gathered: Gathering, readings: list[GyroReading]) -> None:
    if gathered.damage and not gathered.options.skip_damaged:
        raise SurveyError(gathered.damage.problems(gathered.name))
    if gathered.parts.left_out:
        raise SurveyError(gathered.parts.problem(gathered.name))
    if not readings:
        raise SurveyError(Problem("there is no azimuth in the file", gathered.name))


def _time(text: str) -> str:
    if not text:
        return ""
    try:
        datetime.fromisoformat(text)
    except ValueError:
        raise CellError(said("the time is no ISO 8601: {text}", text=text[:40])) from None
    return text


def _reading(columns: Columns, number: int, cells: list[str]) -> GyroReading:
    station, target = columns.text(cells, "station"), columns.text(cells, "target")
    if not station or not target or station == target:
        raise CellError(
            said(
                "a line needs a station and another point: {station!r} to {target!r}",
                station=station,
                target=target,
            )
        )
    azimuth = columns.angle(cells, "azimuth")
    if azimuth is None:
        raise CellError("the azimuth is missing")
    if not 0.0 <= azimuth <= 2.0 * math.pi + 1e-9:
        raise CellError(
            said("the azimuth is beyond the circle: {value}", value=columns.text(cells, "azimuth"))
        )
    sigma = columns.angle(cells, "sigma") if "sigma" in columns.places else None
    if sigma is not None and sigma <= 0.0:
        raise CellError(
            said("the sigma is not positive: {value}", value=columns.text(cells, "sigma"))
        )
    return GyroReading(
        line=number,
        station=station,
        target=target,
        azimuth=math.fmod(azimuth, 2.0 * math.pi),
        time=_time(columns.text(cells, "time")),
        sigma=sigma,
        temperature_c=columns.temperature(cells),
        note=columns.text(cells, "note"),
    )
