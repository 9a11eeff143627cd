"""Points, sides, gyro lines and ellipses as a drawing: DXF R12 (AC1009), ASCII.

Source: Autodesk DXF reference, release 12: ELLIPSE and LWPOLYLINE are later, so ellipses are closed
polylines. Everything lies on the layer of its kind.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from surveyapp.domain.exported import ExportedPoint, ExportedSurvey, Written
from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import said

LAYERS = (("STATIONS", 7), ("NAMES", 7), ("SIDES", 8), ("ELLIPSES", 1), ("GYRO", 5))
"""Layers with their colour numbers."""
_CROSS_IN_CIRCLE = "34"
_CORNERS = 48
_SCALES = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10_000, 20_000, 50_000)

Pair = tuple[int, str]


def _ascii(text: str) -> str:
    """Text of R12: other letters by their number, which readers turn back."""
    return "".join(c if " " <= c <= "~" else _code(c) for c in text)


def _code(c: str) -> str:
    """A letter by the numbers of its UTF-16 units, four hexadecimal digits each."""
    data = c.encode("utf-16-be")
    return "".join(f"\\U+{data[i] << 8 | data[i + 1]:04X}" for i in range(0, len(data), 2))


def _place(e: float, n: float, h: float | None, first: int = 10) -> list[Pair]:
    values = (e, n, 0.0 if h is None else h)
    return [(first + 10 * i, f"{value:.4f}") for i, value in enumerate(values)]


def _entity(kind: str, layer: str, pairs: list[Pair]) -> list[Pair]:
    return [(0, kind), (8, layer), *pairs]


def _text(layer: str, at: tuple[float, float], height: float, text: str) -> list[Pair]:
    pairs = _place(at[0], at[1], 0.0)
    return _entity("TEXT", layer, [*pairs, (40, f"{height:.4f}"), (1, _ascii(text))])


def _line(layer: str, a: ExportedPoint, b: ExportedPoint) -> list[Pair]:
    return _entity("LINE", layer, [*_place(a.e, a.n, a.h), *_place(b.e, b.n, b.h, 11)])


def _ellipse(point: ExportedPoint, scale: float) -> Iterator[Pair]:
    """A standard ellipse, enlarged, as a closed polyline around its point."""
    if point.ellipse is None:
        return
    sin, cos = math.sin(point.ellipse.azimuth), math.cos(point.ellipse.azimuth)
    yield from _entity("POLYLINE", "ELLIPSES", [(66, "1"), *_place(0.0, 0.0, 0.0), (70, "1")])
    for i in range(_CORNERS):
        turn = 2.0 * math.pi * i / _CORNERS
        along = point.ellipse.a_m * scale * math.cos(turn)
        across = point.ellipse.b_m * scale * math.sin(turn)
        e, n = point.e + along * sin + across * cos, point.n + along * cos - across * sin
        yield from _entity("VERTEX", "ELLIPSES", _place(e, n, 0.0))
    yield from _entity("SEQEND", "ELLIPSES", [])


def _extent(survey: ExportedSurvey) -> tuple[float, float, float, float]:
    if not survey.points:
        return 0.0, 0.0, 1.0, 1.0
    e, n = [p.e for p in survey.points], [p.n for p in survey.points]
    return min(e), min(n), max(e), max(n)


def _scale(survey: ExportedSurvey, size: float) -> int:
    """Round factor that makes the largest ellipse about a twentieth of the drawing."""
    largest = max((p.ellipse.a_m for p in survey.points if p.ellipse is not None), default=0.0)
    if largest <= 0.0:
        return 1
    return max((s for s in _SCALES if s * largest <= size / 20.0), default=1)


def _head(extent: tuple[float, float, float, float], mark: float) -> list[Pair]:
    """Header and tables; points are drawn as crosses in circles of a size [m] of the drawing."""
    west, south, east, north = extent
    pairs: list[Pair] = [(0, "SECTION"), (2, "HEADER"), (9, "$ACADVER"), (1, "AC1009")]
    pairs += [(9, "$EXTMIN"), *_place(west, south, 0.0), (9, "$EXTMAX"), *_place(east, north, 0.0)]
    pairs += [(9, "$PDMODE"), (70, _CROSS_IN_CIRCLE), (9, "$PDSIZE"), (40, f"{mark:.3f}")]
    pairs += [(0, "ENDSEC"), (0, "SECTION"), (2, "TABLES")]
    pairs += [(0, "TABLE"), (2, "LTYPE"), (70, "1"), (0, "LTYPE"), (2, "CONTINUOUS"), (70, "0")]
    pairs += [(3, "Solid line"), (72, "65"), (73, "0"), (40, "0.0"), (0, "ENDTAB")]
    pairs += [(0, "TABLE"), (2, "LAYER"), (70, str(len(LAYERS)))]
    for name, colour in LAYERS:
        pairs += [(0, "LAYER"), (2, name), (70, "0"), (62, str(colour)), (6, "CONTINUOUS")]
    pairs += [(0, "ENDTAB"), (0, "TABLE"), (2, "STYLE"), (70, "1"), (0, "STYLE")]
    pairs += [(2, "STANDARD"), (70, "0"), (40, "0.0"), (41, "1.0"), (50, "0.0"), (71, "0")]
    pairs += [(42, "1.0"), (3, "txt"), (4, ""), (0, "ENDTAB"), (0, "ENDSEC")]
    return [*pairs, (0, "SECTION"), (2, "ENTITIES")]


def dxf_text(survey: ExportedSurvey) -> Written:
    """A drawing of points, names, sides, gyro lines and ellipses."""
    west, south, east, north = extent = _extent(survey)
    size = max(east - west, north - south, 1.0)
    height, scale = size / 100.0, _scale(survey, size)
    places = survey.place()
    pairs = _head(extent, 0.6 * height)
    for point in survey.points:
        pairs += _entity("POINT", "STATIONS", _place(point.e, point.n, point.h))
        at = (point.e + 0.6 * height, point.n + 0.6 * height)
        pairs += _text("NAMES", at, height, point.name)
    for layer, lines in (("SIDES", survey.sides), ("GYRO", survey.gyro)):
        for a, b in lines:
            if a in places and b in places:
                pairs += _line(layer, places[a], places[b])
    drawn = [p for p in survey.points if p.ellipse is not None and p.ellipse.a_m > 0.0]
    for point in drawn:
        pairs += list(_ellipse(point, float(scale)))
    if drawn:
        text = f"standard ellipses (1 sigma) enlarged {scale} times"
        pairs += _text("ELLIPSES", (west, south - 4.0 * height), height, text)
    pairs += [(0, "ENDSEC"), (0, "EOF")]
    body = "".join(f"{code:>3}\n{value}\n" for code, value in pairs)
    return Written(body, len(survey.points), _told(survey))


def _told(survey: ExportedSurvey) -> tuple[ResultWarning, ...]:
    flat = [p.name for p in survey.points if p.h is None]
    if not flat or len(flat) == len(survey.points):
        return ()
    text = said("points without a height are drawn at height 0: {names}", names=", ".join(flat))
    return (ResultWarning("height_zero", text),)
