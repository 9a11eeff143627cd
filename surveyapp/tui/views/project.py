"""The pages of a project: their rows, and what is known of one."""

from __future__ import annotations

from rich.text import Text

from surveyapp.domain.project import Project
from surveyapp.domain.results import OrientationResult
from surveyapp.languages import shown
from surveyapp.tui import texts
from surveyapp.tui.views.checks import CHECK_COLUMNS, check_rows, check_texts
from surveyapp.tui.views.lines import LINE_COLUMNS, budget_rows, chain_rows, helps_text, line_rows
from surveyapp.tui.views.session import SESSION_COLUMNS, session_details, session_rows
from surveyapp.tui.widgets.records import pairs_text, table_text

LISTS: dict[str, tuple[tuple[str, ...], str]] = {
    "sessions": (SESSION_COLUMNS, texts.NO_SESSIONS),
    "lines": (LINE_COLUMNS, texts.NO_LINES),
    "checks": (CHECK_COLUMNS, texts.NO_CHECK_ROWS),
    "warnings": ((texts.COL_WARNING,), texts.NO_WARNINGS),
}
"""Columns of each page that is a list, and what it says without rows."""


def page_rows(project: Project, result: OrientationResult) -> dict[str, list[tuple[str, ...]]]:
    """Rows of each page that is a list."""
    return {
        "sessions": session_rows(project, result),
        "lines": line_rows(result, project.angle_unit),
        "checks": check_rows(result),
        "warnings": [(warning.code,) for warning in result.warnings],
    }


def details_of(project: Project, result: OrientationResult, page: str, row: int) -> Text:
    """Details of a row of the page of sessions, lines, checks or warnings."""
    if page == "sessions":
        return _session(project, result, project.sessions[row].id)
    if page == "lines":
        return _line(project, result, row)
    if page == "checks":
        return Text(check_texts(result)[row])
    return Text(shown(result.warnings[row].text))


def _session(project: Project, result: OrientationResult, wanted: str) -> Text:
    for session in result.sessions:
        if session.id == wanted:
            return pairs_text(session_details(session, project.angle_unit))
    return Text(texts.BEING_OBSERVED)


def _line(project: Project, result: OrientationResult, row: int) -> Text:
    line = result.lines[row]
    text = table_text(chain_rows(project, line), left=(0, 3))
    head = (texts.D_BUDGET, texts.COL_SIGMA, texts.D_SHARE)
    text.append("\n").append_text(table_text([head, *budget_rows(line)]))
    return text.append(helps_text(line))
