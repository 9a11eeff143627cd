"""The survey record that the screens write into a project's results folder."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Final

from surveyapp import api
from surveyapp.domain.project import Project
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.files import read_inside
from surveyapp.io.guarded import checked_inside, is_regular
from surveyapp.languages import current, said
from surveyapp.report.stamp import stamp_in, stamp_of

RECORD: Final = "results/record.pdf"
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


def record_written(folder: api.Folder) -> bool:
    """Whether a record of the project stands in its results folder."""
    return is_regular(Path(folder) / RECORD)


def record_outdated(project: Project) -> bool:
    """Whether the record in the results folder shows another state than the project has now.

    Compared are the sha256 of everything that was read and the closings in force.
    """
    folder = Path(project.path)
    if not record_written(folder):
        return False
    try:
        data = read_inside(folder, RECORD, where=RECORD)
    except SurveyError:
        return True
    now = stamp_of(project.digest, [item.head for item in project.filing.closings])
    return stamp_in(data) != now


def outdated_told(folder: api.Folder) -> str:
    """A sentence about a record that a closing or reopening makes out of date; else empty."""
    if not record_written(folder):
        return ""
    return said(
        "{record} is out of date: surveyapp report DIR -o DIR/{record} makes it again",
        record=RECORD,
    )
