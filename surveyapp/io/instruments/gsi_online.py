"""Leica GSI Online: words 21, 22, 31 on request, each with its own unit.

Source: Leica TPS Online (GSI) manual: ``GET/M/WI21/WI22/WI31`` measures, ``GET/I/...`` takes what
is there; errors come as ``@W`` or ``@E`` with a number.
"""

from __future__ import annotations

import math

from surveyapp.domain.instrument_reading import InstrumentReading
from surveyapp.io.importers.fieldfiles.gsi_words import Word, WordError, words
from surveyapp.io.importers.fieldfiles.units import FOOT
from surveyapp.io.instruments.cable import Cable, cable_problem
from surveyapp.languages import said

_MEASURE_S = 15.0


def _words(cable: Cable, request: str, timeout_s: float | None = None) -> dict[str, Word]:
    answer = cable.ask(f"{request}\r\n".encode("ascii"), timeout_s=timeout_s)
    if answer[:2] in ("@W", "@E"):
        hint = "is it levelled, and is a prism in sight?"
        raise cable_problem("the instrument refuses", cable.port, answer, hint)
    try:
        return {word.word_index: word for word in words(answer)}
    except WordError as error:
        hint = "is the instrument in GSI online mode?"
        raise cable_problem(
            said("this is no answer of GSI: {error}", error=error), cable.port, answer, hint
        ) from None


def _reading(cable: Cable, found: dict[str, Word]) -> InstrumentReading:
    try:
        if "21" not in found:
            raise WordError("word 21 is missing")
        hz = found["21"].angle()
        v = found["22"].angle() if "22" in found and not found["22"].empty else None
        length = None
        if "31" in found and not found["31"].empty:
            length = found["31"].length(FOOT)[0] or None
    except WordError as error:
        raise cable_problem(error.args[0], cable.port) from None
    if not (0.0 <= hz <= 2.0 * math.pi and (v is None or 0.0 <= v <= 2.0 * math.pi)):
        raise cable_problem("the angles are beyond the circle", cable.port)
    return InstrumentReading(math.fmod(hz, 2.0 * math.pi), v, length, f"GSI Online on {cable.port}")


def read_angles(cable: Cable) -> InstrumentReading:
    """Circle and zenith as they are now."""
    return _reading(cable, _words(cable, "GET/I/WI21/WI22"))


def read_all(cable: Cable) -> InstrumentReading:
    """Measure a distance and read everything."""
    return _reading(cable, _words(cable, "GET/M/WI21/WI22/WI31", _MEASURE_S))
