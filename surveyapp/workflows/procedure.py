"""The six steps of the procedure: what is done, by whom, with which file, written as it happens."""

from __future__ import annotations

from pathlib import Path

from surveyapp.domain.penetration import STEP_TITLES, ProcedureStep
from surveyapp.domain.project import Project
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.filing.lock import ProjectLock
from surveyapp.io.writing import append_below

CHECKS = 5
"""The step that is repeated: checks of centre line and waist line."""


def record_step(project: Project, step: ProcedureStep) -> None:
    """Append one entry of a step to project.toml.

    Raises
    ------
    SurveyError
        If there is no such step, readings stand at a step that has none, a file does not exist,
        the project holds no breakthrough, is closed or is being written by somebody else.
    """
    folder = Path(project.path)
    problems = _problems(project, step, folder)
    if problems:
        raise SurveyError(problems)
    entry = {
        "id": step.id,
        "done_at": step.done_at,
        "by": step.by,
        "note": step.note or None,
        "file": step.file or None,
        "centre_line_mm": step.centre_line_mm,
        "waist_line_mm": step.waist_line_mm,
    }
    with ProjectLock(folder) as lock:
        if not lock.writable:
            what = "the project is being written by somebody else"
            raise SurveyError(Problem(what, str(folder), "", "", "Close the other program first."))
        append_below(folder / "project.toml", "penetration", "step", entry)


def _problems(project: Project, step: ProcedureStep, folder: Path) -> list[Problem]:
    found = []
    if project.penetration is None:
        what = "the project holds no breakthrough"
        found.append(Problem(what, "project.toml", "no [penetration]", "[penetration]"))
    if project.filing.project_closing is not None:
        hint = "surveyapp reopen DIR opens it again"
        found.append(Problem("the project is closed", str(folder), "", "an open project", hint))
    if not 1 <= step.id <= len(STEP_TITLES):
        found.append(Problem("there is no such step", "done", str(step.id), "1 to 6"))
    if not step.by.strip():
        found.append(Problem("nobody is named", "by", "", "who has done it"))
    readings = (step.centre_line_mm, step.waist_line_mm)
    if step.id != CHECKS and any(value is not None for value in readings):
        what = "readings of centre line and waist line belong to step 5"
        found.append(Problem(what, "done", str(step.id), str(CHECKS)))
    if step.file and not (folder / step.file).is_file():
        what = "the file does not exist"
        found.append(Problem(what, "file", step.file, "a file of the project folder"))
    return found
