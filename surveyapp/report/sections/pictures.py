"""Charts and coverages of sensor results as figures on paper."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

from surveyapp.domain.chart import Chart, Coverage, Picture, Series
from surveyapp.languages import joined, said
from surveyapp.report.blocks import (
    Block,
    Figure,
    Label,
    Line,
    Marker,
    Paragraph,
    Primitive,
    Shape,
    Stroke,
)
from surveyapp.report.plots import WIDTH_MM, Axis, Frame, axis

MARKS: Final[tuple[Shape, ...]] = ("dot", "circle", "cross", "square")
STROKES: Final[dict[str, Stroke]] = {"line": "data", "guide": "limit"}
MOST_MARKS: Final = 400
"""Marks of a curve on paper: more are a smear."""
FEW_MARKS: Final = 40
"""Marks on a line: they only tell which it is."""
SQUARE_MM: Final = 110.0


def picture_blocks(pictures: Sequence[Picture]) -> tuple[Block, ...]:
    """A figure for every picture, what it shows below it."""
    blocks: list[Block] = []
    for picture in pictures:
        figure = chart_figure(picture) if isinstance(picture, Chart) else coverage_figure(picture)
        if figure is None:
            continue
        blocks.append(figure)
        words = [legend(picture)] if isinstance(picture, Chart) else []
        if isinstance(picture, Coverage):
            words.append(said("numbers: readings in a cell; crosses: none"))
        told = joined("; ", [word for word in (*words, picture.note) if word])
        if told:
            blocks.append(Paragraph(told, "small"))
    return tuple(blocks)


def legend(chart: Chart) -> str:
    """Which mark is which curve, where there are several."""
    shown = [s for s in chart.series if s.points]
    if len(shown) < 2:
        return ""
    words = {
        "dot": said("dots"),
        "circle": said("circles"),
        "cross": said("crosses"),
        "square": said("squares"),
    }
    marks = _marks(shown, rings=chart.square)
    parts = []
    for item in shown:
        if _is_dashed(item, rings=chart.square):
            parts.append(joined(": ", (said("dashed"), item.name)))
        else:
            parts.append(joined(": ", (words[marks[item.name]], item.name)))
    return joined(", ", dict.fromkeys(parts))


def _is_dashed(item: Series, *, rings: bool) -> bool:
    """Whether a curve is a dashed line on paper; on a map the bounds are rings about a place."""
    return item.style == "guide" or (rings and item.style == "bound")


def _marks(shown: Sequence[Series], *, rings: bool) -> dict[str, Shape]:
    named = dict.fromkeys(s.name for s in shown if not _is_dashed(s, rings=rings))
    return {name: MARKS[i % len(MARKS)] for i, name in enumerate(named)}


def chart_figure(chart: Chart) -> Figure | None:
    """One chart; None where no curve has a point."""
    shown = [s for s in chart.series if s.points]
    if not shown:
        return None
    across, x_names = _axis(
        [_at(x, log=chart.log_x) for s in shown for x, _ in s.points], log=chart.log_x
    )
    up, _ = _axis([_at(y, log=chart.log_y) for s in shown for _, y in s.points], log=chart.log_y)
    if chart.y_names:
        last = float(len(chart.y_names) - 1)
        up = Axis(-0.4, last + 0.4, tuple(float(i) for i in range(len(chart.y_names))), 0)
    frame = Frame(across, up)
    if chart.square:
        frame, x_names = _squared(frame), []
    label = said("lg of the {label}", label=chart.y_label) if chart.log_y else chart.y_label
    parts = frame.axes(chart.x_label, label, x_names, chart.y_names)
    marks = _marks(shown, rings=chart.square)
    for item in shown:
        points = [(_at(x, log=chart.log_x), _at(y, log=chart.log_y)) for x, y in item.points]
        stroke = "limit" if _is_dashed(item, rings=chart.square) else STROKES.get(item.style)
        if stroke is not None and len(points) > 1:
            parts.append(frame.curve(points, stroke))
        if stroke is None or (item.style == "line" and len(shown) > 1):
            most = MOST_MARKS if item.style == "dots" else FEW_MARKS
            step = max(1, math.ceil(len(points) / most))
            parts += frame.marks(points[::step], marks[item.name])
    return frame.figure(chart.title, parts)


def _at(value: float, *, log: bool) -> float:
    return math.log10(value) if log else value


def _axis(values: Sequence[float], *, log: bool) -> tuple[Axis, list[str]]:
    if not log:
        found = axis(values)
        return found, [f"{tick:.{found.decimals}f}" for tick in found.ticks]
    low, high = math.floor(min(values) + 1e-9), math.ceil(max(values) - 1e-9)
    ticks = tuple(range(low, max(high, low + 1) + 1))
    made = Axis(float(ticks[0]), float(ticks[-1]), tuple(float(tick) for tick in ticks), 0)
    return made, [f"{10.0**tick:g}" for tick in ticks]


def _squared(frame: Frame) -> Frame:
    """Both axes with one scale: the shorter one is widened."""
    x, y = frame.x, frame.y
    ratio = (WIDTH_MM - 24.0) / (SQUARE_MM - 15.0)
    spans = x.high - x.low, y.high - y.low
    wanted = max(spans[0], spans[1] * ratio), max(spans[1], spans[0] / ratio)
    wide, tall = (
        axis([0.5 * (a.low + a.high - w), 0.5 * (a.low + a.high + w)])
        for a, w in ((x, wanted[0]), (y, wanted[1]))
    )
    return Frame(wide, tall, WIDTH_MM, SQUARE_MM)


def coverage_figure(coverage: Coverage) -> Figure | None:
    """Cells with readings are filled with marks, the others are empty."""
    rows = coverage.cells
    if not rows:
        return None
    count = len(rows[0])
    wide, high = (WIDTH_MM - 30.0) / count, 7.0
    height = high * len(rows) + 8.0
    parts: list[Primitive] = []
    for r, row in enumerate(rows):
        y = height - high * (r + 1)
        for c, readings in enumerate(row):
            x = 20.0 + wide * c
            corners = ((x, y), (x + wide, y), (x + wide, y + high), (x, y + high))
            ends = (*corners[1:], corners[0])
            parts += [Line(a, b, "grid") for a, b in zip(corners, ends, strict=True)]
            if readings:
                parts.append(Label((x + 0.5 * wide, y + 0.35 * high), str(readings)))
            else:
                parts.append(Marker((x + 0.5 * wide, y + 0.5 * high), "cross"))
    for c in range(0, count + 1, max(count // 4, 1)):
        parts.append(Label((20.0 + wide * c, 1.5), f"{360 * c // count}"))
    return Figure(coverage.title, WIDTH_MM, height, tuple(parts))
