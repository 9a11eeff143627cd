"""What is to be read next, and what a typed text means there: entry without a screen.

A text becomes a row of the field book here, with the doubts that are to be asked about before it is
written. Nothing is written here.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace
from datetime import datetime
from typing import Final

from surveyapp.core.observing.doubts import Question
from surveyapp.core.observing.progress import Progress
from surveyapp.core.observing.retyped import Placed, open_strike, place_in_swing, seconds_between
from surveyapp.core.observing.steps import Expected, Step, kinds_of, next_sight
from surveyapp.core.observing.typed_rows import (
    EntryError,
    complete_angle,
    complete_number,
    plain_signs,
)
from surveyapp.domain.readings import (
    QUANTITY,
    Dimension,
    Face,
    FieldBook,
    Reading,
    ReadingKind,
    Side,
)
from surveyapp.io.fieldbook.clock import Stamp
from surveyapp.languages import said
from surveyapp.observation.doubts import TURNING, Typed, of_this_book, questions_about, sights_of
from surveyapp.observation.session import NewRow, SessionDesk
from surveyapp_models.angles import wrap_two_pi

PACKED: Final = "packed"
LARGEST: Final = {
    Dimension.DIVISIONS: ("div", 1000.0),
    Dimension.TILT: ("arcsec", 36000.0),
    Dimension.TEMPERATURE: ("C", 100.0),
    Dimension.SUPPLY: ("V", 1e5),
}
"""Unit and largest possible magnitude of what is no angle."""
_SUPPLY: Final = re.compile(r"(.*?)\s*(mA|Hz|V|мА|Гц|В)?", re.IGNORECASE)
_SUPPLY_UNITS: Final = {"ma": "mA", "hz": "Hz", "v": "V", "ма": "mA", "гц": "Hz", "в": "V"}
"""As they are typed, in Latin and in Cyrillic letters."""
SWINGS: Final = (*TURNING, ReadingKind.TRANSIT)
SHORTEST_HALF_SWING_S: Final = 60.0
TYPED_UP_S: Final = 5.0
"""Nobody reads two turning points within this time: such a row is typed up, its moment unknown."""
_AGO: Final = re.compile(r"[-\u2212]\s*(\d+(?:\.\d*)?)\s*s?")
_TIME: Final = re.compile(r"(\d{1,2}):(\d{2})(?::(\d{2}(?:\.\d*)?))?")


@dataclass(frozen=True, slots=True)
class Understood:
    """A typed text as it would go into the book.

    Parameters
    ----------
    row : NewRow
    value : float
        [rad] or in the row's unit.
    completed : bool
        Whether a part was taken from a reading nearby.
    questions : tuple of Question
        To be asked once before it is written.
    stamp : Stamp
    timed : bool
        Whether the moment is written.
    """

    row: NewRow
    value: float
    completed: bool
    questions: tuple[Question, ...]
    stamp: Stamp
    timed: bool = True


def expected(
    observation: SessionDesk,
    step: Step,
    progress: Progress | None,
    kind: ReadingKind | None = None,
) -> Expected:
    """Tell what is to be read next in a step.

    Parameters
    ----------
    observation : SessionDesk
    step : Step
    progress : Progress or None
        As computed last, for the forecast.
    kind : ReadingKind or None
        Chosen by the surveyor, else the usual one.
    """
    kinds = kinds_of(step, observation.session.method)
    rows = observation.rows(step)
    chosen = kind if kind in kinds else _usual(kinds, rows)
    number = sum(row.kind is chosen for row in rows) + 1
    if chosen in (ReadingKind.BACKSIGHT, ReadingKind.ZENITH):
        sights = tuple(row for row in rows if row.kind is chosen)
        target, face = next_sight(_as_sights(sights), observation.targets)
        near = _near_sight(observation, target, face) if chosen is ReadingKind.BACKSIGHT else None
        return Expected(step, chosen, face, target, near=near, number=number)
    if chosen in TURNING:
        return _expected_point(step, rows, progress, chosen, book=observation.book)
    same = [row for row in rows if row.kind is chosen]
    near = same[-1].value if same and QUANTITY[chosen] is Dimension.ANGLE else None
    side = _alternate(same[-1]) if len(same) > 1 else None
    return Expected(step, chosen, side=side, near=near, number=number)


def _usual(kinds: tuple[ReadingKind, ...], rows: tuple[Reading, ...]) -> ReadingKind:
    clamp = ReadingKind.CLAMP
    if clamp in kinds and not any(row.kind is clamp for row in rows):
        return clamp
    axes = [kind for kind in kinds if QUANTITY[kind] is Dimension.TILT]
    if axes:
        return min(axes, key=lambda axis: sum(row.kind is axis for row in rows))
    return kinds[0] if kinds else ReadingKind.NOTE


def _as_sights(rows: tuple[Reading, ...]) -> tuple[Reading, ...]:
    return tuple(replace(row, kind=ReadingKind.BACKSIGHT) for row in rows)


def _alternate(row: Reading) -> Side | None:
    if row.side is None:
        return None
    return Side.LEFT if row.side is Side.RIGHT else Side.RIGHT


def _struck_side(points: list[Reading], swing: list[Reading]) -> Side | None:
    """Side of the last row of a swing, which is struck, from the points before it."""
    if len(points) < 2 or points[-1].side is None:
        return None
    turns = len(swing) - 1 - swing.index(points[-1])
    return points[-1].side if turns % 2 == 0 else _alternate(points[-1])


def _expected_point(
    step: Step,
    rows: tuple[Reading, ...],
    progress: Progress | None,
    kind: ReadingKind,
    *,
    book: FieldBook,
) -> Expected:
    """The next turning point: its side and the leading part of its reading from the forecast."""
    swing = [r for r in rows if r.kind in (kind, ReadingKind.MISSED)]
    points = [row for row in swing if row.kind is kind]
    again = open_strike(book, kind)
    if again is not None:
        near = swing[-3].value if len(swing) > 2 else again.value
        circle_near = near if kind is ReadingKind.REVERSAL else None
        return Expected(
            step, kind, side=_struck_side(points, swing), near=circle_near, number=len(swing)
        )
    number = len(swing) + 1
    circle = kind is ReadingKind.REVERSAL
    progress = of_this_book(progress, points)
    forecast = progress.next if progress is not None else None
    if progress is None or forecast is None:
        near = swing[-2].value if circle and len(swing) > 1 else None
        side = None if circle or len(points) < 2 else _alternate(swing[-1])
        return Expected(step, kind, side=side, near=near, number=number)
    side = Side(forecast.side) if len(points) > 1 else None
    near = progress.next_reading if circle else None
    return Expected(step, kind, side=side, near=near, number=number)


def _near_sight(observation: SessionDesk, target: str, face: Face) -> float | None:
    rows = sights_of(observation, target)
    for row in reversed(rows):
        if row.value is not None:
            turned = (row.face or Face.LEFT) is not face
            return wrap_two_pi(row.value + (math.pi if turned else 0.0))
    return None


def understand(
    observation: SessionDesk,
    text: str,
    what: Expected,
    *,
    progress: Progress | None,
    stamp: Stamp,
    timed: bool = True,
) -> Understood:
    """Understand a typed text.

    Parameters
    ----------
    observation : SessionDesk
    text : str
        The reading; behind an ``@`` the moment, as ``@08:15:30`` or as ``@-20`` seconds ago.
    what : Expected
    progress : Progress or None
    stamp : Stamp
        When typing began.
    timed : bool
        False for a book that is typed up afterwards: only a moment behind an ``@`` is written.

    Raises
    ------
    EntryError
        If the text is impossible; it says what would be accepted.
    """
    quantity = QUANTITY[what.kind]
    if quantity is Dimension.NONE:
        return _note(text, what, stamp)
    reading, _, moment = plain_signs(text).partition("@")
    stated = bool(moment.strip())
    if stated:
        stamp = _corrected(observation, stamp, moment.strip().replace(",", "."))
    if reading.count(",") == 1 and "." not in reading:
        reading = reading.replace(",", ".")  # the book keeps points
    if quantity is Dimension.ANGLE:
        packed = observation.project.angle_typing == PACKED
        near = what.near
        unit = observation.project.angle_unit
        entry = complete_angle(reading, unit=unit, packed=packed, near=near)
    else:
        unit_name, largest = LARGEST[quantity]
        if quantity is Dimension.SUPPLY:
            match = _SUPPLY.fullmatch(reading.strip())
            if match is not None:
                reading = match[1]
                unit_name = _SUPPLY_UNITS.get((match[2] or "V").lower(), "V")
        entry = complete_number(reading, unit=unit_name, largest=largest)
    row = NewRow(
        kind=what.kind,
        value=entry.text,
        unit=entry.unit,
        face="" if what.face is None else str(what.face),
        target="" if what.target == (observation.session.target or "") else what.target,
    )
    placed = None
    if what.kind in SWINGS:
        placed = place_in_swing(observation.book, _as_reading(row, entry.value, stamp))
        if not stated and what.kind in TURNING:
            stamp = _struck_moment(observation, placed, stamp)
    timed = stated or (timed and not _typed_up(placed, what.kind, stamp))
    typed = Typed(entry.value, entry.unit, stamp if timed else None, placed)
    questions = questions_about(observation, typed, what, progress)
    return Understood(row, entry.value, entry.completed, questions, stamp, timed)


def _typed_up(placed: Placed | None, kind: ReadingKind, stamp: Stamp) -> bool:
    """Whether a turning point follows so fast that it is typed up and was not read just now."""
    if placed is None or placed.before is None or kind not in TURNING:
        return False
    new = replace(placed.before, time=stamp.time, elapsed_s=round(stamp.elapsed_s, 3))
    apart = seconds_between(placed.before, new)
    return apart is not None and abs(apart) < TYPED_UP_S * placed.turns


def _as_reading(row: NewRow, value: float, stamp: Stamp) -> Reading:
    return Reading(0, row.kind, value, row.value, row.unit, stamp.time, round(stamp.elapsed_s, 3))


def _struck_moment(observation: SessionDesk, placed: Placed, stamp: Stamp) -> Stamp:
    """Moment of a struck point that is typed anew: its own, unless it is another turn by now."""
    struck = placed.struck
    if struck is None or struck.time is None or struck.elapsed_s is None:
        return stamp
    half = observation.half_swing_s() or SHORTEST_HALF_SWING_S
    if placed.after is None and stamp.elapsed_s - struck.elapsed_s > half:
        return stamp
    return Stamp(struck.time, struck.elapsed_s)


def _note(text: str, what: Expected, stamp: Stamp) -> Understood:
    words = text.strip()
    if not words:
        raise EntryError(said("an empty note"), said("some words"))
    return Understood(NewRow(what.kind, note=words), 0.0, False, (), stamp)


def _corrected(observation: SessionDesk, stamp: Stamp, text: str) -> Stamp:
    if match := _AGO.fullmatch(text):
        return observation.clock.corrected(stamp, -float(match[1]))
    match = _TIME.fullmatch(text)
    if match is None or int(match[1]) > 23 or int(match[2]) > 59 or float(match[3] or 0) >= 60.0:
        raise EntryError(
            said("@{text} is no moment", text=text), said("@08:15:30, or @-20 for 20 seconds ago")
        )
    whole, _, fraction = (match[3] or "0").partition(".")
    meant: datetime = stamp.time.replace(
        hour=int(match[1]),
        minute=int(match[2]),
        second=int(whole),
        microsecond=int((fraction + "000000")[:6]),
    )
    seconds = (meant - stamp.time).total_seconds()
    half_day = 43200.0
    if seconds > half_day:  # typed behind midnight, read before it
        seconds -= 2.0 * half_day
    elif seconds < -half_day:
        seconds += 2.0 * half_day
    if seconds > 0.0:
        raise EntryError(
            said("@{text} lies in the future", text=text), said("a moment that has passed")
        )
    return observation.clock.corrected(stamp, seconds)


def next_kind(observation: SessionDesk, what: Expected) -> ReadingKind:
    """The other kind of reading that this step takes."""
    kinds = kinds_of(what.step, observation.session.method)
    return kinds[(kinds.index(what.kind) + 1) % len(kinds)] if what.kind in kinds else what.kind


def next_target(observation: SessionDesk, what: Expected) -> str:
    """The next station that may be sighted from here: known targets first, then all others."""
    here = observation.session.station
    names = [s.name for s in observation.project.stations if s.name != here]
    order = list(dict.fromkeys((*observation.targets, *names)))
    if not order:
        return what.target
    return order[(order.index(what.target) + 1) % len(order)] if what.target in order else order[0]
