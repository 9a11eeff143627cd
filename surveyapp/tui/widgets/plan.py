"""The plan of a network in braille dots: sides, ellipses, points and their names.

Only places on the screen are computed here. Dots are taken for square; north is up.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

from rich.text import Text
from textual.widget import Widget

from surveyapp.domain.adjustment import AdjustedPoint, AdjustmentResult
from surveyapp.domain.observations import ObservationKind
from surveyapp.tui import texts
from surveyapp.tui.widgets.swing import BRAILLE, DOTS

FIXED, FREE, GYRO = "■", "●", "G"
ELLIPSE_DOTS = 7.0
"""About the largest half axis in dots."""
STEPS = 48
MARGIN = 4
NAME_ROOM = 6


class PlanCanvas(Widget):
    """Draws an ``AdjustmentResult``."""

    def __init__(self) -> None:
        super().__init__()
        self.result: AdjustmentResult | None = None

    def show(self, result: AdjustmentResult | None) -> None:
        """Draw another network."""
        self.result = result
        self.refresh()

    def render(self) -> Text:
        """The plan, or a sentence where there is none."""
        width, height = self.size
        if self.result is None or width < 16 or height < 5:
            return Text(texts.PLAN_EMPTY, style="dim")
        return draw_plan(self.result, width, height)


def enlargement(largest_m: float, scale: float) -> float:
    """Round factor by which ellipses are enlarged, ``scale`` in dots per metre."""
    if largest_m <= 0.0:
        return 1.0
    wanted = ELLIPSE_DOTS / (largest_m * scale)
    power = 10.0 ** math.floor(math.log10(wanted))
    return max(m * power for m in (1.0, 2.0, 5.0) if m * power <= wanted * (1.0 + 1e-9))


class _Canvas:
    """Cells of braille dots under characters."""

    def __init__(self, width: int, height: int) -> None:
        self.width, self.height = width, height
        self.cells = [[0] * width for _ in range(height)]
        self.signs: dict[tuple[int, int], str] = {}

    def dot(self, x: float, y: float) -> None:
        """Set the dot at x to the right, y down."""
        column, row = round(x), round(y)
        if 0 <= column < 2 * self.width and 0 <= row < 4 * self.height:
            self.cells[row // 4][column // 2] |= DOTS[row % 4][column % 2]

    def line(self, start: tuple[float, float], end: tuple[float, float]) -> None:
        """A straight line of dots."""
        count = max(1, math.ceil(max(abs(end[0] - start[0]), abs(end[1] - start[1]))))
        for k in range(count + 1):
            share = k / count
            x, y = (a + (b - a) * share for a, b in zip(start, end, strict=True))
            self.dot(x, y)

    def sign(self, x: float, y: float, text: str) -> None:
        """A word whose first character stands at a dot, where nothing else is written."""
        column, row = round(x) // 2, round(y) // 4
        places = [(row, column + i) for i in range(len(text))]
        inside = all(0 <= r < self.height and 0 <= c < self.width for r, c in places)
        if inside and not any(place in self.signs for place in places):
            self.signs.update(zip(places, text, strict=True))

    def text(self) -> Text:
        """Characters over dots."""
        lines = []
        for r, row in enumerate(self.cells):
            cells = [chr(BRAILLE + cell) for cell in row]  # leading blanks would be cut off
            for c in range(self.width):
                cells[c] = self.signs.get((r, c), cells[c])
            lines.append("".join(cells))
        return Text("\n".join(lines), no_wrap=True)


def draw_plan(result: AdjustmentResult, width: int, height: int) -> Text:
    """The plan in a field of ``width`` times ``height`` characters, its legend in the last row."""
    points = [p for p in result.points if p.e is not None and p.n is not None]
    if len(points) < 2:
        return Text(texts.PLAN_EMPTY, style="dim")
    canvas = _Canvas(width, height - 1)
    at, scale = _places(points, canvas)
    for a, b in _sides(result):
        if a in at and b in at:
            canvas.line(at[a], at[b])
    axes = [p.ellipse.a_m for p in points if p.ellipse is not None]
    factor = enlargement(max(axes, default=0.0), scale)
    for point in points:
        _ellipse(canvas, point, at[point.name], scale * factor)
        canvas.sign(*at[point.name], FREE if point.ellipse is not None else FIXED)
    for obs in result.observations:
        if obs.kind is ObservationKind.GYRO and obs.at in at and obs.to in at:
            x, y = (0.5 * (p + q) for p, q in zip(at[obs.at], at[obs.to], strict=True))
            canvas.sign(x, y, GYRO)
    for point in points:
        x, y = at[point.name]
        canvas.sign(x + 4, y, point.name)
    gyro = (
        texts.PLAN_GYRO if any(o.kind is ObservationKind.GYRO for o in result.observations) else ""
    )
    legend = texts.PLAN_LEGEND.format(factor=f"{factor:g}", fixed=FIXED, free=FREE) + gyro
    return canvas.text().append("\n").append(legend[:width], style="dim")


def _places(
    points: Iterable[AdjustedPoint], canvas: _Canvas
) -> tuple[dict[str, tuple[float, float]], float]:
    """Place of each point in dots, and dots per metre."""
    known = {p.name: (p.e or 0.0, p.n or 0.0) for p in points}
    low = [min(place[i] for place in known.values()) for i in (0, 1)]
    span = [max(max(place[i] for place in known.values()) - low[i], 1e-3) for i in (0, 1)]
    room = (
        2 * (canvas.width - NAME_ROOM) - 2 * MARGIN - 1,
        4 * canvas.height - 2 * MARGIN - 1,
    )
    scale = min(room[0] / span[0], room[1] / span[1])
    shift = [MARGIN + 0.5 * (room[i] - span[i] * scale) for i in (0, 1)]
    bottom = 4 * canvas.height - 1
    places = {
        name: (shift[0] + (e - low[0]) * scale, bottom - shift[1] - (n - low[1]) * scale)
        for name, (e, n) in known.items()
    }
    return places, scale


def _sides(result: AdjustmentResult) -> list[tuple[str, str]]:
    found: dict[tuple[str, str], None] = {}
    for obs in result.observations:
        for name in (obs.back, obs.to):
            if name and obs.at:
                found[min(obs.at, name), max(obs.at, name)] = None
    return list(found)


def _ellipse(canvas: _Canvas, point: AdjustedPoint, at: tuple[float, float], factor: float) -> None:
    if point.ellipse is None:
        return
    a, b, t = point.ellipse.a_m * factor, point.ellipse.b_m * factor, point.ellipse.azimuth
    for k in range(STEPS):
        u, w = a * math.cos(math.tau * k / STEPS), b * math.sin(math.tau * k / STEPS)
        east, north = u * math.sin(t) + w * math.cos(t), u * math.cos(t) - w * math.sin(t)
        canvas.dot(at[0] + east, at[1] - north)
