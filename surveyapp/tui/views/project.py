"""The pages of a project: their rows, and what is known of one, from the blocks of the record."""

from __future__ import annotations

from surveyapp.domain.project import Project
from surveyapp.domain.results import OrientationResult
from surveyapp.report.blocks import Block, Paragraph, Table
from surveyapp.report.sections import azimuths, checks, reduction
from surveyapp.tui import texts
from surveyapp.tui.views.session import session_table

EMPTY: dict[str, str] = {
    "sessions": texts.NO_SESSIONS,
    "lines": texts.NO_LINES,
    "checks": texts.NO_CHECK_ROWS,
    "warnings": texts.NO_WARNINGS,
}
"""What each page that is a list says without rows."""


def page_tables(project: Project, result: OrientationResult) -> dict[str, Table]:
    """The table of each page that is a list."""
    codes = tuple((warning.code,) for warning in result.warnings)
    return {
        "sessions": session_table(project, result),
        "lines": azimuths.summary(project, result),
        "checks": checks.table(result.checks),
        "warnings": Table((texts.COL_WARNING,), codes),
    }


def details_of(
    project: Project, result: OrientationResult, page: str, row: int
) -> tuple[Block, ...]:
    """Details of a row of the page of sessions, lines, checks or warnings."""
    if page == "sessions":
        wanted = project.sessions[row].id
        for session in result.sessions:
            if session.id == wanted:
                return reduction.session_blocks(project, session)
        return (Paragraph(texts.BEING_OBSERVED),)
    if page == "lines":
        return azimuths.line_blocks(project, result.lines[row])
    if page == "checks":
        return checks.details(checks.ordered(result.checks)[row])
    return (Paragraph(result.warnings[row].text),)
