"""The checks of a project that need its files: rule book, valid ranges of the cards, seals."""

from __future__ import annotations

from pathlib import Path

from surveyapp.core.checks.validity import validity_checks
from surveyapp.core.orientation.whole_project import Orientation
from surveyapp.core.tolerance import measure, rule_book_checks
from surveyapp.domain.project import Project
from surveyapp.domain.results import Check
from surveyapp.domain.rulebook import RuleBook
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.filing.seals import seal_checks
from surveyapp.io.rulebooks import read_rule_book


def project_rule_book(project: Project) -> RuleBook | None:
    """Rule book that a project names, None where it names none.

    Raises
    ------
    SurveyError
        If it does not exist (naming the nearest) or cannot be used.
    """
    if project.rule_book is None:
        return None
    return read_rule_book(project.rule_book, base=Path(project.path))


def project_checks(project: Project, orientation: Orientation) -> tuple[Check, ...]:
    """Checks beyond the statistical ones: valid ranges, seals, the rule book.

    Raises
    ------
    SurveyError
        If the rule book cannot be used.
    """
    book = project_rule_book(project)
    checks = validity_checks(orientation)
    if project.path:
        checks += seal_checks(Path(project.path))
    return checks if book is None else (*checks, *rule_book_checks(book, measure(orientation)))


def changed_after_closing(folder: Path) -> tuple[Problem, ...]:
    """What was changed in a closed project, as problems: for one that can no longer be read."""
    try:
        checks = seal_checks(folder)
    except (SurveyError, OSError, ValueError):
        return ()
    return tuple(
        Problem("the closed project was changed", check.where, check.text, "as it was closed")
        for check in checks
        if check.passed is False and check.confirmed
    )
