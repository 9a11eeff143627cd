"""The headings of a breakthrough in braille dots, the ellipse at the meeting point enlarged.

Only places on the screen are computed here. Dots are taken for square; north is up.
"""

from __future__ import annotations

import itertools
import math

from rich.text import Text
from textual.widget import Widget

from surveyapp.domain.penetration_result import MineDrawing, Prediction
from surveyapp.tui import texts
from surveyapp.tui.widgets.canvas import Canvas
from surveyapp.tui.widgets.plan import STEPS, enlargement

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


class _Paper:
    """From east and north to dots."""

    def __init__(self, drawing: MineDrawing, canvas: Canvas) -> None:
        every = [place for route in drawing.routes for place in route]
        self.low = [min(p[i] for p in every) for i in (0, 1)]
        span = [max(max(p[i] for p in every) - self.low[i], 1e-3) for i in (0, 1)]
        room = (2 * (canvas.width - NAME_ROOM) - 2 * MARGIN - 1, 4 * canvas.height - 2 * MARGIN - 1)
        self.scale = min(room[0] / span[0], room[1] / span[1])
        self.shift = [MARGIN + 0.5 * (room[i] - span[i] * self.scale) for i in (0, 1)]
        self.bottom = 4 * canvas.height - 1

    def __call__(self, place: tuple[float, float]) -> tuple[float, float]:
        x = self.shift[0] + (place[0] - self.low[0]) * self.scale
        return x, self.bottom - self.shift[1] - (place[1] - self.low[1]) * self.scale


def draw_headings(result: Prediction, drawing: MineDrawing, *, width: int, height: int) -> Text:
    """The plan in a field of characters, its legend in the last row."""
    canvas = Canvas(width, height - 1)
    paper = _Paper(drawing, canvas)
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
    _ellipse(canvas, result, paper(drawing.meeting), paper.scale * factor)
    limit = _corridor(canvas, result, paper(drawing.meeting), paper.scale * factor)
    legend = texts.P_LEGEND.format(start=START, factor=f"{result.factor:g}", enlarged=f"{factor:g}")
    text = legend + (texts.P_LIMIT if limit else "")
    return canvas.text().append("\n").append(text[:width], style="dim")


def _ellipse(canvas: Canvas, result: Prediction, at: tuple[float, float], scale: float) -> None:
    a, b = (result.factor * axis * scale for axis in (result.ellipse.a_m, result.ellipse.b_m))
    t = result.ellipse.azimuth
    for k in range(STEPS):
        u, w = a * math.cos(math.tau * k / STEPS), b * math.sin(math.tau * k / STEPS)
        east, north = u * math.sin(t) + w * math.cos(t), u * math.cos(t) - w * math.sin(t)
        canvas.dot(at[0] + east, at[1] - north)


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
