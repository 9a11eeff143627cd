"""Is a reading what it should be? Asked once, with the reason, before it goes into the book.

A doubt never refuses: the surveyor has seen the instrument and the program has not. What is
impossible was refused before (``surveyapp.core.observing.typed_rows``), and what no command could
use in the book is not written (``surveyapp.core.swing.contradictions``).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Final

from surveyapp.core.observing.forecast import HELD
from surveyapp.core.statistics.distributions import student_quantile
from surveyapp.core.swing.clamped import SCALE_RANGE_DIV
from surveyapp.domain.readings import Face, Reading, ReadingKind, Side
from surveyapp_models.angles import ARCSEC, wrap_pi

FACES_LIMIT: Final = 600.0 * ARCSEC
"""Two faces of one target differ by half a circle less twice the collimation; 5 minutes of
collimation is more than an adjusted theodolite has, and less than any slip of a minute digit pair
is likely to be."""
SIGHT_LIMIT: Final = 60.0 * ARCSEC
"""A repeated sight of one target in one face, and a jump of the collimation: far above pointing
and below a wrong minute."""

ROUND_LIMIT: Final = 600.0 * ARCSEC
"""Rounds of an automatic gyro differ by arc-seconds to a minute; as ``FACES_LIMIT``, this is a slip
of a digit, whatever the rounds so far seem to say."""


class Doubt(StrEnum):
    """Why a reading is asked for once more."""

    OUTSIDE_FORECAST = "outside_forecast"
    WRONG_SIDE = "wrong_side"
    FACES_CONTRADICT = "faces_contradict"
    SIGHT_MOVED = "sight_moved"
    SIGHT_FACE = "sight_face"
    COLLIMATION_JUMP = "collimation_jump"
    ZENITHS_CONTRADICT = "zeniths_contradict"
    CLAMP_MOVED = "clamp_moved"
    OUTSIDE_ROUNDS = "outside_rounds"
    OFF_SCALE = "off_scale"
    OTHER_DIVISION = "other_division"
    OUTSIDE_RANGE = "outside_range"
    SUPPLY_JUMP = "supply_jump"
    ZENITH_FACE = "zenith_face"
    BEFORE_LAST_ROW = "before_last_row"
    HALF_SWING = "half_swing"


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
    unit : str
        s, C, V, Hz, mA or deg where it is no angle to be shown in arc-seconds, and no division.
    low : float or None
        Lower end of a range whose upper end is ``limit``; ``difference`` is the reading itself.
    """

    doubt: Doubt
    difference: float
    limit: float
    scale: bool = False
    unit: str = ""
    low: float | None = None


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
            turned = abs(wrap_pi(difference - math.pi)) <= FACES_LIMIT
            doubt = Doubt.SIGHT_FACE if turned else Doubt.SIGHT_MOVED
            return (Question(doubt, difference, SIGHT_LIMIT),)
    other = _readings(series, _opposite(face))
    if not other:
        return ()
    sign = 1.0 if face is Face.LEFT else -1.0
    twice = sign * wrap_pi(reading - other[-1] - math.pi)
    if abs(twice) > FACES_LIMIT:
        turned = abs(wrap_pi(twice - math.pi)) <= FACES_LIMIT
        doubt = Doubt.SIGHT_FACE if turned else Doubt.FACES_CONTRADICT
        return (Question(doubt, twice, FACES_LIMIT),)
    left, right = _readings(earlier, Face.LEFT), _readings(earlier, Face.RIGHT)
    if left and right:
        jump = wrap_pi(twice - wrap_pi(left[-1] - right[-1] - math.pi))
        if abs(jump) > SIGHT_LIMIT:
            return (Question(Doubt.COLLIMATION_JUMP, jump, SIGHT_LIMIT),)
    return ()


def doubt_zenith(reading: float, face: Face, series: Sequence[Reading]) -> tuple[Question, ...]:
    """Compare a zenith angle [rad] with the latest of the same target in the other face."""
    other = [r.value for r in series if r.face is _opposite(face) and r.value is not None]
    if not other:
        return ()
    index = wrap_pi(reading + other[-1])
    if abs(index) <= FACES_LIMIT:
        return ()
    return (Question(Doubt.ZENITHS_CONTRADICT, index, FACES_LIMIT),)


def doubt_clamp(reading: float, earlier: Sequence[float]) -> tuple[Question, ...]:
    """Compare a reading of the clamped circle [rad] with the one before."""
    moved = wrap_pi(reading - earlier[-1]) if earlier else 0.0
    if abs(moved) <= SIGHT_LIMIT:
        return ()
    return (Question(Doubt.CLAMP_MOVED, moved, SIGHT_LIMIT),)


def doubt_round(
    reading: float, earlier: Sequence[float], *, card_sigma: float | None
) -> tuple[Question, ...]:
    """Compare a delivered azimuth [rad] with the rounds before it.

    Parameters
    ----------
    reading : float
    earlier : sequence of float
        Rounds so far [rad].
    card_sigma : float or None
        Standard deviation of one round [rad]; without it their own scatter, from three on.
    """
    if not earlier:
        return ()
    offsets = [wrap_pi(value - earlier[0]) for value in earlier]
    count = len(offsets)
    mean = math.fsum(offsets) / count
    difference = wrap_pi(reading - earlier[0] - mean)
    limit = ROUND_LIMIT
    sigma, dof = card_sigma, math.inf
    if sigma is None and count > 2:
        dof = float(count - 1)
        sigma = math.sqrt(math.fsum((x - mean) ** 2 for x in offsets) / dof)
    if sigma:
        limit = min(limit, student_quantile(HELD, dof) * sigma * math.sqrt(1.0 + 1.0 / count))
    if abs(difference) <= limit:
        return ()
    return (Question(Doubt.OUTSIDE_ROUNDS, difference, limit),)


def doubt_scale(reading: float, earlier: Sequence[float]) -> tuple[Question, ...]:
    """Doubt a reading [div] beyond the end of the usual scale, unless others stood there too."""
    reached = max((abs(value) for value in earlier), default=0.0)
    if abs(reading) <= SCALE_RANGE_DIV or reached > SCALE_RANGE_DIV:
        return ()
    beyond = math.copysign(abs(reading) - SCALE_RANGE_DIV, reading)
    return (Question(Doubt.OFF_SCALE, beyond, SCALE_RANGE_DIV, scale=True),)


def doubt_passage(division: float, earlier: Sequence[float]) -> tuple[Question, ...]:
    """Doubt a passage [div] of another division than so far, zero at first.

    A reading of the scale that was typed for a passage would be taken for one.
    """
    if division in (0.0, *earlier):
        return ()
    return (Question(Doubt.OTHER_DIVISION, division, 0.0, scale=True),)


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
