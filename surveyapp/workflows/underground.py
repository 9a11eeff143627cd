"""What checks look at of a project's breakthrough and shafts: predicted and oriented once.

What is wrong with either keeps nobody from orienting: it becomes the reason why a limit is open.
"""

from __future__ import annotations

from dataclasses import replace

from surveyapp.core.checks.evidence import BreakthroughEvidence, ShaftEvidence
from surveyapp.core.orientation.outcome import outcome
from surveyapp.core.orientation.whole_project import Orientation
from surveyapp.domain.project import Project
from surveyapp.domain.shaft import ShaftTables
from surveyapp.domain.shaft_result import ShaftOrientation
from surveyapp.errors import SurveyError
from surveyapp.languages import joined, said


def breakthrough_evidence(
    orientation: Orientation, project: Project, *, software: str
) -> BreakthroughEvidence | None:
    """The breakthrough of a project with its prediction, without Monte Carlo; None without one."""
    if project.penetration is None:
        return None
    from surveyapp.core.penetration.prediction import drive_length_km, prediction
    from surveyapp.workflows.predicting import ready_mine

    kept = orientation.project
    result = outcome(orientation, (), software=software) if kept.sessions else None
    try:
        ready = ready_mine(kept, result)
        found = prediction(
            ready.mine,
            ready.rule_book,
            project=ready.project,
            software=software,
            digest=ready.digest,
            warnings=ready.warnings,
        )
    except SurveyError as refused:
        return BreakthroughEvidence(project.penetration.plan, refused=_why(refused))
    return BreakthroughEvidence(ready.mine.plan, drive_length_km(ready.mine), found)


def shaft_evidence(project: Project) -> ShaftEvidence | None:
    """Every shaft of a project, oriented by itself; None without one."""
    tables = project.shafts
    if tables is None or not (tables.shafts or tables.problems):
        return None
    from surveyapp.workflows.plumbing import orient_shafts

    if tables.problems:
        why = _why(SurveyError(tables.problems))
        names = [shaft.id for shaft in tables.shafts] or ["shaft"]
        return ShaftEvidence((), tuple((name, why) for name in names))
    found: list[ShaftOrientation] = []
    refused = []
    for shaft in tables.shafts:
        alone = replace(project, shafts=ShaftTables((shaft,)))
        try:
            found += orient_shafts(alone, software="").shafts
        except SurveyError as error:
            refused.append((shaft.id, _why(error)))
    return ShaftEvidence(tuple(found), tuple(refused))


def _why(error: SurveyError) -> str:
    """The first problem, and how many more there are."""
    first, more = error.problems[0], len(error.problems) - 1
    text = joined(": ", (first.where, first.what)) if first.where else first.what
    return said("{text}, and {more} more", text=text, more=more) if more else text
