"""Plots of a record as vector primitives: axes with round numbers, points, curves, bars.

Knows positions on paper and nothing of gyros; what is plotted is decided by the sections.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

from surveyapp.report.blocks import Figure, Label, Line, Marker, Polyline, Primitive, Shape, Stroke

WIDTH_MM: Final = 170.0
HEIGHT_MM: Final = 60.0
_LEFT, _RIGHT, _BOTTOM, _TOP = 20.0, 4.0, 12.0, 3.0


@dataclass(frozen=True, slots=True)
class Axis:
    """A range of values with round ticks.

    Parameters
    ----------
    low, high : float
    ticks : tuple of float
    decimals : int
        Of the tick labels.
    """

    low: float
    high: float
    ticks: tuple[float, ...]
    decimals: int


def axis(
    values: Sequence[float], *, about_zero: bool = False, count: int = 5, whole: bool = False
) -> Axis:
    """Axis that holds all values, its ticks 1, 2 or 5 times a power of ten.

    Parameters
    ----------
    values : sequence of float
        Finite; none gives the axis from -1 to 1.
    about_zero : bool
        Whether zero stands in the middle.
    count : int
        About how many ticks.
    whole : bool
        Whether only whole numbers are ticks: the axis counts something.
    """
    low, high = (min(values), max(values)) if values else (-1.0, 1.0)
    if about_zero:
        high = max(abs(low), abs(high))
        low = -high
    if high - low <= 1e-12 * max(abs(low), abs(high), 1.0):
        low, high = low - 1.0, high + 1.0
    margin = 0.06 * (high - low)
    low, high = low - margin, high + margin
    raw = max((high - low) / count, 1.0 if whole else 0.0)
    power = 10.0 ** math.floor(math.log10(raw))
    step = power * next(m for m in (1.0, 2.0, 5.0, 10.0) if m * power >= raw * (1.0 - 1e-9))
    first = math.ceil(low / step - 1e-9)
    ticks = []
    while first * step <= high + 1e-9 * step:
        ticks.append(first * step + 0.0)
        first += 1
    return Axis(low, high, tuple(ticks), max(0, -math.floor(math.log10(step) + 1e-9)))


@dataclass(frozen=True, slots=True)
class Frame:
    """Plot area: two axes on paper.

    Parameters
    ----------
    x, y : Axis
    width_mm, height_mm : float
    """

    x: Axis
    y: Axis
    width_mm: float = WIDTH_MM
    height_mm: float = HEIGHT_MM

    def at(self, x: float, y: float) -> tuple[float, float]:
        """Point on paper [mm] of a pair of values."""
        across = (x - self.x.low) / (self.x.high - self.x.low)
        up = (y - self.y.low) / (self.y.high - self.y.low)
        return (
            _LEFT + across * (self.width_mm - _LEFT - _RIGHT),
            _BOTTOM + up * (self.height_mm - _BOTTOM - _TOP),
        )

    def axes(
        self,
        x_label: str,
        y_label: str,
        x_names: Sequence[str] = (),
        y_names: Sequence[str] = (),
    ) -> list[Primitive]:
        """Frame, grid lines, ticks and labels; names stand in place of the numbers at ticks."""
        left, bottom = self.at(self.x.low, self.y.low)
        right, top = self.at(self.x.high, self.y.high)
        parts: list[Primitive] = []
        words = list(y_names) or [f"{tick:.{self.y.decimals}f}" for tick in self.y.ticks]
        for tick, word in zip(self.y.ticks, words, strict=True):
            _, y = self.at(self.x.low, tick)
            parts.append(Line((left, y), (right, y), "grid"))
            parts.append(Label((left - 1.5, y - 0.9), word, "end"))
        names = list(x_names) or [f"{tick:.{self.x.decimals}f}" for tick in self.x.ticks]
        for tick, name in zip(self.x.ticks, names, strict=True):
            x, _ = self.at(tick, self.y.low)
            parts.append(Line((x, bottom), (x, bottom - 1.0), "axis"))
            parts.append(Label((x, bottom - 4.2), name))
        corners = ((left, bottom), (right, bottom), (right, top), (left, top), (left, bottom))
        parts.append(Polyline(corners, "axis"))
        parts.append(Label((0.5 * (left + right), 1.0), x_label))
        parts.append(Label((3.5, 0.5 * (bottom + top)), y_label, upright=True))
        return parts

    def level(self, value: float, stroke: Stroke) -> Line:
        """Horizontal line at a value."""
        return Line(self.at(self.x.low, value), self.at(self.x.high, value), stroke)

    def marks(self, points: Sequence[tuple[float, float]], shape: Shape) -> list[Primitive]:
        """One mark a point."""
        return [Marker(self.at(x, y), shape) for x, y in points]

    def curve(self, points: Sequence[tuple[float, float]], stroke: Stroke) -> Polyline:
        """A curve through points."""
        return Polyline(tuple(self.at(x, y) for x, y in points), stroke)

    def bar(self, x: float, *, low: float, high: float, cap_mm: float = 0.0) -> list[Primitive]:
        """Vertical bar between two values, with caps where it is an interval."""
        bottom, top = self.at(x, low), self.at(x, high)
        parts: list[Primitive] = [Line(bottom, top, "bar")]
        if cap_mm:
            parts += [
                Line((point[0] - cap_mm, point[1]), (point[0] + cap_mm, point[1]), "bar")
                for point in (bottom, top)
            ]
        return parts

    def figure(self, title: str, parts: Sequence[Primitive]) -> Figure:
        """The figure of all parts."""
        return Figure(title, self.width_mm, self.height_mm, tuple(parts))


def half_wave(points: Sequence[tuple[float, float]], steps: int = 12) -> list[tuple[float, float]]:
    """Smooth curve through turning points: half a cosine from each to the next."""
    curve: list[tuple[float, float]] = []
    for (x1, y1), (x2, y2) in pairwise(points):
        for k in range(steps):
            blend = 0.5 - 0.5 * math.cos(math.pi * k / steps)
            curve.append((x1 + (x2 - x1) * k / steps, y1 + (y2 - y1) * blend))
    return [*curve, *points[-1:]]
