"""The plan of a network in braille dots: sides, ellipses, points and their names.

Only places on the screen are computed here.
"""

from __future__ import annotations

from rich.text import Text
from textual.widget import Widget

from surveyapp.domain.adjustment import AdjustmentResult
from surveyapp.domain.observations import ObservationKind
from surveyapp.tui import texts
from surveyapp.tui.cells import cut
from surveyapp.tui.widgets.canvas import Canvas, Paper, draw_ellipse, enlargement

FIXED, FREE, GYRO = "■", "●", "G"
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


def draw_plan(result: AdjustmentResult, width: int, height: int) -> Text:
    """The plan in a field of ``width`` times ``height`` characters, its legend in the last row."""
    points = [p for p in result.points if p.e is not None and p.n is not None]
    if len(points) < 2:
        return Text(texts.PLAN_EMPTY, style="dim")
    canvas = Canvas(width, height - 1)
    known = {p.name: (p.e or 0.0, p.n or 0.0) for p in points}
    paper = Paper(canvas, known.values(), margin=MARGIN, name_room=NAME_ROOM)
    at = {name: paper(place) for name, place in known.items()}
    for start, end in _sides(result):
        if start in at and end in at:
            canvas.line(at[start], at[end])
    axes = [p.ellipse.a_m for p in points if p.ellipse is not None]
    factor = enlargement(max(axes, default=0.0), paper.scale)
    for point in points:
        if point.ellipse is not None:
            ellipse, dots = point.ellipse, factor * paper.scale
            a, b = ellipse.a_m * dots, ellipse.b_m * dots
            draw_ellipse(canvas, at[point.name], a=a, b=b, azimuth=ellipse.azimuth)
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
    return canvas.text().append("\n").append(cut(legend, width), style="dim")


def _sides(result: AdjustmentResult) -> list[tuple[str, str]]:
    found: dict[tuple[str, str], None] = {}
    for obs in result.observations:
        for name in (obs.back, obs.to):
            if name and obs.at:
                found[min(obs.at, name), max(obs.at, name)] = None
    return list(found)
