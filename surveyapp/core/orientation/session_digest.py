"""The digest of what sessions observed: whether the data that chose an effect are still the same.

Notes, observers and the order of tables are not data. Nothing here reads a file.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence

from surveyapp.domain.project import OrientationSession, Project, Station
from surveyapp.domain.readings import Reading, ReadingKind

RUN_KINDS = frozenset(
    {
        ReadingKind.REVERSAL,
        ReadingKind.MISSED,
        ReadingKind.TAPE_ZERO,
        ReadingKind.TEMPERATURE,
    }
)
"""What a run is diagnosed from; its sights may come later."""


def sessions_digest(project: Project, names: Sequence[str], *, run: bool) -> str | None:
    """Sha256 of the data of some sessions; None where not all of them are in the project.

    Parameters
    ----------
    project : Project
    names : sequence of str
        Ids; their order does not matter.
    run : bool
        Whether turning points were diagnosed, and not gyro azimuths of known lines.
    """
    sessions = {session.id: session for session in project.sessions}
    stations = {station.name: station for station in project.stations}
    if not names or any(name not in sessions for name in names):
        return None
    digest = hashlib.sha256()
    for name in sorted(set(names)):
        session = sessions[name]
        parts = [name, session.instrument, _number(session.resolution)]
        parts.append(_number(session.reference_temperature_c))
        if not run:
            parts += _place(session, stations)
        kept = [row for row in session.book.live if _counts(row, run=run)]
        lines = ["|".join(parts), *("|".join(_reading(row)) for row in kept)]
        digest.update("\n".join(lines).encode() + b"\x00")
    return digest.hexdigest()


def _counts(row: Reading, *, run: bool) -> bool:
    return row.kind in RUN_KINDS if run else row.kind is not ReadingKind.NOTE


def _place(session: OrientationSession, stations: dict[str, Station]) -> list[str]:
    """What a determination of the constant depends on beside its book."""
    parts = [
        session.station,
        session.target or "",
        session.purpose,
        _number(session.azimuth_known),
        str(session.date),
        _number(session.order),
        repr(session.eccentric),
    ]
    for name in (session.station, session.target):
        at = stations.get(name or "")
        if at is not None:
            parts += [_number(v) for v in (at.e, at.n, at.latitude, at.longitude)]
    return parts


def _reading(row: Reading) -> tuple[str, ...]:
    return (
        row.kind.value,
        _number(row.value),
        "" if row.time is None else repr(row.time.timestamp()),
        _number(row.elapsed_s),
        row.face or "",
        row.side or "",
        row.target,
        _number(row.temperature_c),
    )


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:.12g}"
