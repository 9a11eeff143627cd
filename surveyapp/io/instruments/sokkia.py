"""Sokkia two-way commands (SET and those that follow it): 00H angles, 11H distance and angles.

The answer has no units; the instrument is asked for its settings (B) first and refused unless it is
set to metres, degrees and zenith angles.

Source: Sokkia, Two way communication commands (SET series): ``1999999 1999999 1999999 [SUM]``:
slope distance in mm, vertical and horizontal angle as DDDMMSS.
"""

from __future__ import annotations

import math
import re

from surveyapp.domain.instrument_reading import InstrumentReading
from surveyapp.io.instruments.cable import Cable, cable_problem
from surveyapp.languages import said

_ANSWER = re.compile(r"(\S+)\s+(-?\d{1,7})\s+(-?\d{1,7})(?:\s+\S+)?")
_MEASURE_S = 15.0
_SETTINGS = ((1, "0", "metres"), (5, "0", "degrees"), (7, "0", "zenith angles"))
"""Place in the answer to B, wanted value, its name."""


def _check_settings(cable: Cable) -> None:
    answer = cable.ask(b"B\r\n")
    parts = [part.strip() for part in answer.replace("B_", "B,").replace("B ", "B,").split(",")]
    if parts[0] != "B" or len(parts) < 8:
        hint = "is the instrument in measuring mode?"
        raise cable_problem("this is no answer of the settings", cable.port, answer, hint)
    wrong = [name for place, value, name in _SETTINGS if parts[place] != value]
    if wrong:
        hint = said("set it to {names}", names=", ".join(wrong))
        raise cable_problem("the instrument is set to other units", cable.port, answer, hint)


def _angle(cable: Cable, text: str) -> float:
    digits = int(text)
    seconds, minutes, degrees = digits % 100, digits // 100 % 100, digits // 10000
    if digits < 0 or seconds > 59 or minutes > 59 or degrees > 359:
        raise cable_problem("an angle is no DDDMMSS", cable.port, text)
    return math.radians(degrees + minutes / 60.0 + seconds / 3600.0)


def _read(cable: Cable, command: bytes, timeout_s: float | None) -> InstrumentReading:
    _check_settings(cable)
    answer = cable.ask(command + b"\r\n", timeout_s=timeout_s)
    if answer.startswith("E"):
        hint = "is it levelled, and is a prism in sight?"
        raise cable_problem("the instrument refuses", cable.port, answer, hint)
    match = _ANSWER.fullmatch(answer)
    if match is None:
        raise cable_problem("this is no answer of a reading", cable.port, answer)
    length = int(match[1]) * 1e-3 if re.fullmatch(r"\d+", match[1]) else None
    v, hz = _angle(cable, match[2]), _angle(cable, match[3])
    return InstrumentReading(hz, v, length or None, f"Sokkia on {cable.port}")


def read_angles(cable: Cable) -> InstrumentReading:
    """Circle and zenith as they are now."""
    return _read(cable, b"\x00", None)


def read_all(cable: Cable) -> InstrumentReading:
    """Measure a distance and read everything."""
    return _read(cable, b"\x11", _MEASURE_S)
