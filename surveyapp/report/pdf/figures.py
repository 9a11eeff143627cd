"""Figures on paper: the vector primitives of a block."""

from __future__ import annotations

from typing import Any, Final

from reportlab.graphics.shapes import Circle, Drawing, Group, PolyLine, Rect, Shape, String
from reportlab.graphics.shapes import Line as DrawnLine
from reportlab.lib import colors
from reportlab.lib.units import mm
from reportlab.pdfbase import pdfmetrics
from reportlab.platypus import Flowable
from reportlab.platypus import Paragraph as Text

from surveyapp.report.blocks import Figure, Label, Line, Marker, Polyline, Primitive
from surveyapp.report.pdf.fonts import Faces
from surveyapp.report.pdf.style import ACCENT, CELL, INK, PALE, QUIET, style_of

STROKES: Final[dict[str, tuple[colors.Color, float, Any]]] = {
    "axis": (INK, 0.5, ()),
    "grid": (PALE, 0.3, ()),
    "data": (ACCENT, 0.8, ()),
    "mean": (INK, 0.8, (6, 2)),
    "limit": (QUIET, 0.6, (2, 2)),
    "bar": (ACCENT, 0.8, ()),
}


def figure_flowables(block: Figure, faces: Faces) -> list[Flowable]:
    """A figure under its title, as vectors."""
    drawing = Drawing(block.width_mm * mm, block.height_mm * mm)
    for item in block.primitives:
        for shape in _shapes(item, faces):
            drawing.add(shape)
    title = Text(faces.markup(block.title), style_of(CELL + 0.5, textColor=QUIET, spaceAfter=1.0))
    return [title, drawing]


def _shapes(item: Primitive, faces: Faces) -> list[Shape]:
    match item:
        case Line(start=start, end=end, stroke=stroke):
            color, width, dash = STROKES[stroke]
            points = (start[0] * mm, start[1] * mm, end[0] * mm, end[1] * mm)
            return [DrawnLine(*points, strokeColor=color, strokeWidth=width, **_dashed(dash))]
        case Polyline(points=points, stroke=stroke):
            color, width, dash = STROKES[stroke]
            flat = [value * mm for point in points for value in point]
            return [PolyLine(flat, strokeColor=color, strokeWidth=width, **_dashed(dash))]
        case Marker():
            return _marker(item)
        case Label():
            return _label(item, faces)


def _dashed(dash: tuple[int, ...]) -> dict[str, Any]:
    return {"strokeDashArray": dash} if dash else {}


def _marker(item: Marker) -> list[Shape]:
    x, y = item.at[0] * mm, item.at[1] * mm
    pen: dict[str, Any] = {"strokeColor": ACCENT, "strokeWidth": 0.8}
    if item.shape == "cross":
        return [
            DrawnLine(x - 2, y - 2, x + 2, y + 2, **pen),
            DrawnLine(x - 2, y + 2, x + 2, y - 2, **pen),
        ]
    if item.shape == "square":
        return [Rect(x - 1.8, y - 1.8, 3.6, 3.6, **{**pen, "fillColor": colors.white})]
    fill = ACCENT if item.shape == "dot" else colors.white
    return [Circle(x, y, 1.3 if item.shape == "dot" else 1.9, fillColor=fill, **pen)]


def _label(item: Label, faces: Faces) -> list[Shape]:
    size = 6.5
    parts: list[Shape] = []
    x = -faces.width(item.text, size) * {"start": 0.0, "middle": 0.5, "end": 1.0}[item.anchor]
    for name, run in faces.split(item.text):
        parts.append(String(x, 0, run, fontName=name, fontSize=size, fillColor=INK))
        x += pdfmetrics.stringWidth(run, name, size)
    group = Group(*parts)
    group.translate(item.at[0] * mm, item.at[1] * mm)
    if item.upright:
        group.rotate(90)
    return [group]
