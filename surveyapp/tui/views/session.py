"""The sessions of a project as a table: those of the record, and those that are not done."""

from __future__ import annotations

from surveyapp.core.observing.steps import current_step
from surveyapp.domain.project import Project
from surveyapp.domain.results import OrientationResult
from surveyapp.languages import translated
from surveyapp.report.blocks import Table
from surveyapp.report.sections import reduction
from surveyapp.tui import texts


def session_table(project: Project, result: OrientationResult) -> Table:
    """Each session of the project in one row, also those without a result yet."""
    unit = project.angle_unit
    results = {session.id: session for session in result.sessions}
    whole = project.filing.project_closing is not None
    closed = {item.session for item in project.filing.closings}
    rows: list[tuple[str, ...]] = []
    for item in project.sessions:
        session = results.get(item.id)
        name = texts.CLOSED_MARK.format(id=item.id) if whole or item.id in closed else item.id
        if session is None:
            step = current_step(item.book, item.method)
            rows.append((name, translated(item.method), "", texts.STEP_NAMES[step], "", "", ""))
            continue
        rows.append((name, *reduction.summary_row(session, unit)[1:]))
    return Table(reduction.SUMMARY, tuple(rows), reduction.SUMMARY_ALIGN)
