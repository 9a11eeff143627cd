"""The record in a project's results folder: whether it shows what the project is now."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from surveyapp.domain.project import Project
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import SurveyError
from surveyapp.io.files import read_inside
from surveyapp.io.guarded import is_regular
from surveyapp.languages import said
from surveyapp.report.stamp import stamp_in, stamp_of

RECORD: Final = "results/record.pdf"


def record_written(folder: Path | str) -> bool:
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


def outdated_text() -> str:
    """What is to be done about a record that is out of date."""
    return said(
        "{record} is out of date: surveyapp report DIR -o DIR/{record} makes it again",
        record=RECORD,
    )


def record_warnings(project: Project) -> tuple[ResultWarning, ...]:
    """A warning where the record on the disk is out of date."""
    return (ResultWarning("record_outdated", outdated_text()),) if record_outdated(project) else ()
