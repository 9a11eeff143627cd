"""The survey record that the screens write into a project's results folder."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Final

from surveyapp import api
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.guarded import checked_inside, is_regular
from surveyapp.languages import current, said
from surveyapp.workflows.record_on_disk import (
    RECORD,
    outdated_text,
    record_outdated,
    record_written,
)

__all__ = ["outdated_told", "record_outdated", "record_written", "write_record"]

OLD_S: Final = 600.0
"""A temporary file of this age [s] belongs to nobody any more."""


def write_record(folder: api.Folder) -> str:
    """Write the record of a project as PDF to its results folder, and return the path.

    Raises
    ------
    SurveyError
        If the project cannot be used or the folder cannot be written to.
    """
    checked_inside(Path(folder), RECORD, where="results")
    path = Path(folder) / "results"
    try:
        path.mkdir(exist_ok=True)
    except OSError as error:
        what = said("the record cannot be written ({strerror})", strerror=error.strerror or error)
        raise SurveyError(Problem(what, str(path))) from None
    _take_away_leftovers(path)
    return str(api.report(folder, path / "record.pdf", language=current()).path)


def _take_away_leftovers(results: Path) -> None:
    """Temporary files of a record that was interrupted; a young one may be another program's."""
    now = time.time()
    for item in results.glob(".record.pdf.*.tmp"):
        if is_regular(item) and now - item.stat().st_mtime > OLD_S:
            item.unlink(missing_ok=True)


def outdated_told(folder: api.Folder) -> str:
    """A sentence about a record that a closing or reopening makes out of date; else empty."""
    return outdated_text() if record_written(str(folder)) else ""
