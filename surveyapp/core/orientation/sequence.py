"""The order of sessions: when each took place, before or after the survey."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from surveyapp.core.orientation.instrument_constant import Phase
from surveyapp.domain.project import OrientationSession, Project
from surveyapp.domain.readings import SWING_KINDS


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


def phase_of(key: tuple[float, int], surveys: Sequence[tuple[float, int]]) -> Phase:
    """Tell whether a session stands before, between or after the survey sessions."""
    if not surveys or key < min(surveys):
        return "before"
    return "after" if key > max(surveys) else "between"


@dataclass(frozen=True, slots=True)
class SessionOrder:
    """When the sessions of one instrument took place, and which of them are surveys."""

    keys: Mapping[str, tuple[float, int]]
    surveys: frozenset[str]

    def moment(self, session: str) -> float | None:
        """Abscissa for interpolation, None where nothing tells the moments apart."""
        distinct = len({key[0] for key in self.keys.values()}) > 1
        return self.keys[session][0] if distinct else None

    def block(self, session: str) -> int:
        """Number of survey sessions before a session."""
        return surveys_before(self.keys[session], [self.keys[name] for name in self.surveys])


def surveys_before(key: tuple[float, int], surveys: Sequence[tuple[float, int]]) -> int:
    """Number of survey sessions before a session; calibrations that share it are one block."""
    return sum(other < key for other in surveys)
