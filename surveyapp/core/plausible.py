"""Is a reading what it should be? Asked once, with the reason, before it goes into the book.

A doubt never refuses: the surveyor has seen the instrument and the program has not. What is
impossible was refused before (``surveyapp.core.entry``).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Final

from surveyapp.domain.readings import Face, Reading, ReadingKind, Side
from surveyapp_models.angles import ARCSEC, wrap_pi

FACES_LIMIT: Final = 600.0 * ARCSEC
"""Two faces of one target differ by half a circle less twice the collimation; 5 minutes of
collimation is more than an adjusted theodolite has, and less than any slip of a minute digit pair
is likely to be."""
SIGHT_LIMIT: Final = 60.0 * ARCSEC
"""A repeated sight of one target in one face, and a jump of the collimation: far above pointing
and below a wrong minute."""


class Doubt(StrEnum):
    """Why a reading is asked for once more."""

    OUTSIDE_FORECAST = "outside_forecast"
    WRONG_SIDE = "wrong_side"
    FACES_CONTRADICT = "faces_contradict"
    SIGHT_MOVED = "sight_moved"
    COLLIMATION_JUMP = "collimation_jump"


@dataclass(frozen=True, slots=True)
class Question:
    """One doubt with its size.

    Parameters
    ----------
    doubt : Doubt
    difference : float
        From what was expected [rad], on the scale [div].
    limit : float
        In the same unit.
    scale : bool
        Whether it is a reading of the gyro scale.
    """

    doubt: Doubt
    difference: float
    limit: float
    scale: bool = False


def doubt_turning_point(
    reading: float,
    *,
    middle: float | None,
    predicted: float | None,
    half_width: float | None,
    side: Side | None,
) -> tuple[Question, ...]:
    """Compare a turning point with its forecast.

    Parameters
    ----------
    reading : float
        [rad].
    middle : float or None
        Circle reading of the swing's middle [rad].
    predicted, half_width : float or None
        Forecast and half-width of its interval [rad].
    side : Side or None
        Where the next point must lie.
    """
    if middle is not None and side is not None:
        offset = wrap_pi(reading - middle)
        if (offset > 0.0) != (side is Side.RIGHT):
            return (Question(Doubt.WRONG_SIDE, abs(offset), 0.0),)
    if predicted is None or half_width is None:
        return ()
    difference = wrap_pi(reading - predicted)
    if abs(difference) > half_width:
        return (Question(Doubt.OUTSIDE_FORECAST, difference, half_width),)
    return ()


def doubt_scale_point(
    reading: float,
    *,
    middle: float | None,
    predicted: float | None,
    half_width: float | None,
    side: Side | None,
) -> tuple[Question, ...]:
    """Compare a turning point on the scale [div] with its forecast, as ``doubt_turning_point``."""
    if middle is not None and side is not None and (reading > middle) != (side is Side.RIGHT):
        return (Question(Doubt.WRONG_SIDE, abs(reading - middle), 0.0, scale=True),)
    if predicted is None or half_width is None or abs(reading - predicted) <= half_width:
        return ()
    return (Question(Doubt.OUTSIDE_FORECAST, reading - predicted, half_width, scale=True),)


def doubt_sight(
    reading: float, face: Face, *, series: Sequence[Reading], earlier: Sequence[Reading]
) -> tuple[Question, ...]:
    """Compare a sight with the other live sights of the same target.

    Parameters
    ----------
    reading : float
        [rad].
    face : Face
    series : sequence of Reading
        Sights of this target in this step.
    earlier : sequence of Reading
        Those of the step before the observation, empty while in it.
    """
    same = _readings(series, face) or _readings(earlier, face)
    if same:
        difference = wrap_pi(reading - same[-1])
        if abs(difference) > SIGHT_LIMIT:
            return (Question(Doubt.SIGHT_MOVED, difference, SIGHT_LIMIT),)
    other = _readings(series, _opposite(face))
    if not other:
        return ()
    sign = 1.0 if face is Face.LEFT else -1.0
    twice = sign * wrap_pi(reading - other[-1] - math.pi)
    if abs(twice) > FACES_LIMIT:
        return (Question(Doubt.FACES_CONTRADICT, twice, FACES_LIMIT),)
    left, right = _readings(earlier, Face.LEFT), _readings(earlier, Face.RIGHT)
    if left and right:
        jump = wrap_pi(twice - wrap_pi(left[-1] - right[-1] - math.pi))
        if abs(jump) > SIGHT_LIMIT:
            return (Question(Doubt.COLLIMATION_JUMP, jump, SIGHT_LIMIT),)
    return ()


def _opposite(face: Face) -> Face:
    return Face.RIGHT if face is Face.LEFT else Face.LEFT


def _readings(rows: Sequence[Reading], face: Face) -> list[float]:
    return [
        row.value
        for row in rows
        if row.kind is ReadingKind.BACKSIGHT
        and row.value is not None
        and (row.face or Face.LEFT) is face
    ]
