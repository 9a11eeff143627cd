"""What the screens for files of other programs ask: which files lie there, what one says, take it.

Options are told in one line, ``key=value`` each, as a surveyor would tell them on the command line:
``traverse=main station-code=21 fix=A,B at=Stn hz=HA unit.hz=gon skip-damaged``.
"""

from __future__ import annotations

import os
import shlex
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from surveyapp import api
from surveyapp.domain.fieldfile import ImportResult
from surveyapp.domain.filing import ExportResult
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.exporters.catalogue import EXPORTERS
from surveyapp.io.importers.fieldfiles.catalogue import IMPORTERS
from surveyapp.io.importers.fieldfiles.parts import line_range
from surveyapp.languages import said

GYRO: Final = "gyro-csv"
_MOST: Final = 400
"""So many entries of a folder are listed."""


@dataclass(frozen=True, slots=True)
class Entry:
    """A folder, or a file that may be a field file.

    Parameters
    ----------
    name : str
        Ends in ``/`` for a folder.
    path : str
    format : str
        By its ending; empty for a folder.
    kilobytes : float
    """

    name: str
    path: str
    format: str = ""
    kilobytes: float = 0.0


@dataclass(frozen=True, slots=True)
class Told:
    """Options of an import as they were told in one line."""

    traverse: str | None = None
    station_code: str | None = None
    instrument: str | None = None
    fixed: tuple[str, ...] = ()
    columns: dict[str, str] = field(default_factory=dict)
    units: dict[str, str] = field(default_factory=dict)
    skip_damaged: bool = False
    lines: tuple[int, int] | None = None


def entries(folder: str) -> list[Entry]:
    """Folders and field files of a folder, folders first.

    Raises
    ------
    SurveyError
        If it cannot be read.
    """
    endings = {ending: item.id for item in reversed(IMPORTERS) for ending in item.endings}
    folders, files = [Entry("../", str(Path(folder).absolute().parent))], []
    try:
        with os.scandir(folder) as found:
            for item in sorted(found, key=lambda entry: entry.name.casefold()):
                if item.name.startswith("."):
                    continue
                if item.is_dir():
                    folders.append(Entry(f"{item.name}/", item.path))
                elif (ending := Path(item.name).suffix.lower()) in endings and item.is_file():
                    size = item.stat().st_size / 1000.0
                    files.append(Entry(item.name, item.path, endings[ending], size))
    except OSError as error:
        raise SurveyError(
            Problem(
                said("the folder cannot be read ({strerror})", strerror=error.strerror or error),
                folder,
            )
        ) from None
    return [*folders, *files][:_MOST]


def told_options(text: str) -> Told:
    """Options from one line.

    Raises
    ------
    SurveyError
        For what is no ``key=value``.
    """
    values: dict[str, str] = {}
    columns, units = {}, {}
    skip = False
    try:
        words = shlex.split(text)
    except ValueError as error:
        raise SurveyError(
            Problem(said("a quote is open ({error})", error=error), "options", text)
        ) from None
    for word in words:
        key, sign, value = word.partition("=")
        if word == "skip-damaged":
            skip = True
        elif not sign or not value:
            expected = said("key=value, such as traverse=main or unit.hz=gon")
            raise SurveyError(Problem(said("this is no option"), "options", word, expected))
        elif key in ("traverse", "station-code", "instrument", "fix", "lines"):
            values[key] = value
        elif key.startswith("unit."):
            units[key.removeprefix("unit.")] = value
        else:
            columns[key] = value
    return Told(
        traverse=values.get("traverse"),
        station_code=values.get("station-code"),
        instrument=values.get("instrument"),
        fixed=tuple(filter(None, values.get("fix", "").split(","))),
        columns=columns,
        units=units,
        skip_damaged=skip,
        lines=line_range(values.get("lines"), "lines"),
    )


def bring(
    entry: Entry,
    folder: str,
    options: str,
    *,
    preview: bool,
    progress: Callable[[float], None] | None = None,
) -> ImportResult:
    """Preview a field file, or take it into the project.

    Parameters
    ----------
    entry : Entry
    folder, options : str
    preview : bool
    progress : callable or None
        Told which part of the file has been read, 0 to 1.

    Raises
    ------
    SurveyError
        As ``surveyapp.api.import_file``.
    """
    told = told_options(options)
    form = GYRO if entry.format == "csv" and "azimuth" in told.columns else entry.format
    return api.import_file(
        form,
        entry.path,
        folder,
        traverse=told.traverse,
        instrument=told.instrument,
        station_code=told.station_code,
        columns=told.columns,
        units=told.units,
        fixed=told.fixed,
        skip_damaged=told.skip_damaged,
        lines=told.lines,
        preview=preview,
        progress=progress,
    )


def export_formats() -> dict[str, str]:
    """Every format of an export and what it is."""
    return {item.id: item.title for item in EXPORTERS}


def export_path(folder: str, form: str) -> str:
    """Where an export goes unless something else is said: beside the project."""
    endings = {item.id: item.ending for item in EXPORTERS}
    place = Path(folder).resolve()
    return str(place.parent / f"{place.name}{endings.get(form, f'.{form}')}")


def hand_over(form: str, folder: str, path: str) -> ExportResult:
    """Write an export; a file that is there is never written over.

    Raises
    ------
    SurveyError
        If the file exists, or as the exports of ``surveyapp.api``.
    """
    if Path(path).exists():
        raise SurveyError(
            Problem(said("a file of this name exists"), path, "", said("a name that is free"))
        )
    others: dict[str, Callable[[str, str], ExportResult]]
    others = {
        "csv": api.export_csv,
        "gkf": api.export_gkf,
        "json": api.export_json,
        "zip": api.export_zip,
    }
    if form in others:
        return others[form](folder, path)
    return api.export_survey(form, folder, path)
