"""What a surveyor types at the instrument, completed to the text of a field-book row.

A reading may be typed in full, packed (179.0156 for 179-01-56), or in part: minutes and seconds,
or seconds alone, where the rest is known from a reading nearby. The text that goes into the book
keeps the decimals as they were typed, because they tell the resolution. Nothing here knows a
screen, a file or a clock.
"""

from __future__ import annotations

import math
import re
import unicodedata
from dataclasses import dataclass
from typing import Final

from surveyapp.languages import said
from surveyapp_models.angles import (
    FULL_CIRCLE,
    TWO_PI,
    AngleError,
    AngleUnit,
    parse_angle,
    wrap_two_pi,
)

__all__ = ["Entry", "EntryError", "complete_angle", "complete_number", "plain_signs"]


class EntryError(ValueError):
    """A text that cannot be a reading.

    Attributes
    ----------
    what : str
    expected : str
        What would be accepted.
    """

    def __init__(self, what: str, expected: str = "") -> None:
        super().__init__(what)
        self.what = what
        self.expected = expected


@dataclass(frozen=True, slots=True)
class Entry:
    """A reading as understood.

    Parameters
    ----------
    value : float
        Angles [rad] in [0, 2 pi), other readings in ``unit``.
    text : str
        As it goes into the book.
    unit : str
        Unit token of the book.
    completed : bool
        Whether a part of it was taken from the reading nearby.
    """

    value: float
    text: str
    unit: str
    completed: bool = False


_SIGNS: Final = {"\u3002": ".", "\u3000": " ", "\u2212": "-", "\u2013": "-"}
_SECONDS: Final = re.compile(r"\d{1,2}(?:\.\d*)?")
_MINUTES_SECONDS: Final = re.compile(r"(\d{1,2})[-:'′ ]+(\d{1,2}(?:\.\d*)?)[\"″]?")
_PACKED: Final = re.compile(r"(\d{1,3})\.(\d{2})(\d{2})(\d*)")
_NUMBER: Final = re.compile(r"[+\-−]?(?:\d+\.?\d*|\.\d+)")
_SUFFIX: Final = {
    "g": AngleUnit.GON,
    "gon": AngleUnit.GON,
    "d": AngleUnit.DEG,
    "deg": AngleUnit.DEG,
}
_SUFFIXED: Final = re.compile(r"(.*?[\d.])\s*(gon|deg|g|d)")


def plain_signs(text: str) -> str:
    """Digits and signs of any keyboard as those of the book.

    Digits of every script, the full-width signs of a Chinese keyboard and its full stop; letters
    stay what they are.
    """
    plain = []
    for character in text:
        if character.isdecimal():
            plain.append(str(unicodedata.decimal(character)))
        elif "\uff01" <= character <= "\uff5e":
            plain.append(chr(ord(character) - 0xFEE0))
        else:
            plain.append(_SIGNS.get(character, character))
    return "".join(plain)


def complete_angle(
    text: str, *, unit: AngleUnit, packed: bool = False, near: float | None = None
) -> Entry:
    """Understand a typed circle reading.

    Parameters
    ----------
    text : str
        In full in ``unit`` (dms: ``179-01-56``, ``179 01 56``, ``179:01:56``, ``179°01'56"``);
        packed where chosen (``179.0156``, decimals of the second follow); minutes and seconds, or
        seconds alone (dms), or the decimals alone, ``.9247`` (gon, deg), where ``near`` is given.
        A trailing ``g`` or ``d`` says gon or decimal degrees whatever the project's unit is.
    unit : AngleUnit
        The project's unit.
    packed : bool
        Whether a plain number means packed degrees-minutes-seconds; dms only.
    near : float or None
        A reading [rad] whose leading part the typed one shares: the nearest such angle is meant.

    Returns
    -------
    Entry

    Raises
    ------
    EntryError
        If the text cannot be a circle reading.
    """
    typed = " ".join(text.strip().replace("−", "-").split())
    suffixed = _SUFFIXED.fullmatch(typed.lower())
    if suffixed:
        return _plain(suffixed[1], _SUFFIX[suffixed[2]], near)
    if unit is not AngleUnit.DMS:
        return _plain(typed, unit, near)
    if _PACKED.fullmatch(typed) or (_is_decimal(typed) and packed):
        return _packed(typed, allowed=packed)
    if match := _MINUTES_SECONDS.fullmatch(typed):
        return _partial(minutes=match[1], seconds=match[2], near=near)
    if _SECONDS.fullmatch(typed):
        return _partial(minutes=None, seconds=typed.removesuffix("."), near=near)
    return _whole(typed)


def _is_decimal(text: str) -> bool:
    return "." in text and _NUMBER.fullmatch(text) is not None


def _whole(typed: str) -> Entry:
    try:
        value = parse_angle(typed, AngleUnit.DMS)
    except AngleError as error:
        raise EntryError(said("{typed} is no angle", typed=typed), error.expected) from None
    if value < 0.0:
        raise EntryError(said("a circle reading is not negative"), said("0 to 360 degrees"))
    numbers = re.findall(r"\d+(?:\.\d*)?", typed)
    degrees, minutes, seconds = numbers
    return Entry(wrap_two_pi(value), _dms(int(degrees), int(minutes), seconds), "dms")


def _packed(typed: str, *, allowed: bool) -> Entry:
    match = _PACKED.fullmatch(typed)
    if match is None:
        raise EntryError(
            said("{typed} is no packed angle", typed=typed), said("degrees.MMSS like 179.0156")
        )
    if not allowed:
        raise EntryError(
            said("{typed} may be packed degrees or decimal degrees", typed=typed),
            said("179-01-56, or 179.0322d for decimal degrees"),
        )
    seconds = match[3] + (f".{match[4]}" if match[4] else "")
    return _whole(f"{match[1]}-{match[2]}-{seconds}")


def _partial(*, minutes: str | None, seconds: str, near: float | None) -> Entry:
    """Complete to the nearest angle with these minutes and seconds."""
    if near is None:
        raise EntryError(
            said("the rest of the reading is not known yet"), said("the whole reading")
        )
    if float(seconds) >= 60.0 or (minutes is not None and int(minutes) >= 60):
        raise EntryError(said("minutes and seconds are below 60"), said("like 01-56 or 56"))
    total = float(seconds) + (60 * int(minutes) if minutes is not None else 0)
    step = 3600.0 if minutes is not None else 60.0
    turn = FULL_CIRCLE[AngleUnit.DMS] * 3600.0
    reference = wrap_two_pi(near) / TWO_PI * turn
    count = round((reference - total) / step)
    whole = round(count * step) % round(turn)
    whole_minutes = whole // 60 + (int(minutes) if minutes is not None else 0)
    degrees, rest = divmod(whole_minutes % (360 * 60), 60)
    text = _dms(degrees, rest, seconds)
    return Entry(wrap_two_pi(parse_angle(text, AngleUnit.DMS)), text, "dms", completed=True)


def _dms(degrees: int, minutes: int, seconds: str) -> str:
    whole, point, fraction = seconds.partition(".")
    tail = f".{fraction}" if point and fraction else ""
    return f"{degrees % 360}-{minutes:02d}-{int(whole):02d}{tail}"


def _plain(typed: str, unit: AngleUnit, near: float | None) -> Entry:
    full = FULL_CIRCLE[unit]
    if _NUMBER.fullmatch(typed) is None:
        name = "gon" if unit is AngleUnit.GON else said("decimal degrees")
        raise EntryError(
            said("{typed} is no angle in {name}", typed=typed, name=name),
            said("a plain number in {name}", name=name),
        )
    if typed.startswith("."):
        if near is None:
            raise EntryError(
                said("the rest of the reading is not known yet"), said("the whole reading")
            )
        whole = round(wrap_two_pi(near) / TWO_PI * full - float(typed)) % round(full)
        text = f"{whole}{typed}"
        return Entry(float(text) / full * TWO_PI, text, str(unit), completed=True)
    value = float(typed)
    if not 0.0 <= value <= full:
        raise EntryError(said("{typed} is not on the circle", typed=typed), f"0 to {full:g}")
    text = typed.lstrip("+")
    return Entry(wrap_two_pi(value / full * TWO_PI), text, str(unit))


def complete_number(text: str, *, unit: str, largest: float) -> Entry:
    """Understand a typed scale reading, level, temperature or supply value.

    Parameters
    ----------
    text : str
        A number with or without sign.
    unit : str
        Unit token of the book.
    largest : float
        Largest magnitude that is possible.

    Raises
    ------
    EntryError
        If the text is no number, or is impossible.
    """
    typed = text.strip().replace("−", "-")
    if _NUMBER.fullmatch(typed) is None:
        hint = said("decimals with a point") if "," in typed else ""
        raise EntryError(
            said("{typed} is no number", typed=typed), hint or said("a number in {unit}", unit=unit)
        )
    value = float(typed)
    if not math.isfinite(value) or abs(value) > largest:
        raise EntryError(
            said("{typed} {unit} is impossible", typed=typed, unit=unit),
            said("at most {largest:g} {unit}", largest=largest, unit=unit),
        )
    return Entry(value, typed, unit)
