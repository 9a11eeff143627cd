"""The survey record that the screens write into a project's results folder."""

from __future__ import annotations

from pathlib import Path

from surveyapp import api
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.guarded import checked_inside, is_regular
from surveyapp.languages import current


def write_record(folder: api.Folder) -> str:
    """Write the record of a project as PDF to its results folder, and return the path.

    Raises
    ------
    SurveyError
        If the project cannot be used or the folder cannot be written to.
    """
    checked_inside(Path(folder), "results/record.pdf", where="results")
    path = Path(folder) / "results"
    try:
        path.mkdir(exist_ok=True)
    except OSError as error:
        what = f"the record cannot be written ({error.strerror or error})"
        raise SurveyError(Problem(what, str(path))) from None
    return str(api.report(folder, path / "record.pdf", language=current()).path)


def record_written(folder: api.Folder) -> bool:
    """Whether a record of the project stands in its results folder."""
    return is_regular(Path(folder) / "results" / "record.pdf")
