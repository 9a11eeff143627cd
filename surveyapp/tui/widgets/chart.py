"""A chart of a result in braille dots with its axes, and a coverage as a field of cells.

Only places on the screen are computed here; what is drawn comes with the result.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

from rich.text import Text
from textual.widget import Widget

from surveyapp.domain.chart import Chart, Coverage, Picture, Series
from surveyapp.languages import shown
from surveyapp.report.plots import axis
from surveyapp.tui import texts
from surveyapp.tui.cells import columns, cut, lines_of, padded
from surveyapp.tui.widgets.canvas import Canvas

LEAST_WIDTH, LEAST_HEIGHT = 30, 8
MARKS = "ox+*#"
"""Signs of the curves that are dots, in their order."""
SHADES = ".:+#"
"""Cells with few readings up to many, by their logarithm; an empty cell is a blank."""
BOUND = "-"
SIGNS = {"line": "─", "dots": "·", "guide": "┄"}
LINE_MARKS = 12
"""Signs on a line: they only tell which it is."""
BRAILLE_SHARE = 60
"""Dots of a curve above which they are drawn as dots, not as signs."""


class ChartPane(Widget):
    """Draws one picture."""

    def __init__(self) -> None:
        super().__init__()
        self.picture: Picture | None = None

    def show(self, picture: Picture | None) -> None:
        """Draw another picture."""
        self.picture = picture
        self.refresh()

    def render(self) -> Text:
        """The picture, or a sentence where there is none."""
        width, height = self.size
        if self.picture is None:
            return Text(texts.CHART_NONE, style="dim")
        if width < LEAST_WIDTH or height < LEAST_HEIGHT:
            return Text(texts.CHART_SMALL, style="dim")
        if isinstance(self.picture, Coverage):
            return coverage_text(self.picture, width=width)
        return chart_text(self.picture, width=width, height=height)


class _Scale:
    """From the values of one axis to places on the screen."""

    def __init__(self, values: Sequence[float], *, log: bool, names: int = 0) -> None:
        self.log = log
        if names:
            self.low, self.high = -0.4, names - 0.6
            self.ticks = [float(i) for i in range(names)]
            self.decimals = 0
            return
        if log:
            powers = [math.log10(v) for v in values]
            self.low, self.high = math.floor(min(powers) + 1e-9), math.ceil(max(powers) - 1e-9)
            self.high = max(self.high, self.low + 1)
            self.ticks = [float(p) for p in range(int(self.low), int(self.high) + 1)]
            self.decimals = 0
            return
        found = axis(values)
        self.low, self.high = found.low, found.high
        self.ticks, self.decimals = list(found.ticks), found.decimals

    def share(self, value: float) -> float:
        """Place between the ends, 0 to 1."""
        at = math.log10(value) if self.log else value
        return (at - self.low) / (self.high - self.low)

    def of_tick(self, tick: float) -> float:
        return (tick - self.low) / (self.high - self.low)

    def label(self, tick: float) -> str:
        """The number at a tick."""
        return f"{10.0**tick:g}" if self.log else f"{tick:.{self.decimals}f}"


def chart_text(chart: Chart, *, width: int, height: int) -> Text:
    """A chart in a field of characters: title, curves with axes, legend."""
    curves = [s for s in chart.series if s.points]
    if not curves:
        return Text(texts.CHART_NONE, style="dim")
    x = _Scale([p[0] for s in curves for p in s.points], log=chart.log_x)
    y = _Scale([p[1] for s in curves for p in s.points], log=chart.log_y, names=len(chart.y_names))
    names = [shown(chart.y_names[int(t)]) if chart.y_names else y.label(t) for t in y.ticks]
    margin = max(columns(name) for name in names) + 1
    told = _below(chart, curves, width)
    canvas = Canvas(width - margin - 1, height - 4 - len(told))
    if chart.square:
        _square(x, y, canvas)
        names = [y.label(t) for t in y.ticks]
        margin = max(margin, max(columns(name) for name in names) + 1)
    for item, mark in zip(curves, _marks(curves), strict=True):
        _draw(canvas, item, (x, y), mark)
    text = Text(no_wrap=True)
    title = cut(shown(chart.title), width)
    text.append(title, style="bold")
    text.append(cut(f"   {shown(chart.y_label)}", width - columns(title)) + "\n", style="dim")
    _framed(text, canvas, (y, names), margin)
    text.append(_x_axis(x, canvas.width, margin) + "\n", style="dim")
    label = cut(shown(chart.x_label), width - 1)
    text.append(padded(label, width - 1, right=True) + "\n", style="dim")
    for line in told:
        text.append(line + "\n")
    return text


def _square(x: _Scale, y: _Scale, canvas: Canvas) -> None:
    """Widen the shorter axis until both have one scale; dots are taken for square."""
    wide, tall = 2 * canvas.width, 4 * canvas.height
    per_dot = max((x.high - x.low) / wide, (y.high - y.low) / tall)
    for scale, dots in ((x, wide), (y, tall)):
        middle, half = 0.5 * (scale.low + scale.high), 0.5 * per_dot * dots
        found = axis([middle - 0.9 * half, middle + 0.9 * half])
        scale.low, scale.high = middle - half, middle + half
        scale.ticks = [t for t in found.ticks if scale.low <= t <= scale.high]
        scale.decimals = found.decimals


def _marks(curves: Sequence[Series]) -> list[str]:
    """The sign of every curve; empty for one that needs none or has too many readings."""
    lines = sum(item.style == "line" for item in curves)
    found: list[str] = []
    signs = iter(MARKS * (len(curves) // len(MARKS) + 1))
    for item in curves:
        few = len(item.points) <= BRAILLE_SHARE
        marked = item.style == "dots" and few
        if item.style == "bound":
            found.append(BOUND)
        elif marked or (item.style == "line" and lines > 1):
            found.append(next(signs))
        else:
            found.append("")
    return found


def _draw(canvas: Canvas, item: Series, scales: tuple[_Scale, _Scale], mark: str) -> None:
    x, y = scales
    wide, tall = 2 * canvas.width - 1, 4 * canvas.height - 1
    places = [(x.share(a) * wide, (1.0 - y.share(b)) * tall) for a, b in item.points]
    if item.style == "line":
        for start, end in itertools.pairwise(places):
            canvas.line(start, end)
        places = places[:: max(1, math.ceil(len(places) / LINE_MARKS))]
    elif item.style == "guide":
        for start, end in itertools.pairwise(places):
            _dashed(canvas, start, end)
    for place in places:
        if mark:
            canvas.sign(*place, mark)
        elif item.style != "guide":
            canvas.dot(*place)


def _dashed(canvas: Canvas, start: tuple[float, float], end: tuple[float, float]) -> None:
    count = max(1, math.ceil(max(abs(end[0] - start[0]), abs(end[1] - start[1]))))
    for k in range(0, count + 1, 4):
        share = k / count
        canvas.dot(start[0] + (end[0] - start[0]) * share, start[1] + (end[1] - start[1]) * share)


def _framed(text: Text, canvas: Canvas, ticks: tuple[_Scale, list[str]], margin: int) -> None:
    """The curves with the numbers of the upright axis before them."""
    scale, names = ticks
    rows: dict[int, str] = {}
    for tick, name in zip(scale.ticks, names, strict=True):
        row = round((1.0 - scale.of_tick(tick)) * (4 * canvas.height - 1)) // 4
        rows.setdefault(min(max(row, 0), canvas.height - 1), name)
    for row, line in enumerate(canvas.text().plain.split("\n")):
        text.append(padded(rows.get(row, ""), margin - 1, right=True), style="dim")
        text.append("┤" if row in rows else "│", style="dim")
        text.append(line + "\n")


def _x_axis(x: _Scale, width: int, margin: int) -> str:
    """The numbers below, those that have room; the line above them."""
    line = [" "] * (width + margin)
    for tick in x.ticks:
        name = x.label(tick)
        at = margin + round(x.of_tick(tick) * (width - 1)) - len(name) // 2
        at = min(max(at, 0), len(line) - len(name))
        free = all(c == " " for c in line[max(at - 1, 0) : at + len(name) + 1])
        if free:
            line[at : at + len(name)] = name
    return "".join(line).rstrip()


def _below(chart: Chart, curves: Sequence[Series], width: int) -> list[str]:
    """Which sign is which curve, and the note."""
    parts = []
    if len(curves) > 1:
        for item, mark in zip(curves, _marks(curves), strict=True):
            parts.append(f"{mark or SIGNS[item.style]} {shown(item.name)}")
    lines = []
    if parts:
        lines += lines_of("  ".join(dict.fromkeys(parts)), width)
    if chart.note:
        lines += lines_of(shown(chart.note), width)
    return lines


def coverage_text(coverage: Coverage, *, width: int) -> Text:
    """Cells of the sphere: the more readings, the darker; a blank was never visited."""
    text = Text(no_wrap=True)
    text.append(f"{cut(shown(coverage.title), width)}\n\n", style="bold")
    count = len(coverage.cells[0])
    cell = max((width - 8) // count, 2)
    most = max((value for row in coverage.cells for value in row), default=0)
    rule = "+" + ("-" * (cell - 1) + "+") * count
    text.append(f"      {rule}\n", style="dim")
    for index, row in enumerate(coverage.cells):
        name = {0: texts.CHART_UP, len(coverage.cells) - 1: texts.CHART_DOWN}.get(index, "")
        if len(coverage.cells) == 1:
            name = ""
        text.append(f"{padded(name, 5, right=True)} ")
        for value in row:
            text.append("|", style="dim")
            text.append(_shade(value, most) * (cell - 1))
        text.append("|\n", style="dim")
        text.append(f"      {rule}\n", style="dim")
    marks = [""] * 5
    line = [" "] * (8 + cell * count)
    for quarter in range(len(marks)):
        name = f"{90 * quarter}"
        at = min(6 + cell * count * quarter // 4, len(line) - len(name))
        line[at : at + len(name)] = name
    text.append(cut(f"{''.join(line).rstrip()} {texts.CHART_DEGREES}", width) + "\n", style="dim")
    told = texts.CHART_SHADES.format(signs=" ".join(SHADES), most=most)
    for words in filter(None, (told, shown(coverage.note))):
        text.append("\n".join(lines_of(words, width)) + "\n")
    return text


def _shade(value: int, most: int) -> str:
    if value == 0:
        return " "
    place = math.floor(len(SHADES) * math.log1p(value) / math.log1p(most + 1))
    return SHADES[min(max(place, 0), len(SHADES) - 1)]
