"""A log into a project from one line of options: a preview first, then one key takes it."""

from __future__ import annotations

import os
from datetime import date
from pathlib import Path
from typing import Any, Final

from surveyapp import api
from surveyapp.domain.log_preview import LogPreview
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said
from surveyapp.observation.exchange import Entry
from surveyapp.observation.sensors.options import told_options

ENDINGS: Final = (".csv", ".txt", ".tsv", ".dat", ".log", ".asc")
_MOST: Final = 400


def log_entries(folder: str) -> list[Entry]:
    """Folders and files that may be a log, folders first.

    Raises
    ------
    SurveyError
        If the folder cannot be read.
    """
    folders, files = [Entry("../", str(Path(folder).absolute().parent))], []
    try:
        with os.scandir(folder) as found:
            for item in sorted(found, key=lambda entry: entry.name.casefold()):
                if item.name.startswith("."):
                    continue
                if item.is_dir():
                    folders.append(Entry(f"{item.name}/", item.path))
                elif Path(item.name).suffix.lower() in ENDINGS and item.is_file():
                    size = item.stat().st_size / 1000.0
                    files.append(Entry(item.name, item.path, "log", size))
    except OSError as error:
        raise SurveyError(
            Problem(
                said("the folder cannot be read ({strerror})", strerror=error.strerror or error),
                folder,
            )
        ) from None
    return [*folders, *files][:_MOST]


def look_at(entry: Entry, options: str) -> LogPreview:
    """What would be understood of a log.

    Raises
    ------
    SurveyError
        For options that are none, and for a file that cannot be opened.
    """
    return api.preview_sensor_log(entry.path, log=told_options("add", options).log)


def take(folder: str, entry: Entry, options: str) -> LogPreview:
    """Take a log into the project.

    Raises
    ------
    SurveyError
        With everything that is wrong; nothing is written then.
    """
    told = told_options("add", options)
    own: dict[str, Any] = dict(told.own)
    day = own.pop("day", None)
    return api.add_sensor_log(
        folder,
        entry.path,
        identity=str(own.pop("id", "")),
        kind=own.pop("kind", None),
        log=told.log,
        programme=own.pop("programme", None),
        instrument=own.pop("instrument", None),
        serial=own.pop("serial", None),
        latitude_deg=own.pop("latitude", None),
        calibrated_on=None if day is None else _day(str(day)),
        options=own,
    )


def _day(text: str) -> date:
    try:
        return date.fromisoformat(text)
    except ValueError:
        raise SurveyError(
            Problem("this is no day", "options, day", text, "as 2026-03-01")
        ) from None
