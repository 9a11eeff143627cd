"""All records of an instrument for scripts, re-exported by ``surveyapp.api``."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from concurrent.futures import Executor
from pathlib import Path
from typing import TYPE_CHECKING

from surveyapp.api.orientation import generator_of, oriented
from surveyapp.api.project import SOFTWARE, Folder, opened
from surveyapp.domain.project import Project
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.io.project_files import PROJECT_FILE
from surveyapp.languages import said

if TYPE_CHECKING:
    from surveyapp.workflows.pooling import InstrumentDiagnosis, Part, Wanted


def diagnose_instrument(
    source: Project | Folder,
    instrument: str,
    *,
    archive: Sequence[Folder] = (),
    priors: Folder | None = None,
    executor: Executor | None = None,
) -> InstrumentDiagnosis:
    """Diagnose all runs and campaigns of an instrument, in a project and an archive of projects.

    Parameters
    ----------
    source : Project or path
    instrument : str
        Its id in this project.
    archive : sequence of path
        Projects, or folders of projects; the instrument is found in them by its serial.
    priors : path, optional
        Where the priors that the campaigns teach are written.
    executor : Executor, optional
        Of ``concurrent.futures``; one task for each project.

    Raises
    ------
    SurveyError
        If there is no such instrument, an archive holds no project, or nothing can be pooled.
    """
    from dataclasses import replace

    from surveyapp.io.priors import priors_text, write_priors
    from surveyapp.workflows.pooling import Wanted, diagnose_parts

    project = opened(source)
    own = next((item for item in project.instruments if item.id == instrument), None)
    if own is None:
        known = [item.id for item in project.instruments]
        raise SurveyError(
            Problem(
                "there is no instrument of this name",
                "instrument",
                instrument,
                "the name of a known instrument",
                nearest_names(instrument, known),
            )
        )
    wanted = Wanted(own.id, own.serial)
    paths = _projects(project, archive)
    tasks = [(path, wanted) for path in paths]
    parts: Iterable[Part] = (
        map(_part, tasks) if executor is None else executor.map(_part, tasks, chunksize=4)
    )
    found = diagnose_parts(wanted, parts, generator_of(project))
    if priors is None:
        return found
    if found.priors is None:
        raise SurveyError(
            Problem(
                "no campaign teaches any priors",
                "priors",
                instrument,
                "projects with four determinations of its constant",
            )
        )
    text = priors_text(found.priors, instrument=own.id, serial=own.serial, software=SOFTWARE)
    write_priors(Path(priors), text)
    return replace(found, written=str(priors))


def _projects(project: Project, archive: Sequence[Folder]) -> list[str]:
    """Folders of all projects, each once, this one first."""
    found: dict[Path, str] = {}
    if project.path:
        found[Path(project.path).resolve()] = str(project.path)
    problems = []
    for folder in archive:
        path = Path(folder)
        inner = [path] if (path / PROJECT_FILE).is_file() else []
        if not inner and path.is_dir():
            inner = sorted(item.parent for item in path.rglob(PROJECT_FILE))
        if not inner:
            problems.append(
                Problem(
                    "an archive without projects",
                    "archive",
                    str(folder),
                    said(
                        "a project, or a folder with projects ({project_file})",
                        project_file=PROJECT_FILE,
                    ),
                )
            )
        for item in inner:
            found.setdefault(item.resolve(), str(item))
    if problems:
        raise SurveyError(problems)
    return list(found.values())


def _part(task: tuple[str, Wanted]) -> Part:
    """One project; never raises for one that cannot be used."""
    from surveyapp.workflows.pooling import Part, part_of

    path, wanted = task
    try:
        return part_of(path, oriented(path, judged=False).orientation, wanted)
    except SurveyError as error:
        return Part(path, False, left_out=(f"{path}: {error.problems[0]}",))


__all__ = ["diagnose_instrument"]
