"""The order of sessions: when each took place, before or after the survey."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Mapping
from dataclasses import dataclass

from surveyapp.core.orientation.instrument_constant import Phase
from surveyapp.domain.project import OrientationSession, Project
from surveyapp.domain.readings import SWING_KINDS
from surveyapp.domain.subject import Subject
from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import said


def session_moments(project: Project, instrument: str) -> dict[str, tuple[float, int]]:
    """When each session of an instrument took place: comparable keys, ties in file order.

    Times if every session has them, else dates, else ``order``, else the order of the file.
    """
    own = [session for session in project.sessions if session.instrument == instrument]
    stamps = {session.id: session_timestamp(session) for session in own}
    if any(stamp is None for stamp in stamps.values()):
        stamps = {s.id: None if s.date is None else s.date.toordinal() * 86400.0 for s in own}
        if len(set(stamps.values())) == 1 and all(s.order is not None for s in own):
            stamps = {session.id: session.order for session in own}
    if any(stamp is None for stamp in stamps.values()):
        stamps = {session.id: session.order for session in own}
    if any(stamp is None for stamp in stamps.values()):
        stamps = {session.id: 0.0 for session in own}
    return {
        session.id: (stamp if (stamp := stamps[session.id]) is not None else 0.0, place)
        for place, session in enumerate(own)
    }


def session_timestamp(session: OrientationSession) -> float | None:
    """Mean moment of the observation [s since 1970 UTC], None where its rows carry no time."""
    rows = session.book.live
    stamps = [row.time.timestamp() for row in rows if row.kind in SWING_KINDS and row.time]
    return sum(stamps) / len(stamps) if stamps else None


def date_warnings(session: OrientationSession) -> list[ResultWarning]:
    """A date of the session beside other times in its book: one of them is a slip.

    A night shift and a clock of another zone make a day.
    """
    booked = session.book_day
    if session.date is None or booked is None or abs((session.date - booked).days) <= 1:
        return []
    text = said(
        "session {id}: its date is {date}, but its book begins on {booked}: the order of sessions "
        "and drifts take the book, due dates take the date; correct the one that is wrong",
        id=session.id,
        date=session.date.isoformat(),
        booked=booked.isoformat(),
    )
    return [ResultWarning("session_date_differs", text, Subject.session(session.id))]


@dataclass(frozen=True, slots=True)
class SessionOrder:
    """When the sessions of one instrument took place, and which of them are surveys.

    Parameters
    ----------
    keys : mapping
        Comparable key of each session.
    surveys : tuple of keys
        Those of the survey sessions, sorted.
    distinct : bool
        Whether anything tells the moments apart.
    """

    keys: Mapping[str, tuple[float, int]]
    surveys: tuple[tuple[float, int], ...]
    distinct: bool

    @classmethod
    def of(cls, project: Project, instrument: str) -> SessionOrder:
        """Order of the sessions of one instrument."""
        keys = session_moments(project, instrument)
        surveys = sorted(
            keys[session.id]
            for session in project.sessions
            if session.instrument == instrument and session.purpose == "survey"
        )
        distinct = len({key[0] for key in keys.values()}) > 1
        return cls(keys, tuple(surveys), distinct)

    def moment(self, session: str) -> float | None:
        """Abscissa for interpolation, None where nothing tells the moments apart."""
        return self.keys[session][0] if self.distinct else None

    def block(self, session: str) -> int:
        """Number of survey sessions before a session; calibrations that share it are one block."""
        return bisect_left(self.surveys, self.keys[session])

    def phase(self, session: str) -> Phase:
        """Whether a session stands before, between or after the survey sessions."""
        key = self.keys[session]
        if not self.surveys or key < self.surveys[0]:
            return "before"
        return "after" if key > self.surveys[-1] else "between"
