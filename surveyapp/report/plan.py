"""The plan of a network as vector primitives: points, sides, gyro sides, error ellipses.

Equal scale in both directions, north up. Ellipses are enlarged by a round factor that the figure
names. What the adjustment says is taken as it is.
"""

from __future__ import annotations

import math
from typing import Final

from surveyapp.domain.adjustment import AdjustedPoint, AdjustmentResult
from surveyapp.domain.observations import ObservationKind
from surveyapp.languages import said
from surveyapp.report.blocks import Figure, Label, Line, Marker, Polyline, Primitive

WIDTH_MM: Final = 170.0
LEAST_MM, MOST_MM, MARGIN_MM = 50.0, 150.0, 14.0
ELLIPSE_MM: Final = 9.0
"""About the largest half axis on paper."""
STEPS: Final = 36
NAMED: Final = 150
"""Points up to which every one has its name."""


def round_below(value: float) -> float:
    """Largest 1, 2 or 5 times a power of ten that is not above a positive value."""
    power = 10.0 ** math.floor(math.log10(value) + 1e-12)
    return max(
        (m * power for m in (1.0, 2.0, 5.0) if m * power <= value * (1 + 1e-9)), default=power
    )


def plan_figure(result: AdjustmentResult, *, confidence: float = 1.0) -> Figure | None:
    """Figure of a network with coordinates in the plane, else None.

    Parameters
    ----------
    result : AdjustmentResult
    confidence : float
        Factor from a standard ellipse to the drawn one, before the enlargement.
    """
    places = {p.name: (p.e, p.n) for p in result.points if p.e is not None and p.n is not None}
    at = {name: (e, n) for name, (e, n) in places.items() if e is not None and n is not None}
    if len(at) < 2:
        return None
    low = [min(point[i] for point in at.values()) for i in (0, 1)]
    span = [max(max(point[i] for point in at.values()) - low[i], 1e-3) for i in (0, 1)]
    scale = min((WIDTH_MM - 2 * MARGIN_MM) / span[0], (MOST_MM - 2 * MARGIN_MM) / span[1])
    height = max(LEAST_MM, span[1] * scale + 2 * MARGIN_MM)
    shift = (0.5 * (WIDTH_MM - span[0] * scale), 0.5 * (height - span[1] * scale))
    paper = {
        name: (shift[0] + (e - low[0]) * scale, shift[1] + (n - low[1]) * scale)
        for name, (e, n) in at.items()
    }
    axes = [p.ellipse.a_m for p in result.points if p.ellipse is not None and p.name in at]
    largest = max(axes, default=0.0) * confidence
    enlarged = round_below(ELLIPSE_MM / (largest * scale)) if largest > 0.0 else 1.0
    parts = [*_sides(result, paper), *_scale_bar(scale)]
    for point in result.points:
        if point.name in paper:
            factor = scale * enlarged * confidence
            parts += _point(point, paper[point.name], factor)
            if len(paper) <= NAMED:
                parts.append(_name(point, paper[point.name], factor))
    kind = said("standard") if confidence == 1.0 else said("confidence")
    title = said(
        "Plan, north up; {kind} ellipses {enlarged:g} times enlarged", kind=kind, enlarged=enlarged
    )
    if any(o.kind is ObservationKind.GYRO for o in result.observations):
        title += said("; sides with an arrow are gyro sides")
    return Figure(title, WIDTH_MM, height, tuple(parts))


def _sides(result: AdjustmentResult, paper: dict[str, tuple[float, float]]) -> list[Primitive]:
    sides: dict[frozenset[str], None] = {}
    gyro: dict[tuple[str, str], None] = {}
    for obs in result.observations:
        for name in (obs.back, obs.to):
            if name and name in paper and obs.at in paper:
                sides[frozenset((obs.at, name))] = None
        if obs.kind is ObservationKind.GYRO:
            gyro[obs.at, obs.to] = None
    parts: list[Primitive] = []
    measured = {frozenset(pair) for pair in gyro}
    for side in sides:
        a, b = sorted(side)
        parts.append(Line(paper[a], paper[b], "bar" if side in measured else "axis"))
    for a, b in gyro:
        if a in paper and b in paper:
            parts += _arrow(paper[a], paper[b])
    return parts


def _arrow(start: tuple[float, float], end: tuple[float, float]) -> list[Primitive]:
    """Head of an arrow in the middle of a side."""
    dx, dy = end[0] - start[0], end[1] - start[1]
    length = math.hypot(dx, dy)
    if length < 1e-9:
        return []
    u, v = dx / length, dy / length
    tip = (0.5 * (start[0] + end[0]) + 1.2 * u, 0.5 * (start[1] + end[1]) + 1.2 * v)
    return [
        Line(tip, (tip[0] - 2.4 * u - s * 1.1 * v, tip[1] - 2.4 * v + s * 1.1 * u), "bar")
        for s in (1.0, -1.0)
    ]


def _point(point: AdjustedPoint, at: tuple[float, float], factor: float) -> list[Primitive]:
    if point.ellipse is None:
        return [Marker(at, "square")]
    a, b, t = point.ellipse.a_m * factor, point.ellipse.b_m * factor, point.ellipse.azimuth
    curve = []
    for k in range(STEPS + 1):
        u, w = a * math.cos(math.tau * k / STEPS), b * math.sin(math.tau * k / STEPS)
        east, north = u * math.sin(t) + w * math.cos(t), u * math.cos(t) - w * math.sin(t)
        curve.append((at[0] + east, at[1] + north))
    return [Polyline(tuple(curve), "data"), Marker(at, "dot")]


def _name(point: AdjustedPoint, at: tuple[float, float], factor: float) -> Label:
    """Name of a point, to the right of its ellipse."""
    reach = 0.6
    if point.ellipse is not None:
        e = point.ellipse
        reach = factor * math.hypot(e.a_m * math.sin(e.azimuth), e.b_m * math.cos(e.azimuth))
    return Label((at[0] + reach + 1.2, at[1] + 0.6), point.name, "start")


def _scale_bar(scale: float) -> list[Primitive]:
    length = round_below(40.0 / scale)
    end = 4.0 + length * scale
    ticks = [Line((x, 3.2), (x, 4.8), "axis") for x in (4.0, end)]
    return [
        Line((4.0, 4.0), (end, 4.0), "axis"),
        *ticks,
        Label((end + 1.5, 3.2), said("{length:g} m", length=length), "start"),
    ]
