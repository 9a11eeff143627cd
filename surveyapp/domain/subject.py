"""What a check, a warning or a determination is about: a value to compare, never a text to parse.

The texts that people read (``where``, ``label``) are printed from it; nothing is looked up by them.
A station's name may contain any character, so a line is its two stations and not ``A-B``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from surveyapp.languages import said

SubjectKind = Literal[
    "project",
    "session",
    "line",
    "side",
    "instrument",
    "station",
    "traverse",
    "penetration",
    "shaft",
    "sensor",
    "ledger",
]
"""``line``: a line as one instrument oriented it; ``side``: two stations, whoever sighted them."""


SubjectKeyword = Literal["session", "campaign", "traverse", "sensor"]
"""Under which ``diagnose`` takes the id of what is to be diagnosed."""


@dataclass(frozen=True, slots=True)
class Subject:
    """One thing of a project.

    Parameters
    ----------
    kind : str
    id : str
        Of a session, instrument, station, traverse or sensor its own id; of a line and a side
        ``station-target`` for people: what tells them apart are the fields below.
    station, target : str
        Of a line or a side; of a session the target that is meant, where one is.
    instrument : str
        Of a line.
    """

    kind: SubjectKind
    id: str = ""
    station: str = ""
    target: str = ""
    instrument: str = ""

    @classmethod
    def project(cls) -> Subject:
        """The project as a whole."""
        return cls("project")

    @classmethod
    def session(cls, identity: str, target: str = "") -> Subject:
        """A session, or one of its targets."""
        return cls("session", identity, target=target)

    @classmethod
    def line(cls, station: str, target: str, instrument: str) -> Subject:
        """A line that one instrument oriented; A-B and B-A are two."""
        return cls("line", f"{station}-{target}", station, target, instrument)

    @classmethod
    def side(cls, station: str, target: str) -> Subject:
        """Two stations that see each other, whatever measured between them."""
        return cls("side", f"{station}-{target}", station, target)

    @classmethod
    def of(cls, kind: SubjectKind, identity: str) -> Subject:
        """Anything that has an id of its own: an instrument, a station, a traverse."""
        return cls(kind, identity)

    @property
    def text(self) -> str:
        """For people: ``run 2 to 3082``, ``3083-3082``, ``G1``."""
        if not self._one_target:
            return self.id
        return said("{id} to {target}", id=self.id, target=self.target)

    @property
    def _one_target(self) -> bool:
        return self.kind == "session" and bool(self.target)

    def to_dict(self) -> dict[str, str | None]:
        """Keys of the JSON; null where the kind has no such part."""
        return {
            "kind": self.kind,
            "id": self.id,
            "station": self.station or None,
            "target": self.target or None,
            "instrument": self.instrument or None,
        }
