"""The pages of a project: their rows, and what is known of one, from the blocks of the record."""

from __future__ import annotations

from rich.text import Text

from surveyapp.domain.project import Project
from surveyapp.domain.results import OrientationResult
from surveyapp.languages import shown
from surveyapp.report.sections import azimuths, checks, reduction
from surveyapp.tui import texts
from surveyapp.tui.views.blocks import blocks_as_text
from surveyapp.tui.views.session import session_rows

LISTS: dict[str, tuple[tuple[str, ...], str]] = {
    "sessions": (reduction.SUMMARY, texts.NO_SESSIONS),
    "lines": (azimuths.SUMMARY, texts.NO_LINES),
    "checks": (checks.HEAD, texts.NO_CHECK_ROWS),
    "warnings": ((texts.COL_WARNING,), texts.NO_WARNINGS),
}
"""Columns of each page that is a list, and what it says without rows."""


def page_rows(project: Project, result: OrientationResult) -> dict[str, list[tuple[str, ...]]]:
    """Rows of each page that is a list."""
    return {
        "sessions": session_rows(project, result),
        "lines": list(azimuths.summary(project, result).rows),
        "checks": [checks.row(check) for check in checks.ordered(result.checks)],
        "warnings": [(warning.code,) for warning in result.warnings],
    }


def details_of(
    project: Project, result: OrientationResult, page: str, row: int, *, width: int
) -> Text:
    """Details of a row of the page of sessions, lines, checks or warnings."""
    if page == "sessions":
        wanted = project.sessions[row].id
        for session in result.sessions:
            if session.id == wanted:
                return blocks_as_text(reduction.session_blocks(project, session), width)
        return Text(texts.BEING_OBSERVED)
    if page == "lines":
        return blocks_as_text(azimuths.line_blocks(project, result.lines[row]), width)
    if page == "checks":
        return Text(shown(checks.details(checks.ordered(result.checks)[row])))
    return Text(shown(result.warnings[row].text))
