"""Where the reading of an SDR file stands: units, station, heights, and what may be lost.

A record that cannot be read takes along what it may have said, until it is said again.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from surveyapp.domain.fieldfile import Pointing
from surveyapp.io.importers.fieldfiles.gathering import Gathering
from surveyapp.io.importers.fieldfiles.sdr_layout import TEXT, Shape
from surveyapp.io.importers.fieldfiles.units import DEGREE
from surveyapp.languages import said


@dataclass(slots=True)
class State:
    """Units of the header and what holds until it is changed."""

    gathered: Gathering
    shape: Shape
    angle: float = DEGREE
    length: float | None = 1.0
    order: str = "NEZ"
    horizon: bool = False
    station: str | None = None
    hi: float | None = None
    setup: int = 0
    lost: str = ""
    ht: float | None = None
    ht_lost: str = ""
    prism: float | None = None
    applied: bool | None = None
    said: set[bool | None] = field(default_factory=set)
    begun: bool = False
    doubt: int = 0
    circle_lost: str = ""
    differs: list[str] = field(default_factory=list)
    negative: list[int] = field(default_factory=list)
    time: str = ""
    opened: str = ""
    faces: set[str] = field(default_factory=set)
    means: list[Pointing] = field(default_factory=list)
    mean_only: list[str] = field(default_factory=list)


def lose(state: State, number: int, kinds: frozenset[str]) -> None:
    """What a torn record may have said holds no more until it is said again."""
    if "01" in kinds and not state.begun:
        state.circle_lost = f"line {number} cannot be read and may tell how zenith angles count"
    if "02" in kinds:
        state.station, state.hi = None, None
        state.lost = f"line {number} cannot be read and may hold the station"
    if "03" in kinds:
        state.ht, state.ht_lost = (
            None,
            f"line {number} cannot be read and may hold the target height",
        )


def blanked(state: State, number: int) -> None:
    """A line of blanks between records: no instrument writes it, a record was wiped out."""
    state.gathered.damaged(number, "the record is blank", "blanks", "two digits, two letters")
    lose(state, number, frozenset(("01", "03")))
    state.doubt = number


def swallowed(state: State, line: str, kind: str) -> frozenset[str]:
    """What a damaged record that is longer than its kind took in with the end of its line."""
    longest = state.shape.lengths.get(kind, state.shape.full(kind) + TEXT)
    return frozenset(("03",)) if len(line) > longest else frozenset()


def constant_applied(state: State) -> bool | None:
    """Whether the prism constant is in the distances after the reduction; None: nobody says.

    The file says it by notes: where it is in some of the distances only, it is added to the others.
    """
    if False in state.said:
        which = "distances" if state.said == {False} else "some of the distances"
        state.gathered.warn(
            "raw_distances",
            said("{which} are stored raw: the prism constant was added", which=which),
        )
    if state.said and None not in state.said:
        return True
    if len(state.said) > 1:
        code, why = (
            "constant_mixed",
            "no note tells of some distances whether the prism constant is in",
        )
    else:
        code, why = (
            "constant_unknown",
            "no note tells whether the prism constant is in the distances",
        )
    state.gathered.warn(code, said("{why}: enter it in [[traverse]]", why=why))
    return None
