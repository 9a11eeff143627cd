"""Sessions that are still being observed: what they lack, and the project without them.

Unfinished is a session whose readings are valid so far and too few for its method. It is left out
with a warning, so that it does not hold up the others. A session with wrong readings is not
unfinished: it stays in, and its error is told. Two turning points of a tracking session give a
pre-orientation, which must enter no mean: among others such a session counts as unfinished.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace
from typing import Final

from surveyapp.core.swing.clamped import LEAST_OF_SCALE, check_rows, number_rows, triples_of
from surveyapp.core.swing.run_points import MIN_POINTS
from surveyapp.core.swing.session import collect_sights, known_target, sight_targets
from surveyapp.domain.project import OrientationSession, Project, Station
from surveyapp.domain.readings import ReadingKind
from surveyapp.domain.subject import Subject
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import SurveyError
from surveyapp.languages import said

CODE: Final = "session_unfinished"


def lacking(session: OrientationSession) -> str:
    """What a session lacks until its method can say anything; empty where it has enough."""
    if session.method == "automatic":
        rounds = session.book.of_kind(ReadingKind.AZIMUTH, ReadingKind.NORTH)
        return "" if rounds else said("no round yet, 1 is the least")
    if session.method == "tracking":
        return _points(session, ReadingKind.REVERSAL, said("turning points"), MIN_POINTS)
    kind, name = ReadingKind.SCALE_REVERSAL, said("turning points on the scale")
    found = _points(session, kind, name, LEAST_OF_SCALE[session.method])
    return found or (_passages(session) if session.method == "transit" else "")


def _points(session: OrientationSession, kind: ReadingKind, name: str, least: int) -> str:
    rows = session.book.of_kind(kind)
    if len(rows) < least:
        return said("{rows} {name}, {least} are the least", rows=len(rows), name=name, least=least)
    missed = bool(session.book.of_kind(ReadingKind.MISSED))
    if missed and len({row.side for row in rows}) < 2:
        return said("{name} of one side only, both are needed", name=name)
    return ""


def _passages(session: OrientationSession) -> str:
    passages = number_rows(session).passages
    if len(passages) < MIN_POINTS:
        return said(
            "{passages} transits, {min_points} are the least",
            passages=len(passages),
            min_points=MIN_POINTS,
        )
    first = passages[0][1].value
    after = [turn for turn, row in passages if row.value == first]
    return "" if triples_of(after) else said("no three transits of one division in a row")


def without_unfinished(project: Project, *, keep: Collection[str] = ()) -> Project:
    """Project without its unfinished sessions, a warning for each.

    Parameters
    ----------
    project : Project
    keep : collection of str
        Ids of sessions that are asked for by name: they stay, and their error is told.

    Returns
    -------
    Project
        Possibly without any session; the same object where nothing is left out. A session that is
        closed and signed stays: nothing more will come.
    """
    stations = {station.name: station for station in project.stations}
    missing = {
        session.id: text
        for session in project.sessions
        if session.id not in keep
        and (text := lacking(session))
        and _valid(session, stations)
        and not project.filing.is_closed(session.id)
    }
    if not missing:
        return project
    kept = tuple(item for item in project.sessions if item.id not in missing)
    warnings = [
        ResultWarning(
            CODE,
            said("session {name} is left out, it is not finished: {text}", name=name, text=text),
            Subject.session(name),
        )
        for name, text in missing.items()
    ]
    return replace(project, sessions=kept, warnings=(*project.warnings, *warnings))


def waiting_sides(whole: Project, kept: Project) -> frozenset[tuple[str, str]]:
    """Sides (station, target) of the sessions that a project was left without."""
    names = {session.id for session in kept.sessions}
    return frozenset(
        (session.station, target)
        for session in whole.sessions
        if session.id not in names
        for target in sight_targets(session)
    )


def _valid(session: OrientationSession, stations: Mapping[str, Station]) -> bool:
    """Whether what was read so far can be right."""
    try:
        known_target(session, stations)
        collect_sights(session)
        if session.method in LEAST_OF_SCALE:
            check_rows(session)
    except SurveyError:
        return False
    return True
