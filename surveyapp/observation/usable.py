"""Whether a book with one row more can be used: asked before the row is written."""

from __future__ import annotations

from surveyapp.core.swing.contradictions import contradictions
from surveyapp.domain.project import OrientationSession
from surveyapp.domain.readings import FieldBook, ReadingKind
from surveyapp.errors import Problem
from surveyapp.io.fieldbook.problems import moment_problems


def unusable(
    session: OrientationSession, kind: ReadingKind, book: FieldBook, where: str
) -> list[Problem]:
    """What no command could use in a book; a strike is not asked for more than its moments."""
    found = moment_problems(book, where)
    return found if kind is ReadingKind.STRIKE else [*found, *contradictions(session, book)]
