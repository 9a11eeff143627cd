"""Every shaft of a project oriented; the problems of all come in one error."""

from __future__ import annotations

from surveyapp.core.shafts.orientation import orient_shaft
from surveyapp.domain.project import Project
from surveyapp.domain.shaft_result import ShaftOrientation, ShaftResult
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError


def orient_shafts(project: Project, *, software: str) -> ShaftResult:
    """Orient through every shaft.

    Raises
    ------
    SurveyError
        If there is none, and with every problem of tables, books and networks.
    """
    known = {
        station.name: (station.e, station.n)
        for station in project.stations
        if station.e is not None and station.n is not None and not station.planned
    }
    found: list[ShaftOrientation] = []
    warnings: list[ResultWarning] = list(project.warnings)
    problems: list[Problem] = []
    tables = project.shafts
    if tables is None or not (tables.shafts or tables.problems):
        raise SurveyError(
            Problem(
                "the project holds no shaft",
                "project.toml",
                "no [[shaft]]",
                "[[shaft]] with wires and a book",
                "docs/how-to/orient-through-a-shaft.md shows one",
            )
        )
    if tables.problems:
        raise SurveyError(tables.problems)
    warnings += tables.warnings
    for shaft in tables.shafts:
        try:
            oriented, told = orient_shaft(shaft, known)
        except SurveyError as refused:
            problems += refused.problems
            continue
        found.append(oriented)
        warnings += told
    if problems:
        raise SurveyError(problems)
    return ShaftResult(project.name, software, project.digest, tuple(found), tuple(warnings))
