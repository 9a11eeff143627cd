"""What a new session begins with: a free id, and station, target and instrument of the last one."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from surveyapp.domain.project import Method, OrientationSession, Project, Purpose
from surveyapp.observation.home import OBSERVATIONS

_NUMBERED: Final = re.compile(r"(.*?)(\d+)")
_FIRST: Final = "r1"


@dataclass(frozen=True, slots=True)
class Proposal:
    """Values that the form for a new session begins with; empty where nothing is known."""

    id: str = _FIRST
    station: str = ""
    target: str = ""
    instrument: str = ""
    method: Method = "tracking"
    purpose: Purpose = "survey"


def propose_session(project: Project) -> Proposal:
    """The next session as it most often is: the last one once more, under the next free id."""
    last = project.sessions[-1] if project.sessions else None
    used = {item.id for item in project.sessions}
    books = {Path(item.book_path).stem for item in project.sessions}
    if last is None:
        return Proposal(_free(project, _FIRST, used | books))
    return Proposal(
        id=_free(project, _begin(last), used | books),
        station=last.station,
        target=last.target or "",
        instrument=last.instrument,
        method=last.method,
        purpose=last.purpose,
    )


def _begin(last: OrientationSession) -> str:
    """The id to count on from: digits that belong to the name of a station are no number."""
    names = [name for name in (last.target, last.station) if name]
    if _NUMBERED.fullmatch(last.id) is None or any(last.id.endswith(name) for name in names):
        return f"{last.id}-2"
    return last.id


def _free(project: Project, identity: str, used: set[str]) -> str:
    while identity in used or (Path(project.path) / OBSERVATIONS / f"{identity}.csv").exists():
        match = _NUMBERED.fullmatch(identity)
        if match is None:
            identity = f"{identity}-2"
        else:
            identity = f"{match[1]}{int(match[2]) + 1:0{len(match[2])}d}"
    return identity
