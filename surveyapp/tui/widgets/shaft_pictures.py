"""Swings of wires and connecting triangles in braille dots."""

from __future__ import annotations

import itertools

from rich.text import Text
from textual.widget import Widget

from surveyapp.domain.shaft_result import ShaftOrientation
from surveyapp.tui import texts
from surveyapp.tui.views.shafts import swing_title
from surveyapp.tui.widgets.canvas import Canvas

LEAST_ROWS = 4
EDGE = 4
MARGIN = 4
"""Columns that stay free at the right."""


class SwingPictures(Widget):
    """Turning points of every wire on every scale, one above the other."""

    def __init__(self) -> None:
        super().__init__()
        self.shaft: ShaftOrientation | None = None

    def show(self, shaft: ShaftOrientation) -> None:
        """Draw another shaft."""
        self.shaft = shaft
        self.refresh()

    def render(self) -> Text:
        """One picture a swing."""
        width, height = self.size
        swings = () if self.shaft is None else self.shaft.drawing.swings
        if self.shaft is None or not swings or width < 16:
            return Text(texts.S_NO_SWINGS, style="dim")
        rows = max(LEAST_ROWS, height // len(swings) - 1)
        parts = Text()
        for wire, axis, readings in swings:
            parts.append(swing_title(self.shaft, wire, axis) + "\n")
            parts.append_text(draw_swing(readings, width=width, height=rows)).append("\n")
        return parts


def draw_swing(readings: tuple[float, ...], *, width: int, height: int) -> Text:
    """Turning points joined by lines."""
    canvas = Canvas(width, height)
    low, high = min(readings), max(readings)
    span = max(high - low, 1e-9)
    step = (2 * (width - MARGIN) - 2 * EDGE) / max(1, len(readings) - 1)
    places = [
        (EDGE + step * k, (4 * height - 2) * (1.0 - (value - low) / span) + 0.5)
        for k, value in enumerate(readings)
    ]
    for a, b in itertools.pairwise(places):
        canvas.line(a, b)
    return canvas.text()


class TrianglePictures(Widget):
    """Connecting triangles, stretched across: their angle is too small to be seen."""

    def __init__(self) -> None:
        super().__init__()
        self.shaft: ShaftOrientation | None = None

    def show(self, shaft: ShaftOrientation) -> None:
        """Draw another shaft."""
        self.shaft = shaft
        self.refresh()

    def render(self) -> Text:
        """One picture a triangle."""
        width, height = self.size
        triangles = () if self.shaft is None else self.shaft.drawing.triangles
        if not triangles or width < 16:
            return Text(texts.S_NO_TRIANGLES, style="dim")
        rows = max(LEAST_ROWS, height // len(triangles) - 1)
        parts = Text()
        for place, points in triangles:
            parts.append(place + "\n")
            parts.append_text(draw_triangle(points, width=width, height=rows)).append("\n")
        return parts


def draw_triangle(points: tuple[tuple[str, float, float], ...], *, width: int, height: int) -> Text:
    """A triangle along the line from its station to the farthest wire, stretched across."""
    canvas = Canvas(width, height)
    _, e0, n0 = points[0]
    _, e1, n1 = max(points[1:], key=lambda p: (p[1] - e0) ** 2 + (p[2] - n0) ** 2)
    reach = max(((e1 - e0) ** 2 + (n1 - n0) ** 2) ** 0.5, 1e-9)
    u = ((e1 - e0) / reach, (n1 - n0) / reach)
    flat = {
        name: (
            ((e - e0) * u[0] + (n - n0) * u[1]) / reach,
            (e - e0) * u[1] - (n - n0) * u[0],
        )
        for name, e, n in points
    }
    widest = max(max(abs(side) for _, side in flat.values()), 1e-9)
    places = {
        name: (
            EDGE + along * (2 * (width - 2 * MARGIN) - 2 * EDGE),
            2 * height + side / widest * (2 * height - EDGE),
        )
        for name, (along, side) in flat.items()
    }
    names = list(places)
    for i, name in enumerate(names):
        canvas.line(places[name], places[names[(i + 1) % len(names)]])
        canvas.sign(*places[name], name)
    return canvas.text()
