"""Stations as they are typed or pasted into a form: one a line, in the order of a first line."""

from __future__ import annotations

import csv
import io
import re
from collections import Counter
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from surveyapp.errors import Problem, SurveyError
from surveyapp.io.decimals import typed_number
from surveyapp.languages import counted, said

_DECIMAL: Final = re.compile(r"[+-]?\d+(?:[.,]\d+)?")


@dataclass(frozen=True, slots=True)
class NewStation:
    """A station as typed; what is empty stays away."""

    name: str
    e: float | None = None
    n: float | None = None
    lat: float | None = None
    lon: float | None = None
    h: float | None = None


def read_stations(text: str) -> tuple[NewStation, ...]:
    """Stations from typed or pasted text.

    Parameters
    ----------
    text : str
        One station a line: name, east, north, and perhaps height, separated by commas, semicolons,
        tabs or blanks. A first line that names the columns (name, e, n, lat, lon, h) decides their
        order; with lat and lon, degrees are meant. Or the path of such a CSV file alone.

    Raises
    ------
    SurveyError
        With every line that makes no sense.
    """
    if len(text.split("\n")) == 1 and text.strip().lower().endswith((".csv", ".txt")):
        from surveyapp.io.files import read_text

        path = Path(text.strip()).expanduser()
        text = read_text(path, where=path.name)
    columns = ["name", "e", "n", "h"]
    stations: list[NewStation] = []
    problems: list[Problem] = []
    for number, line in enumerate(text.splitlines(), start=1):
        cells = _cells(line)
        if not cells:
            continue
        lowered = [cell.lower() for cell in cells]
        if not stations and "name" in lowered:
            columns = lowered
            continue
        try:
            stations.append(_station(cells, columns))
        except ValueError as error:
            place = said("stations, line {number}", number=number)
            expected, hint = "name, east, north, height", error.args[0]
            problems.append(Problem("this is no station", place, line.strip(), expected, hint))
    counts = Counter(station.name for station in stations)
    problems += [
        Problem(said("a station stands twice"), "stations", name, said("each name once"))
        for name in sorted(name for name, count in counts.items() if count > 1)
    ]
    if problems:
        raise SurveyError(problems)
    return tuple(stations)


def _cells(line: str) -> list[str]:
    words = line.split()
    if len(words) > 2 and ";" not in line and all(_DECIMAL.fullmatch(word) for word in words[1:]):
        return words  # blanks separate, and a comma within a number is its decimal sign
    for separator in (";", "\t", ","):
        if separator in line:
            with suppress(csv.Error):
                row = next(csv.reader(io.StringIO(line.strip()), delimiter=separator), [])
                return [cell.strip() for cell in row]
            return [line, line]  # which is no number, as is said
    return line.split()


def _station(cells: list[str], columns: list[str]) -> NewStation:
    row = dict(zip(columns, cells, strict=False))
    name = row.get("name", "")
    if not name:
        raise ValueError(said("the name is missing"))
    if any(cells[len(columns) :]):
        raise ValueError(
            counted(
                "more values than its {count} column; decimal commas need semicolons between them",
                "more values than its {count} columns; decimal commas need semicolons between them",
                count=len(columns),
            )
        )
    known = ("e", "n", "lat", "lon", "h")
    numbers = {key: typed_number(row[key]) for key in known if row.get(key)}
    pairs = (("e", "n"), ("lat", "lon"))
    for first, second in pairs:
        if (first in numbers) != (second in numbers):
            raise ValueError(
                said("{first} and {second} belong together", first=first, second=second)
            )
    return NewStation(name, **numbers)
