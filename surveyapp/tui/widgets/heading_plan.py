"""The headings of a breakthrough in braille dots, the ellipse at the meeting point enlarged.

Only places on the screen are computed here.
"""

from __future__ import annotations

import itertools
import math

from rich.text import Text
from textual.widget import Widget

from surveyapp.domain.penetration_result import MineDrawing, Prediction
from surveyapp.tui import texts
from surveyapp.tui.cells import cut
from surveyapp.tui.widgets.canvas import Canvas, Paper, draw_ellipse, enlargement

START, GYRO = "■", "G"
MARGIN = 6
NAME_ROOM = 8
"""Columns at the right for the name of a heading that begins there."""
CORRIDOR_DOTS = 26


class HeadingPlan(Widget):
    """Draws the plan of a prediction."""

    def __init__(self) -> None:
        super().__init__()
        self.result: Prediction | None = None

    def show(self, result: Prediction) -> None:
        """Draw another prediction."""
        self.result = result
        self.refresh()

    def render(self) -> Text:
        """The plan, or a sentence where there is none."""
        width, height = self.size
        drawing = None if self.result is None else self.result.drawing
        if self.result is None or drawing is None or width < 16 or height < 5:
            return Text(texts.P_EMPTY, style="dim")
        return draw_headings(self.result, drawing, width=width, height=height)


def draw_headings(result: Prediction, drawing: MineDrawing, *, width: int, height: int) -> Text:
    """The plan in a field of characters, its legend in the last row."""
    canvas = Canvas(width, height - 1)
    every = (place for route in drawing.routes for place in route)
    paper = Paper(canvas, every, margin=MARGIN, name_room=NAME_ROOM)
    for name, route in zip(drawing.names, drawing.routes, strict=True):
        for a, b in itertools.pairwise(route):
            canvas.line(paper(a), paper(b))
        start = paper(route[0])
        canvas.sign(*start, START)
        canvas.sign(start[0] + 4, start[1], name)
    for a, b in drawing.gyro:
        (x0, y0), (x1, y1) = paper(a), paper(b)
        canvas.sign(0.5 * (x0 + x1), 0.5 * (y0 + y1), GYRO)
    factor = enlargement(result.factor * result.ellipse.a_m, paper.scale)
    major, minor = (
        result.factor * axis * factor * paper.scale
        for axis in (result.ellipse.a_m, result.ellipse.b_m)
    )
    draw_ellipse(canvas, paper(drawing.meeting), a=major, b=minor, azimuth=result.ellipse.azimuth)
    limit = _corridor(canvas, result, paper(drawing.meeting), paper.scale * factor)
    legend = texts.P_LEGEND.format(start=START, factor=f"{result.factor:g}", enlarged=f"{factor:g}")
    text = legend + (texts.P_LIMIT if limit else "")
    return canvas.text().append("\n").append(cut(text, width), style="dim")


def _corridor(canvas: Canvas, result: Prediction, at: tuple[float, float], scale: float) -> bool:
    """Dots along the axis at the allowed lateral distance; whether they were drawn."""
    drawing, tolerance = result.drawing, result.tolerance
    if drawing is None or tolerance is None or tolerance.lateral_m is None:
        return False
    sine, cosine = math.sin(drawing.axis_azimuth), math.cos(drawing.axis_azimuth)
    reach = tolerance.lateral_m * scale
    for sign in (-reach, reach):
        for k in range(-CORRIDOR_DOTS, CORRIDOR_DOTS + 1, 3):
            east, north = sign * cosine + k * sine, -sign * sine + k * cosine
            canvas.dot(at[0] + east, at[1] - north)
    return True
