"""What a surveyor looks at before going on: means, 2c and index of a step, after minus before.

Shown at the instrument and used in no result: the reductions stand in ``core.swing``.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from surveyapp.core.observing.steps import AFTER, BEFORE, NEEDED_ZEROS, Step
from surveyapp.core.swing.tape_zero import reduce_tape_zero
from surveyapp.domain.readings import Face, FieldBook, Place, Reading, ReadingKind
from surveyapp_models.angles import circular_mean, wrap_pi


@dataclass(frozen=True, slots=True)
class SightValues:
    """Sights of one target at one place of the book.

    Parameters
    ----------
    target : str
    mean : float
        Direction as of face left, both faces alike in weight [rad].
    both_faces : bool
        False: the mean is of one face and holds the collimation.
    two_c : float or None
        Left minus right plus half a circle, twice the collimation [rad]; None with one face.
    change : float or None
        Mean minus that of the sights before [rad], None before the observation.
    """

    target: str
    mean: float
    both_faces: bool
    two_c: float | None
    change: float | None


@dataclass(frozen=True, slots=True)
class ZenithValues:
    """Zenith angles of one target in both faces.

    Parameters
    ----------
    target : str
    mean : float
        Zenith angle free of the index error [rad].
    index : float
        Left plus right minus a full circle, twice the index error [rad].
    """

    target: str
    mean: float
    index: float


@dataclass(frozen=True, slots=True)
class ZeroValues:
    """Tape zero at one place of the book.

    Parameters
    ----------
    mean_div : float
        Mean of the overlapping means (x1 + 2 x2 + x3)/4 [div].
    points : int
    change_div : float or None
        Minus the tape zero before [div]; None before the observation.
    """

    mean_div: float
    points: int
    change_div: float | None


@dataclass(frozen=True, slots=True)
class StepValues:
    """Values of a step; empty where it has none to show."""

    sights: tuple[SightValues, ...] = ()
    zeniths: tuple[ZenithValues, ...] = ()
    zero: ZeroValues | None = None


def step_values(book: FieldBook, step: Step, *, target: str | None) -> StepValues:
    """Values worth seeing at a step.

    Parameters
    ----------
    book : FieldBook
    step : Step
        At the result everything after the observation is shown once more.
    target : str or None
        What an empty target in the book means.
    """
    if step not in BEFORE | AFTER | {Step.RESULT}:
        return StepValues()
    place = Place.BEFORE if step in BEFORE else Place.AFTER
    sights = step in (Step.SIGHTS_BEFORE, Step.SIGHTS_AFTER, Step.RESULT)
    zeros = step in (Step.ZERO_BEFORE, Step.ZERO_AFTER, Step.RESULT)
    return StepValues(
        sights=_sights(book, place, target) if sights else (),
        zeniths=_zeniths(book, place, target) if sights else (),
        zero=_zero(book, place) if zeros else None,
    )


def _by_target(
    book: FieldBook, kind: ReadingKind, place: Place, target: str | None
) -> dict[str, list[Reading]]:
    found: dict[str, list[Reading]] = {}
    for row in book.of_kind(kind):
        if row.value is not None and book.place_of(row) is place:
            found.setdefault(row.target or target or "", []).append(row)
    return found


def _of_face(rows: Sequence[Reading], face: Face) -> float | None:
    values = [row.value for row in rows if row.face is face and row.value is not None]
    return circular_mean(values) if values else None


def _mean(rows: Sequence[Reading]) -> tuple[float, float | None, str] | None:
    """Mean direction as of face left, 2c, and the faces; None where no row tells its face."""
    left, right = _of_face(rows, Face.LEFT), _of_face(rows, Face.RIGHT)
    if left is None and right is None:
        return None
    if left is None or right is None:
        only = left if left is not None else (right or 0.0) + math.pi
        return only % (2.0 * math.pi), None, "R" if left is None else "L"
    two_c = wrap_pi(left - right + math.pi)
    return (left - 0.5 * two_c) % (2.0 * math.pi), two_c, "LR"


def _sights(book: FieldBook, place: Place, target: str | None) -> tuple[SightValues, ...]:
    before = _by_target(book, ReadingKind.BACKSIGHT, Place.BEFORE, target)
    values = []
    for name, rows in _by_target(book, ReadingKind.BACKSIGHT, place, target).items():
        now = _mean(rows)
        if now is None:
            continue
        first = _mean(before.get(name, ())) if place is Place.AFTER else None
        # one face before and the other after: turning and collimation cannot be told apart
        change = wrap_pi(now[0] - first[0]) if first is not None and first[2] == now[2] else None
        values.append(SightValues(name, now[0], now[1] is not None, now[1], change))
    return tuple(values)


def _zeniths(book: FieldBook, place: Place, target: str | None) -> tuple[ZenithValues, ...]:
    values = []
    for name, rows in _by_target(book, ReadingKind.ZENITH, place, target).items():
        left, right = _of_face(rows, Face.LEFT), _of_face(rows, Face.RIGHT)
        if left is not None and right is not None:
            index = wrap_pi(left + right)
            values.append(ZenithValues(name, (left - 0.5 * index) % (2.0 * math.pi), index))
    return tuple(values)


def _zero(book: FieldBook, place: Place) -> ZeroValues | None:
    zero = reduce_tape_zero(book, ())
    now = None if zero is None else zero.before if place is Place.BEFORE else zero.after
    if zero is None or now is None or now.points < NEEDED_ZEROS:
        return None
    first = zero.before if place is Place.AFTER else None
    usable = first is not None and first.points >= NEEDED_ZEROS
    change = now.value_div - first.value_div if first is not None and usable else None
    return ZeroValues(now.value_div, now.points, change)
