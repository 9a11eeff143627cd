"""Angles as a surveyor writes them and as the program computes with them.

Inside the program an angle is a float in radians, clockwise, and carries no suffix in its name.
This module is the only place that wraps, averages, reads and prints angles. It does not know
circles, faces or instruments.
"""

from __future__ import annotations

import math
import re
from enum import StrEnum
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

TWO_PI: Final = 2.0 * math.pi
RHO_ARCSEC: Final = 180.0 * 3600.0 / math.pi
"""Arc-seconds in one radian, 206264.806."""
ARCSEC: Final = 1.0 / RHO_ARCSEC
"""One arc-second in radians."""


class AngleUnit(StrEnum):
    """How angles are written: degrees-minutes-seconds, gon, or decimal degrees."""

    DMS = "dms"
    GON = "gon"
    DEG = "deg"


FULL_CIRCLE: Final = {AngleUnit.DMS: 360.0, AngleUnit.DEG: 360.0, AngleUnit.GON: 400.0}

_DMS = re.compile(
    r"""\s*(?P<sign>[+\-−]?)(?P<degrees>\d{1,3})
        (?:\s*[-:°º]\s*|\s+)(?P<minutes>\d{1,2})
        (?:\s*[-:'′’]\s*|\s+)(?P<seconds>\d{1,2}(?:\.\d*)?)
        \s*(?:"|″|”|'')?\s*""",
    re.VERBOSE,
)
_PLAIN = re.compile(r"\s*[+-]?(?:\d+\.?\d*|\.\d+)\s*")


class AngleError(ValueError):
    """A text that is no angle; the message says what was expected.

    Attributes
    ----------
    expected : str
        What a valid text looks like.
    hint : str
        What to do, or an empty string.
    """

    def __init__(self, found: str, expected: str, hint: str = "") -> None:
        super().__init__(f"{found!r} is no angle: expected {expected}")
        self.expected = expected
        self.hint = hint


def wrap_two_pi(angle: float) -> float:
    """Wrap one angle [rad] to [0, 2 pi)."""
    wrapped = math.fmod(angle, TWO_PI)
    if wrapped < 0.0:
        wrapped += TWO_PI
    return 0.0 if wrapped >= TWO_PI else wrapped


def wrap_pi(angle: float) -> float:
    """Wrap one difference of angles [rad] to (-pi, pi]."""
    return math.pi - wrap_two_pi(math.pi - angle)


def wrap_pi_array(angles: ArrayLike) -> NDArray[np.float64]:
    """Wrap differences of angles [rad], any shape, to (-pi, pi]."""
    values = np.asarray(angles, dtype=np.float64)
    return math.pi - np.mod(math.pi - values, TWO_PI)


def circular_mean(angles: ArrayLike, weights: ArrayLike | None = None) -> float:
    """Mean direction of angles that lie within less than half a circle of each other.

    The angles are unwrapped about the first one and averaged there, so that for small spreads the
    result is the arithmetic mean to the last digit, also across 0/360 degrees.

    Parameters
    ----------
    angles : array_like, shape (n,)
        Angles [rad], n >= 1.
    weights : array_like, shape (n,), optional
        Non-negative weights, equal ones if absent.

    Returns
    -------
    float
        The mean [rad] in [0, 2 pi).

    Raises
    ------
    ValueError
        If there is no angle, or if they spread over half a circle or more: then a mean direction
        has no meaning.
    """
    values = np.atleast_1d(np.asarray(angles, dtype=np.float64))
    if values.size == 0:
        raise ValueError("the mean of no angles is not defined")
    offsets = wrap_pi_array(values - values[0])
    if float(offsets.max() - offsets.min()) >= math.pi:
        raise ValueError("the angles spread over half a circle or more: they have no mean")
    mean = float(np.average(offsets, weights=None if weights is None else np.asarray(weights)))
    return wrap_two_pi(float(values[0]) + mean)


def parse_angle(text: str, unit: AngleUnit) -> float:
    """Read the text of an angle.

    Parameters
    ----------
    text : str
        ``179-01-56.0``, ``179:01:56``, ``179 01 56`` or ``179°01'56"`` for dms; a plain number
        for gon and deg. Signs are allowed (differences); a circle reading is refused elsewhere.
    unit : AngleUnit
        How the text is to be read.

    Returns
    -------
    float
        The angle [rad], not wrapped, except that exactly one full circle counts as 0.

    Raises
    ------
    AngleError
        If the text is no angle in this unit, or exceeds a full circle.
    """
    magnitude, negative = _dms(text) if unit is AngleUnit.DMS else _plain(text, unit)
    full = FULL_CIRCLE[unit]
    if magnitude > full:
        hint = "was it typed in gon?" if full == 360.0 and magnitude <= 400.0 else ""
        raise AngleError(text, f"at most {full:g} {_name(unit)}", hint)
    if magnitude == full:
        magnitude = 0.0
    radians = magnitude * (TWO_PI / full)
    return -radians if negative else radians


def _name(unit: AngleUnit) -> str:
    return "gon" if unit is AngleUnit.GON else "degrees"


def _dms(text: str) -> tuple[float, bool]:
    match = _DMS.fullmatch(text)
    expected = "degrees-minutes-seconds like 179-01-56.0"
    if match is None:
        hint = ""
        if _PLAIN.fullmatch(text):
            hint = "a plain number is gon or decimal degrees: write gon or deg in the unit column"
        raise AngleError(text, expected, hint)
    minutes, seconds = float(match["minutes"]), float(match["seconds"])
    if minutes >= 60.0 or seconds >= 60.0:
        raise AngleError(text, expected + ", minutes and seconds below 60")
    magnitude = float(match["degrees"]) + (minutes * 60.0 + seconds) / 3600.0
    return magnitude, match["sign"] in ("-", "−")


def _plain(text: str, unit: AngleUnit) -> tuple[float, bool]:
    if _PLAIN.fullmatch(text) is None:
        hint = ""
        if _DMS.fullmatch(text):
            hint = "this is degrees-minutes-seconds: write dms in the unit column"
        raise AngleError(text, f"a plain number in {_name(unit)}", hint)
    value = float(text)
    return abs(value), value < 0.0


def format_angle(angle: float, unit: AngleUnit, decimals: int = 1) -> str:
    """Write an angle the way it is read: ``179-01-56.0``, ``198.9247`` or ``179.0322``.

    Parameters
    ----------
    angle : float
        Angle [rad]; a negative one is printed with its sign, it is not wrapped.
    unit : AngleUnit
        How to write it.
    decimals : int
        Decimals of the arc-second; gon and degrees get four more, which resolves at least as much.

    Returns
    -------
    str
        The text; never 60 in the seconds.
    """
    sign = "-" if angle < 0.0 else ""
    if unit is not AngleUnit.DMS:
        value = abs(angle) * FULL_CIRCLE[unit] / TWO_PI
        return f"{sign}{value:.{decimals + 4}f}"
    ticks = round(abs(angle) * RHO_ARCSEC * 10**decimals)
    seconds_ticks = 60 * 10**decimals
    minutes_total, rest = divmod(ticks, seconds_ticks)
    degrees, minutes = divmod(minutes_total, 60)
    if not sign and degrees == 360:
        degrees = 0
    whole, fraction = divmod(rest, 10**decimals)
    tail = f".{fraction:0{decimals}d}" if decimals else ""
    return f"{sign}{degrees}-{minutes:02d}-{whole:02d}{tail}"


def arcsec(angle: float) -> float:
    """Convert an angle [rad] to arc-seconds."""
    return angle * RHO_ARCSEC
