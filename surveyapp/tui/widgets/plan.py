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
from surveyapp.tui.widgets.canvas import Canvas

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


def draw_plan(result: AdjustmentResult, width: int, height: int) -> Text:
    """The plan in a field of ``width`` times ``height`` characters, its legend in the last row."""
    points = [p for p in result.points if p.e is not None and p.n is not None]
    if len(points) < 2:
        return Text(texts.PLAN_EMPTY, style="dim")
    canvas = Canvas(width, height - 1)
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
    points: Iterable[AdjustedPoint], canvas: Canvas
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


def _ellipse(canvas: Canvas, point: AdjustedPoint, at: tuple[float, float], factor: float) -> None:
    if point.ellipse is None:
        return
    a, b, t = point.ellipse.a_m * factor, point.ellipse.b_m * factor, point.ellipse.azimuth
    for k in range(STEPS):
        u, w = a * math.cos(math.tau * k / STEPS), b * math.sin(math.tau * k / STEPS)
        east, north = u * math.sin(t) + w * math.cos(t), u * math.cos(t) - w * math.sin(t)
        canvas.dot(at[0] + east, at[1] - north)
