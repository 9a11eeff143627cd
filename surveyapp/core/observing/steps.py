"""The steps of a gyro orientation, and where in them a field book stands.

Everything follows from the book alone: its readings, and the notes with which a step was begun.
After a crash the same book gives the same step. Nothing here knows a screen.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Final

from surveyapp.domain.project import Method
from surveyapp.domain.readings import Face, FieldBook, Place, Reading, ReadingKind, Side

STEP_NOTE: Final = "step "
"""A note row whose text begins so says that the surveyor went to a step."""


class Step(StrEnum):
    """A step of the observation; its value is what stands in the book's note."""

    SETUP = "set-up"
    SIGHTS_BEFORE = "sights-before"
    ZERO_BEFORE = "tape-zero-before"
    RUN_UP = "run-up"
    SWING = "observation"
    ZERO_AFTER = "tape-zero-after"
    SIGHTS_AFTER = "sights-after"
    RESULT = "result"


class State(StrEnum):
    """How far a step is."""

    OPEN = "open"
    BEGUN = "begun"
    DONE = "done"


SUSPENDED: Final = tuple(Step)
AUTOMATIC: Final = (
    Step.SETUP,
    Step.SIGHTS_BEFORE,
    Step.SWING,
    Step.SIGHTS_AFTER,
    Step.RESULT,
)

_SWING: Final[dict[str, tuple[ReadingKind, ...]]] = {
    "tracking": (ReadingKind.REVERSAL,),
    "amplitude": (ReadingKind.SCALE_REVERSAL, ReadingKind.CLAMP),
    "transit": (ReadingKind.TRANSIT, ReadingKind.SCALE_REVERSAL, ReadingKind.CLAMP),
    "automatic": (ReadingKind.AZIMUTH, ReadingKind.NORTH),
}
_OTHER: Final[dict[Step, tuple[ReadingKind, ...]]] = {
    Step.SETUP: (ReadingKind.LEVEL_ALONG, ReadingKind.LEVEL_ACROSS, ReadingKind.TEMPERATURE),
    Step.SIGHTS_BEFORE: (ReadingKind.BACKSIGHT, ReadingKind.ZENITH),
    Step.ZERO_BEFORE: (ReadingKind.TAPE_ZERO,),
    Step.RUN_UP: (ReadingKind.SUPPLY, ReadingKind.TEMPERATURE),
    Step.ZERO_AFTER: (ReadingKind.TAPE_ZERO,),
    Step.SIGHTS_AFTER: (ReadingKind.BACKSIGHT, ReadingKind.ZENITH),
    Step.RESULT: (),
}
NEEDED_ZEROS: Final = 3
"""Turning points of the unspun swing: (x1 + 2 x2 + x3)/4 (physics.md 2.5)."""
NEEDED_POINTS: Final = 3
BEFORE: Final = frozenset({Step.SIGHTS_BEFORE, Step.ZERO_BEFORE})
AFTER: Final = frozenset({Step.ZERO_AFTER, Step.SIGHTS_AFTER})


@dataclass(frozen=True, slots=True)
class StepState:
    """One step with its state.

    Parameters
    ----------
    step : Step
    state : State
    count : int
        Readings that count in it.
    complete : bool
        Whether it has all readings that it needs; false for what needs none.
    """

    step: Step
    state: State
    count: int
    complete: bool = False


@dataclass(frozen=True, slots=True)
class Expected:
    """What is to be read next.

    Parameters
    ----------
    step : Step
    kind : ReadingKind
    face : Face or None
    target : str
        Empty for the session's own.
    side : Side or None
        Of a turning point, where it is known.
    near : float or None
        A reading [rad] whose leading part the next one shares.
    number : int
        The how manieth of its kind in this step, from 1.
    """

    step: Step
    kind: ReadingKind
    face: Face | None = None
    target: str = ""
    side: Side | None = None
    near: float | None = None
    number: int = 1


def steps_of(method: Method) -> tuple[Step, ...]:
    """Steps of a method, in their order."""
    return AUTOMATIC if method == "automatic" else SUSPENDED


def kinds_of(step: Step, method: Method) -> tuple[ReadingKind, ...]:
    """Kinds of reading that a step takes; the first is the usual one."""
    return _SWING[method] if step is Step.SWING else _OTHER[step]


def rows_of(book: FieldBook, step: Step, method: Method) -> tuple[Reading, ...]:
    """Live readings of a step."""
    kinds = kinds_of(step, method)
    rows = book.of_kind(*kinds)
    if step in BEFORE:
        return tuple(row for row in rows if book.place_of(row) is Place.BEFORE)
    if step in AFTER:
        return tuple(row for row in rows if book.place_of(row) is Place.AFTER)
    return _swing_rows(book, kinds) if step is Step.SWING else rows


def _swing_rows(book: FieldBook, kinds: tuple[ReadingKind, ...]) -> tuple[Reading, ...]:
    """Rows of the observation; a missed point below it belongs to it until the tape is read."""
    found = []
    zero_after = False
    for row in book.of_kind(*kinds, ReadingKind.MISSED, ReadingKind.TAPE_ZERO):
        place = book.place_of(row)
        if row.kind is ReadingKind.TAPE_ZERO:
            zero_after = zero_after or place is Place.AFTER
        elif row.kind in kinds or (place is not Place.BEFORE and not zero_after):
            found.append(row)
    return tuple(found)


def swing_begun(book: FieldBook, method: Method) -> bool:
    """Whether a turning point (or round) stands in the book: what comes now is not before it."""
    return any(row.kind is not ReadingKind.CLAMP for row in rows_of(book, Step.SWING, method))


def current_step(book: FieldBook, method: Method) -> Step:
    """The step that the book stands at.

    The last row that tells decides: a note ``step ...``, else the reading's own step. An empty
    book stands at the first step. Strikes, other notes and struck rows tell nothing.
    """
    struck = set(book.struck)
    for row in reversed(book.rows):
        if row.kind is ReadingKind.NOTE and row.note.startswith(STEP_NOTE):
            name = row.note.removeprefix(STEP_NOTE).strip()
            if name in steps_of(method):
                return Step(name)
        elif row.seq not in struck:
            step = _step_of(book, row, method)
            if step is not None:
                return step
    return steps_of(method)[0]


def _step_of(book: FieldBook, row: Reading, method: Method) -> Step | None:
    live = next((item for item in book.live if item.seq == row.seq), None)
    if live is None:
        return None
    for step in steps_of(method):
        if live in rows_of(book, step, method):
            return step
    return None


def step_states(book: FieldBook, method: Method, targets: tuple[str, ...]) -> tuple[StepState, ...]:
    """State of every step.

    Parameters
    ----------
    book : FieldBook
    method : Method
    targets : tuple of str
        Targets that are to be sighted in both faces; empty where the session has none.
    """
    noted = {
        row.note.removeprefix(STEP_NOTE).strip()
        for row in book.rows
        if row.kind is ReadingKind.NOTE and row.note.startswith(STEP_NOTE)
    }
    here = current_step(book, method)
    order = steps_of(method)
    states = []
    for step in order:
        rows = rows_of(book, step, method)
        state = State.BEGUN if rows or str(step) in noted else State.OPEN
        passed = order.index(step) < order.index(here) and step in (Step.SETUP, Step.RUN_UP)
        complete = _complete(step, rows, targets)
        if state is State.BEGUN and (passed or complete):
            state = State.DONE
        count = sum(row.kind is not ReadingKind.MISSED for row in rows)
        states.append(StepState(step, state, count, complete))
    return tuple(states)


def _complete(step: Step, rows: tuple[Reading, ...], targets: tuple[str, ...]) -> bool:
    if step in (Step.SIGHTS_BEFORE, Step.SIGHTS_AFTER):
        seen = {(row.target or (targets[0] if targets else ""), row.face) for row in rows}
        wanted = targets or ("",)
        return all((name, face) in seen for name in wanted for face in Face)
    if step in (Step.ZERO_BEFORE, Step.ZERO_AFTER):
        return len(rows) >= NEEDED_ZEROS
    if step is Step.SWING:
        turning = (ReadingKind.CLAMP, ReadingKind.MISSED)
        points = [row for row in rows if row.kind not in turning]
        return len(points) >= NEEDED_POINTS
    return False


def next_sight(rows: tuple[Reading, ...], targets: tuple[str, ...]) -> tuple[str, Face]:
    """Target and face that come next: every target in face left, then back in face right.

    Parameters
    ----------
    rows : tuple of Reading
        Sights of this step so far.
    targets : tuple of str
        The session's own first.
    """
    names = targets or ("",)
    cycle = [(name, Face.LEFT) for name in names]
    cycle += [(name, Face.RIGHT) for name in reversed(names)]
    done = [(row.target or names[0], row.face) for row in rows if row.kind is ReadingKind.BACKSIGHT]
    remaining = list(cycle)
    for item in done:
        if item in remaining:
            remaining.remove((item[0], item[1] or Face.LEFT))
        if not remaining:
            remaining = list(cycle)
    return remaining[0]
