"""Which pointings belong to one set: grouped as the file says or, where it does not, as observed.

A set holds each target once in each face. A second pointing of a target in the same face opens the
next set; so does one that does not fit: other heights, or a circle that was turned meanwhile.
Nothing is averaged here.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Final

from surveyapp.domain.fieldfile import Face, Pointing
from surveyapp_models.angles import wrap_pi

FACE_LIMIT: Final = math.radians(0.5)
"""Faces that differ by more are no pair: no theodolite in use has such a collimation error, and a
circle is turned between sets by more."""
MOST_OPEN: Final = 8
"""So many sets of a set-up stay open for further pointings."""
_FACES: Final[tuple[Face, ...]] = ("L", "R", "")
_STEEPEST: Final = 0.05
_SAME_HEIGHT_M: Final = 5e-4


@dataclass(slots=True)
class Round:
    """A set as it is gathered; mutable, private to the grouping and the reduction."""

    setup: str
    at: str
    number: int
    stated: str = ""
    sights: dict[tuple[str, Face], Pointing] = field(default_factory=dict)
    turn: float | None = None

    @property
    def name(self) -> str:
        """Unique in the file: set-up and number."""
        return f"{self.setup}/{self.number}"


@dataclass(slots=True)
class _SetUp:
    """The sets of one set-up, and the direction of each target in the circle of the first."""

    rounds: list[Round] = field(default_factory=list)
    stated: dict[str, list[Round]] = field(default_factory=dict)
    directions: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Grouped:
    """Sets in order, and the pointings that opened a set while the one before was not complete."""

    rounds: tuple[Round, ...]
    repeated: tuple[Pointing, ...]


def face_left(pointing: Pointing) -> float | None:
    """Circle reading reduced to face left [rad], None without one."""
    if pointing.hz is None:
        return None
    return pointing.hz - math.pi if pointing.face == "R" else pointing.hz


def group(pointings: Iterable[Pointing]) -> Grouped:
    """Gather pointings into sets.

    Parameters
    ----------
    pointings : iterable of Pointing
        In the order of observation.

    Returns
    -------
    Grouped
        Sets in the order of their first pointing.
    """
    setups: dict[str, _SetUp] = {}
    ordered: list[Round] = []
    repeated: list[Pointing] = []
    for pointing in pointings:
        setup = setups.setdefault(pointing.setup, _SetUp())
        home = _home(setup, pointing)
        if home is None:
            rivals = _rivals(setup, pointing)
            twice = any((pointing.to, pointing.face) in rival.sights for rival in rivals)
            if twice and not _is_complete(rivals[-1]):
                repeated.append(pointing)
            home = Round(pointing.setup, pointing.at, len(setup.rounds) + 1, pointing.set)
            setup.rounds.append(home)
            setup.stated.setdefault(pointing.set, []).append(home)
            ordered.append(home)
        _take(setup, home, pointing)
    return Grouped(tuple(ordered), tuple(repeated))


def _rivals(setup: _SetUp, pointing: Pointing) -> list[Round]:
    """Sets that may still take a pointing: the last ones."""
    return setup.stated.get(pointing.set, [])[-MOST_OPEN:]


def _is_complete(made: Round) -> bool:
    """Whether a set holds every target in both faces: then the next set simply begins."""
    targets = {to for to, _ in made.sights}
    return all((to, face) in made.sights for to in targets for face in ("L", "R"))


def _home(setup: _SetUp, pointing: Pointing) -> Round | None:
    """Latest set that the pointing fits into; of stated sets the first."""
    rivals = _rivals(setup, pointing)
    latest = rivals[-1] if rivals else None
    for candidate in rivals if pointing.set else reversed(rivals):
        if (pointing.to, pointing.face) in candidate.sights:
            continue
        if _fits(setup, candidate, pointing, latest=candidate is latest):
            return candidate
    return None


def _fits(setup: _SetUp, candidate: Round, pointing: Pointing, *, latest: bool) -> bool:
    partners = [
        sight for face in _FACES if (sight := candidate.sights.get((pointing.to, face))) is not None
    ]
    if not all(_same(pointing.hi, p.hi) and _same(pointing.ht, p.ht) for p in partners):
        return False
    if any("" in (pointing.face, p.face) for p in partners):
        return False
    if partners:
        return all(_pair(pointing, partner) for partner in partners)
    reading = face_left(pointing)
    known = setup.directions.get(pointing.to)
    if reading is None or known is None or candidate.turn is None or pointing.set:
        return latest or bool(pointing.set)
    return abs(wrap_pi(reading - known - candidate.turn)) < _limit(pointing)


def _limit(pointing: Pointing) -> float:
    steep = 1.0 if pointing.v is None else max(abs(math.sin(pointing.v)), _STEEPEST)
    return FACE_LIMIT / steep


def _pair(a: Pointing, b: Pointing) -> bool:
    """Whether two pointings of one target in two faces can be one sight."""
    first, second = face_left(a), face_left(b)
    if (
        first is not None
        and second is not None
        and abs(wrap_pi(first - second)) > 2.0 * min(_limit(a), _limit(b))
    ):
        return False
    if a.v is None or b.v is None:
        return True
    return abs(wrap_pi(a.v + b.v)) < 2.0 * FACE_LIMIT


def _same(a: float | None, b: float | None) -> bool:
    if a is None or b is None:
        return a is b
    return abs(a - b) < _SAME_HEIGHT_M


def _take(setup: _SetUp, home: Round, pointing: Pointing) -> None:
    home.sights[pointing.to, pointing.face] = pointing
    reading = face_left(pointing)
    if reading is None:
        return
    known = setup.directions.get(pointing.to)
    if home.turn is None:
        home.turn = 0.0 if known is None else wrap_pi(reading - known)
    if known is None:
        setup.directions[pointing.to] = reading - home.turn
