"""What no reduction can use in a book, however much is still to come.

Who writes one row asks this before it is written: what more readings would mend (too few points,
one side only, no clamp reading yet) is none of it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial

from surveyapp.core.checks.blunders import refuse_wrong_faces
from surveyapp.core.swing.automatic import rounds_of
from surveyapp.core.swing.clamped import check_rows
from surveyapp.core.swing.gyrofit import LEAST_SQUARES_FROM
from surveyapp.core.swing.run_points import damped_fit, turning_points
from surveyapp.core.swing.session import sight_targets
from surveyapp.core.swing.sights import reduce_sights, zenith_angle
from surveyapp.domain.project import OrientationSession
from surveyapp.domain.readings import FieldBook, ReadingKind
from surveyapp.errors import Problem, SurveyError


def contradictions(session: OrientationSession, book: FieldBook) -> list[Problem]:
    """Problems for which every command would refuse the book of a session.

    Parameters
    ----------
    session : OrientationSession
    book : FieldBook
        Its book as it would stand.

    Returns
    -------
    list of Problem
        Empty for a book that is right as far as it goes.
    """
    found: list[Problem] = []
    for judge in _judges(replace(session, book=book)):
        try:
            judge()
        except SurveyError as error:
            found += error.problems
    return found


def _judges(session: OrientationSession) -> Iterator[Callable[[], object]]:
    for target in sight_targets(session):
        yield partial(_sights, session, target)
        yield partial(zenith_angle, session.book, target, default_target=session.target)
    if session.method == "automatic":
        if session.book.of_kind(ReadingKind.AZIMUTH, ReadingKind.NORTH):
            yield partial(_rounds, session)
    elif session.method == "tracking":
        yield partial(_swing, session)
    else:
        yield partial(check_rows, session)


def _sights(session: OrientationSession, target: str) -> None:
    sights = reduce_sights(session.book, target, default_target=session.target)
    if sights is not None:
        refuse_wrong_faces(session, sights)


def _rounds(session: OrientationSession) -> None:
    if all(session.book.of_kind(kind) for kind in (ReadingKind.AZIMUTH, ReadingKind.NORTH)):
        rounds_of(session, None)


def _swing(session: OrientationSession) -> None:
    rows = session.book.of_kind(ReadingKind.REVERSAL)
    if len(rows) >= LEAST_SQUARES_FROM and len({row.side for row in rows}) > 1:
        damped_fit(session, turning_points(session))
