"""Doubts about supply, temperature, level, zenith angle and moment, each against the card.

The card tells the range; where it states none, a wide one does: a reading typed under the wrong
kind falls out of it. As every doubt these ask once and refuse nothing.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

from surveyapp.core.observing.doubts import Doubt, Question
from surveyapp.domain.instrument import ValidRange
from surveyapp.domain.readings import Face
from surveyapp_models.angles import ARCSEC, TWO_PI, wrap_two_pi

USUAL_SUPPLY: Final = {"V": (1.0, 130.0), "Hz": (50.0, 2000.0), "mA": (1.0, 20000.0)}
"""Spin motors of suspended gyros run on 6 to 36 V of a battery or on 36 to 115 V at 200 to 1000 Hz
of a converter; these ranges are wider."""
SUPPLY_JUMP: Final = 0.10
"""One per cent of spin moves T1 by 2 s of 425 s (physics.md 1.2): a tenth is another quantity."""
USUAL_TEMPERATURE_C: Final = (-30.0, 50.0)
"""Mines and their heads; the cards that state a range lie within it."""
USUAL_LEVEL: Final = 300.0 * ARCSEC
"""Compensators and plate bubbles of theodolites end at 3 to 5 minutes."""
USUAL_ZENITH: Final = (math.radians(45.0), math.radians(135.0))
"""Steeper sights need a diagonal eyepiece, and the gyro attachment stands in their way."""
HALF_SWING_SHARE: Final = 0.25
"""A moment of typing may lie this share of a half swing from where it should: tens of seconds."""
HALF_SWINGS_S: Final = (75.0, 600.0)
"""Half swings of suspended gyros: 60 to 300 s from the equator to 75 degrees (physics.md 1.2)."""


def doubt_supply(
    value: float, unit: str, earlier: Sequence[float], valid: ValidRange
) -> tuple[Question, ...]:
    """Doubt a supply outside of its range, or one that leaps.

    Parameters
    ----------
    value : float
        In ``unit``.
    unit : str
        V, Hz or mA.
    earlier : sequence of float
        Supplies so far in the same unit.
    valid : ValidRange
        Of the card.
    """
    stated = {name: (low, high) for name, low, high in valid.supply}
    asked = _outside(value, stated.get(unit) or USUAL_SUPPLY[unit], unit)
    if asked or not earlier:
        return asked
    change = value - earlier[-1]
    limit = SUPPLY_JUMP * abs(earlier[-1])
    if abs(change) <= limit:
        return ()
    return (Question(Doubt.SUPPLY_JUMP, change, limit, unit=unit),)


def doubt_temperature(value_c: float, valid: ValidRange) -> tuple[Question, ...]:
    """Doubt a temperature [degree Celsius] that the instrument is not made for."""
    return _outside(value_c, valid.temperature_c or USUAL_TEMPERATURE_C, "C")


def doubt_level(value: float, valid: ValidRange) -> tuple[Question, ...]:
    """Doubt a level reading [rad] beyond the end of bubble or compensator."""
    limit = USUAL_LEVEL if valid.level is None else valid.level
    return _outside(value / ARCSEC, (-limit / ARCSEC, limit / ARCSEC), "arcsec")


def doubt_zenith_range(value: float, face: Face, valid: ValidRange) -> tuple[Question, ...]:
    """Doubt a zenith angle [rad] that belongs to the other face, or is too steep to be sighted."""
    low, high = valid.zenith or USUAL_ZENITH
    here = value if face is Face.LEFT else wrap_two_pi(TWO_PI - value)
    if low <= here <= high:
        return ()
    if low <= wrap_two_pi(TWO_PI - here) <= high:
        return (Question(Doubt.ZENITH_FACE, math.degrees(value), 0.0, unit="deg"),)
    ends = (low, high) if face is Face.LEFT else (TWO_PI - high, TWO_PI - low)
    return _outside(math.degrees(value), (math.degrees(ends[0]), math.degrees(ends[1])), "deg")


def _outside(value: float, ends: tuple[float, float], unit: str) -> tuple[Question, ...]:
    low, high = ends
    if low <= value <= high:
        return ()
    return (Question(Doubt.OUTSIDE_RANGE, value, high, unit=unit, low=low),)


def doubt_half_swing(
    elapsed_s: float, turns: int, *, half_swing_s: float | None
) -> tuple[Question, ...]:
    """Doubt the moment of a turning point against the one before it.

    Parameters
    ----------
    elapsed_s : float
        Seconds since the turning point before.
    turns : int
        Half swings between the two, missed points counted.
    half_swing_s : float or None
        Of the card at this latitude [s]; None leaves only what no suspended gyro can have.
    """
    one = elapsed_s / turns
    low, high = HALF_SWINGS_S
    if half_swing_s is not None:
        off = abs(elapsed_s - turns * half_swing_s) > HALF_SWING_SHARE * half_swing_s
        if off:
            return (Question(Doubt.HALF_SWING, elapsed_s, turns * half_swing_s, unit="s"),)
        return ()
    if low <= one <= high:
        return ()
    return (Question(Doubt.OUTSIDE_RANGE, one, high, unit="s", low=low),)


def doubt_moment(seconds_before: float) -> tuple[Question, ...]:
    """Doubt a stated moment that lies before the latest row [s]."""
    if seconds_before <= 0.0:
        return ()
    return (Question(Doubt.BEFORE_LAST_ROW, seconds_before, 0.0, unit="s"),)
