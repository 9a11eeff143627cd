"""The instrument constant through time: each determination with its error bar, and their mean.

Only places on the screen are computed here; values, sigmas and tests come with the result.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from rich.text import Text
from textual.app import ComposeResult
from textual.containers import Vertical
from textual.widget import Widget
from textual.widgets import DataTable, Static

from surveyapp.core.orientation.constant_axis import ConstantAxis, constant_axis
from surveyapp.domain.results import ConstantResult, Determination, OrientationResult
from surveyapp.languages import shown
from surveyapp.report.sections import constants as section
from surveyapp.tui import texts
from surveyapp.tui.cells import cut
from surveyapp.tui.widgets.canvas import Canvas
from surveyapp.tui.widgets.records import Records
from surveyapp_models.angles import ARCSEC

SIGNS = "●○◆◇■□▲△"
SMALLEST = 30, 6
"""Width and height below which nothing can be told from a drawing."""
GUTTER = 9
"""Columns for the labels of the vertical axis."""
SIDE = 3
"""Columns left free at either side."""
LABEL_WIDTH = 12
MARGIN = 0.08
"""Of the plot's height, above and below the outermost bar."""


class ConstantsPage(Vertical):
    """The constants as a table, and that of the instrument under the cursor as a drawing."""

    def __init__(self) -> None:
        super().__init__()
        self.result: OrientationResult | None = None

    def compose(self) -> ComposeResult:
        """Table and drawing."""
        yield Records(empty=texts.NO_CONSTANTS, whole=False)
        yield ConstantPlot()

    def show(self, result: OrientationResult) -> None:
        """Show another result."""
        self.result = result
        records = self.query_one(Records)
        records.show(section.summary(result))
        self.draw(max(records.query_one(DataTable).cursor_row, 0))

    def on_data_table_row_highlighted(self, event: DataTable.RowHighlighted) -> None:
        """Another instrument."""
        self.draw(event.cursor_row)

    def draw(self, row: int) -> None:
        """Draw the constant that a row of the table belongs to."""
        if self.result is not None:
            self.query_one(ConstantPlot).show(self.result, section.owner_of(self.result, row))


class ConstantPlot(Vertical):
    """Draws the constant of one instrument, with its tests in words below."""

    def compose(self) -> ComposeResult:
        """The drawing, and what it says."""
        yield ConstantCanvas()
        yield Static(id="constant-told", markup=False)

    def show(self, result: OrientationResult, constant: ConstantResult | None) -> None:
        """Draw another constant, or nothing."""
        self.display = constant is not None and constant.value is not None
        if constant is not None:
            self.query_one(ConstantCanvas).show(constant)
            lines = "\n".join(shown(text) for text in section.told(result, constant))
            self.query_one("#constant-told", Static).update(lines)


class ConstantCanvas(Widget):
    """The drawing; nothing where no session determined the constant."""

    def __init__(self) -> None:
        super().__init__()
        self.constant: ConstantResult | None = None

    def show(self, constant: ConstantResult) -> None:
        """Draw another constant."""
        self.constant = constant
        self.display = bool(constant.determinations)
        self.refresh()

    def render(self) -> Text:
        """The drawing in the room there is."""
        if self.constant is None:
            return Text()
        return draw_constant(self.constant, self.size.width, self.size.height)


def draw_constant(constant: ConstantResult, width: int, height: int) -> Text:
    """Determinations with bars of one sigma along days or order, the mean as a broken line."""
    items = constant.determinations
    if not items or width < SMALLEST[0] or height < SMALLEST[1]:
        return Text()
    canvas = Canvas(width - GUTTER, height - 3)
    along = constant_axis(items, most_ticks=max(canvas.width // LABEL_WIDTH, 2))
    low, high = _range(constant)

    def across(place: float) -> float:
        return _share(place, *_ends(along)) * (2 * (canvas.width - 2 * SIDE) - 1) + 2 * SIDE

    def down(value: float) -> float:
        return (1.0 - _share(value, low, high)) * (4 * canvas.height - 1)

    if constant.value is not None:
        for x in range(0, 2 * canvas.width, 4):
            canvas.line((x, down(constant.value)), (x + 1, down(constant.value)))
    for place, item in zip(along.places, items, strict=True):
        if math.isfinite(item.sigma):
            top, bottom = down(item.value + item.sigma), down(item.value - item.sigma)
            _bar(canvas, across(place), top, bottom)
    for place, item in zip(along.places, items, strict=True):
        canvas.sign(across(place), down(item.value), _signs(items)[item.station, item.target])
    labels = {
        round(down(value * ARCSEC)) // 4: f"{value:+.{decimals}f}"
        for value, decimals in _ticks(low / ARCSEC, high / ARCSEC, canvas.height // 3 + 1)
    }
    text = Text(no_wrap=True)
    for row, line in enumerate(canvas.text().plain.split("\n")):
        label = labels.get(row, "")
        text.append(f"{label:>{GUTTER - 2}} {'┤' if label else '│'}{line}\n")
    text.append(_foot([(round(across(p)) // 2, label) for p, label in along.ticks], canvas.width))
    return text.append(cut(_legend(constant, along), width))


def _signs(items: Sequence[Determination]) -> dict[tuple[str, str], str]:
    """A sign for each line."""
    lines = dict.fromkeys((item.station, item.target) for item in items)
    return {line: SIGNS[number % len(SIGNS)] for number, line in enumerate(lines)}


def _share(value: float, low: float, high: float) -> float:
    return (value - low) / (high - low) if high > low else 0.5


def _ends(along: ConstantAxis) -> tuple[float, float]:
    return min(along.places), max(along.places)


def _range(constant: ConstantResult) -> tuple[float, float]:
    """Lowest and highest value that is drawn [rad]."""
    ends = [constant.value] if constant.value is not None else []
    for item in constant.determinations:
        spread = item.sigma if math.isfinite(item.sigma) else 0.0
        ends += [item.value - spread, item.value + spread]
    margin = MARGIN * (max(ends) - min(ends)) or ARCSEC
    return min(ends) - margin, max(ends) + margin


def _bar(canvas: Canvas, x: float, top: float, bottom: float) -> None:
    canvas.line((x, top), (x, bottom))
    for end in (top, bottom):
        canvas.line((x - 2, end), (x + 2, end))


def _ticks(low: float, high: float, most: int) -> list[tuple[float, int]]:
    """Round values between two ends, with the decimals that they need."""
    raw = (high - low) / max(most, 1)
    power = math.floor(math.log10(raw))
    step = next(m * 10.0**power for m in (1.0, 2.0, 5.0, 10.0) if m * 10.0**power >= raw)
    first, last = math.ceil(low / step), math.floor(high / step)
    decimals = max(0, -math.floor(math.log10(step) + 1e-9))
    return [(k * step + 0.0, decimals) for k in range(first, last + 1)]


def _foot(ticks: Sequence[tuple[int, str]], width: int) -> str:
    """The axis with its ticks, and their labels below as far as there is room."""
    rule, labels = ["─"] * width, [" "] * width
    free = 0
    for column, label in ticks:
        start = min(max(column - len(label) // 2, 0), width - len(label))
        if start >= free:
            rule[column] = "┴"
            labels[start : start + len(label)] = label
            free = start + len(label) + 1
    return f"{'':>{GUTTER - 1}}└{''.join(rule)}\n{'':>{GUTTER}}{''.join(labels)}\n"


def _legend(constant: ConstantResult, along: ConstantAxis) -> str:
    axis = texts.CONSTANT_DAYS if along.dated else texts.CONSTANT_ORDER
    signs = _signs(constant.determinations)
    names = "  ".join(f"{sign} {'-'.join(line)}" for line, sign in signs.items())
    return f"{texts.CONSTANT_AXIS.format(axis=axis)}  {names}"
