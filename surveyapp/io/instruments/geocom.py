"""Leica GeoCOM, ASCII: angles in radians, distances in metres whatever the display shows.

Source: Leica TPS1200 GeoCOM reference manual: request ``%R1Q,RPC:parameters``, answer
``%R1P,com,transaction:rc,values``; TMC_DoMeasure 2008, TMC_GetSimpleMea 2108, TMC_GetAngle5 2107.
"""

from __future__ import annotations

import math
import re
from typing import Final

from surveyapp.domain.instrument_reading import InstrumentReading
from surveyapp.errors import SurveyError
from surveyapp.io.instruments.cable import Cable, cable_problem

_ANSWER = re.compile(r"%R1P,(\d+),\d+:(\d+)(?:,(.*))?")
_GOOD: Final = (0, 1283, 1284)
"""Done; done without full correction; done, accuracy not guaranteed."""
_ANGLE_ONLY: Final = (1285, 1288, 1289)
_REASONS: Final = {
    3: "the instrument does not know this request",
    5: "the instrument is switched off",
    1285: "angles are good, the distance is not",
    1286: "the angles cannot be measured: is it levelled?",
    1292: "the instrument is busy",
    3077: "no prism was found",
}
_MEASURE_S: Final = 15.0


def _ask(cable: Cable, request: str, timeout_s: float | None = None) -> tuple[int, list[str]]:
    answer = cable.ask(f"%R1Q,{request}\r\n".encode("ascii"), timeout_s=timeout_s)
    match = _ANSWER.fullmatch(answer)
    if match is None:
        hint = "is the instrument in GeoCOM mode?"
        raise cable_problem("this is no answer of GeoCOM", cable.port, answer, hint)
    code = int(match[1]) or int(match[2])
    return code, (match[3] or "").split(",") if match[3] else []


def _refused(cable: Cable, code: int) -> SurveyError:
    reason = _REASONS.get(code, "the instrument refuses")
    return cable_problem(reason, cable.port, f"return code {code}")


def _numbers(cable: Cable, values: list[str], count: int) -> list[float]:
    try:
        found = [float(text) for text in values[:count]]
    except ValueError:
        found = []
    if len(found) < count or not all(math.isfinite(value) for value in found):
        raise cable_problem("the answer holds no reading", cable.port, ",".join(values))
    return found


def _checked(cable: Cable, hz: float, v: float) -> tuple[float, float]:
    if not (0.0 <= hz < 6.2832 and 0.0 <= v < 6.2832):
        hint = "GeoCOM gives radians"
        raise cable_problem("the angles are no radians of a circle", cable.port, f"{hz}, {v}", hint)
    return hz, v


def read_angles(cable: Cable) -> InstrumentReading:
    """Circle and zenith as they are now."""
    code, values = _ask(cable, "2107:1")
    if code not in (*_GOOD, *_ANGLE_ONLY):
        raise _refused(cable, code)
    hz, v = _checked(cable, *_numbers(cable, values, 2))
    return InstrumentReading(hz, v, None, f"GeoCOM on {cable.port}")


def read_all(cable: Cable) -> InstrumentReading:
    """Measure a distance and read everything; angles alone where there is no distance."""
    code, _ = _ask(cable, "2008:1,1", _MEASURE_S)
    if code not in _GOOD:
        raise _refused(cable, code)
    code, values = _ask(cable, "2108:5000,1", _MEASURE_S)
    if code in _ANGLE_ONLY:
        return read_angles(cable)
    if code not in _GOOD:
        raise _refused(cable, code)
    hz, v, length = _numbers(cable, values, 3)
    _checked(cable, hz, v)
    return InstrumentReading(hz, v, length or None, f"GeoCOM on {cable.port}")
