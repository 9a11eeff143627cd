"""What a strike does: the struck row no longer counts, and the next of its kind takes its place.

Order of work: turning points first, because they decide what stands before and after the
observation; then everything else, whose successor must stand on the same side of it.
"""

from __future__ import annotations

from bisect import bisect_right, insort
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

from surveyapp.core.book.sides import TURNING_KINDS, agreement
from surveyapp.domain.readings import SWING_KINDS, Reading, ReadingKind
from surveyapp.errors import Problem
from surveyapp.languages import said

_PLACED: Final = frozenset({ReadingKind.BACKSIGHT, ReadingKind.ZENITH, ReadingKind.TAPE_ZERO})
_WINDOW: Final = 60
"""Rows before the struck one and after the candidate that are looked at to see left and right."""
_STRIKING: Final = frozenset({ReadingKind.STRIKE, ReadingKind.UNSTRIKE})
_SWING_TURNS: Final = frozenset({ReadingKind.REVERSAL, ReadingKind.SCALE_REVERSAL})


@dataclass(frozen=True, slots=True)
class Struck:
    """One strike that holds: positions in the book of the struck row and of the strike."""

    row: int
    strike: int


def find_strikes(rows: Sequence[Reading], where: str) -> tuple[list[Struck], list[Problem]]:
    """Match every strike that is in force with its row, in the order of the book.

    An ``unstrike`` names a struck row and ends its strike: the row counts again where it stands.
    """
    position = {row.seq: index for index, row in reversed(list(enumerate(rows)))}
    found: dict[int, Struck] = {}
    problems = []
    for index, row in enumerate(rows):
        if row.kind not in _STRIKING or row.strikes is None:
            continue
        struck = position.get(row.strikes)
        back = row.kind is ReadingKind.UNSTRIKE
        what = ""
        if struck is None or struck >= index:
            what = said("a strike names a row that does not stand above it")
        elif rows[struck].kind in _STRIKING:
            what = said(
                "a strike cannot be struck; an unstrike with the seq of the struck row ends it"
            )
        elif back and struck not in found:
            what = said("the row is not struck: there is no strike to take back")
        elif struck in found and not back:
            what = said("the row is struck already")
        if struck is None or what:
            place = said(
                "{where}, line {line} (seq {seq})", where=where, line=row.line, seq=row.seq
            )
            counts = said("is struck") if back else said("still counts")
            expected = said("the seq of an earlier row that {counts}", counts=counts)
            problems.append(Problem(what, place, row.text, expected))
        elif back:
            del found[struck]
        else:
            found[struck] = Struck(struck, index)
    return list(found.values()), problems


def live_rows(rows: Sequence[Reading], strikes: Sequence[Struck]) -> tuple[Reading, ...]:
    """Rows that count, in order of place.

    Parameters
    ----------
    rows : sequence of Reading
        All rows in the order of the book.
    strikes : sequence of Struck
        From ``find_strikes``.

    Returns
    -------
    tuple of Reading
        A successor stands at the place of the row that it replaces; a struck turning point
        without successor stands there as ``missed`` with the seq of the struck row.
    """
    book = _Book(rows, strikes)
    turning = [s for s in strikes if rows[s.row].kind in _SWING_TURNS]
    book.assign(turning)
    book.find_extent()
    book.assign([s for s in strikes if rows[s.row].kind not in _SWING_TURNS])
    return book.live()


class _Book:
    """Who takes whose place."""

    __slots__ = ("by_row", "extent", "heirs", "places", "rows", "strikes")

    def __init__(self, rows: Sequence[Reading], strikes: Sequence[Struck]) -> None:
        self.rows = rows
        self.by_row = {s.row: s for s in strikes}
        self.strikes = sorted(s.strike for s in strikes)
        self.heirs: dict[int, int] = {}  # struck row -> successor
        self.places: dict[int, int] = {}  # successor -> place that it takes
        self.extent: tuple[int, int] | None = None

    def place(self, index: int) -> int:
        """Place at which a row stands."""
        return self.places.get(index, index)

    def find_extent(self) -> None:
        """First and last place of the observation itself."""
        kinds = SWING_KINDS - {ReadingKind.MISSED}
        places = [
            self.place(index)
            for index, row in enumerate(self.rows)
            if row.kind in kinds and (row.kind in _SWING_TURNS or index not in self.by_row)
        ]
        self.extent = (min(places), max(places)) if places else None

    def section(self, index: int) -> int:
        """-1 before the observation, 0 in it, 1 after it."""
        place = self.place(index)
        if self.extent is None or place < self.extent[0]:
            return -1
        return 1 if place > self.extent[1] else 0

    def assign(self, strikes: Sequence[Struck]) -> None:
        """Find successors in the order of the candidates; of two struck rows the earlier first.

        A ``missed`` written below a strike says that the count went on: what is read after it is a
        later turning point, and the struck one has no successor. A passage has one only until the
        next turning point is read or missed: what is timed behind it is a later passage.
        """
        begins = {s.strike: s for s in strikes}
        waiting: dict[ReadingKind, list[Struck]] = {}
        for index, row in enumerate(self.rows):
            if index in begins:
                strike = begins[index]
                kind = self.rows[strike.row].kind
                insort(waiting.setdefault(kind, []), strike, key=lambda s: self.place(s.row))
            elif row.kind is ReadingKind.MISSED and index not in self.by_row:
                for swing in (*_SWING_TURNS, ReadingKind.TRANSIT):
                    waiting.pop(swing, None)
            else:
                if row.kind in _SWING_TURNS and index not in self.by_row:
                    waiting.pop(ReadingKind.TRANSIT, None)
                if row.kind in waiting and index not in self.places:
                    self._offer(index, waiting[row.kind])

    def _offer(self, index: int, waiting: list[Struck]) -> None:
        """Give a candidate to the first struck row that it suits."""
        for strike in tuple(waiting):
            if not self._suits(strike, index):
                continue
            waiting.remove(strike)
            if self.rows[index].kind in TURNING_KINDS and self._contradicts(strike, index):
                continue  # it has no successor at all
            self.heirs[strike.row] = index
            if not self._begins_run(index):
                self.places[index] = self.place(strike.row)
            return

    def _begins_run(self, index: int) -> bool:
        """Whether no turning point above counts.

        Then a row of a wrong kind was struck before the run; its place may lie before the sights.
        """
        return self.rows[index].kind in _SWING_TURNS and not any(
            row.kind in _SWING_TURNS and i not in self.by_row
            for i, row in enumerate(self.rows[:index])
        )

    def _suits(self, strike: Struck, index: int) -> bool:
        struck, heir = self.rows[strike.row], self.rows[index]
        if struck.kind is not heir.kind:
            return False
        if struck.target and heir.target and struck.target != heir.target:
            return False
        if struck.kind is ReadingKind.TRANSIT and self._timed_behind(strike, index):
            return False
        if struck.kind not in _PLACED:
            return True
        if struck.face is not None and heir.face is not None and struck.face is not heir.face:
            return False
        return self.section(strike.row) == self.section(index)

    def _timed_behind(self, strike: Struck, index: int) -> bool:
        """Whether a passage was timed after another that counts below the struck one."""
        heir = self.rows[index]
        return any(
            row.kind is ReadingKind.TRANSIT and i not in self.by_row and _later(heir, row)
            for i, row in enumerate(self.rows[strike.row + 1 : index], start=strike.row + 1)
        )

    def _contradicts(self, strike: Struck, index: int) -> bool:
        """Whether the turning points alternate with the struck row missed, but not replaced."""
        struck, heir = self.rows[strike.row], self.rows[index]
        if struck.side is not None and heir.side is not None:
            return struck.side is not heir.side
        replaced = agreement(self._sequence(strike, index, takes_place=True))
        missed = agreement(self._sequence(strike, index, takes_place=False))
        if missed.labels_fit != replaced.labels_fit:
            return missed.labels_fit
        return missed.margin > max(replaced.margin, 0.0)

    def _sequence(self, strike: Struck, index: int, *, takes_place: bool) -> list[Reading]:
        """The swing up to the next strike after the candidate, under one of two readings."""
        kind = self.rows[index].kind
        section = self.section(index) if kind is ReadingKind.TAPE_ZERO else 0
        begin = max(strike.row - _WINDOW, 0)
        later = bisect_right(self.strikes, index)
        end = min([index + _WINDOW, *self.strikes[later : later + 1]])
        taken: dict[int, Reading] = {}
        for i, row in enumerate(self.rows[begin:end], start=begin):
            counted = row.kind is kind or (
                row.kind is ReadingKind.MISSED and kind is not ReadingKind.TAPE_ZERO
            )
            if not counted or (kind is ReadingKind.TAPE_ZERO and self.section(i) != section):
                continue
            heir_here = i == index and takes_place
            place = self.place(strike.row) if heir_here else self.place(i)
            if place < begin:
                continue
            void = i in self.by_row and i != index
            if void and place in taken:
                continue
            taken[place] = replace(row, value=None, side=None) if void else row
        return [taken[place] for place in sorted(taken)]

    def live(self) -> tuple[Reading, ...]:
        """Rows that count, by place."""
        placed: list[tuple[int, Reading]] = []
        for index, row in enumerate(self.rows):
            if row.kind in _STRIKING:
                continue
            if index not in self.by_row:
                placed.append((self.place(index), row))
            elif row.kind in TURNING_KINDS and index not in self.heirs:
                missed = replace(row, kind=ReadingKind.MISSED, value=None)
                placed.append((self.place(index), missed))
        ordered = [row for _, row in sorted(placed, key=lambda item: item[0])]
        return tuple(_without_late_moments(ordered))


def _later(row: Reading, other: Reading) -> bool:
    """Whether a row was read after another, as far as both have a moment."""
    if row.elapsed_s is not None and other.elapsed_s is not None:
        return row.elapsed_s > other.elapsed_s
    return row.time is not None and other.time is not None and row.time > other.time


def _without_late_moments(rows: Sequence[Reading]) -> list[Reading]:
    """A turning point typed anew behind later ones has no moment: it was read before that."""
    kept = list(rows)
    following: Reading | None = None
    for index in range(len(kept) - 1, -1, -1):
        row = kept[index]
        if row.kind not in _SWING_TURNS:
            continue
        if following is not None and row.seq > following.seq and _later(row, following):
            kept[index] = replace(row, time=None, elapsed_s=None)
        else:
            following = row
    return kept
