"""A field of braille dots with characters over it: what plans and plots are drawn on."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Final

from rich.text import Text

from surveyapp.tui.cells import columns
from surveyapp.tui.widgets.swing import BRAILLE, DOTS

ELLIPSE_DOTS: Final = 7.0
"""About the largest half axis of an ellipse."""
ELLIPSE_STEPS: Final = 48


class Canvas:
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
        """A word whose first character stands at a dot, where nothing else is written.

        A character of two columns takes two cells, a mark that combines none.
        """
        column, row = round(x) // 2, round(y) // 4
        cells: list[str] = []
        for character in text:
            size = columns(character)
            if size == 0 and cells:
                cells[-1] += character
            cells += [character, ""][:size]
        places = [(row, column + i) for i in range(len(cells))]
        inside = all(0 <= r < self.height and 0 <= c < self.width for r, c in places)
        if inside and not any(place in self.signs for place in places):
            self.signs.update(zip(places, cells, strict=True))

    def text(self) -> Text:
        """Characters over dots."""
        lines = []
        for r, row in enumerate(self.cells):
            cells = [chr(BRAILLE + cell) for cell in row]  # leading blanks would be cut off
            for c in range(self.width):
                cells[c] = self.signs.get((r, c), cells[c])
            lines.append("".join(cells))
        return Text("\n".join(lines), no_wrap=True)


class Paper:
    """From east and north [m] to dots of a canvas: north is up, dots are taken for square.

    Parameters
    ----------
    canvas : Canvas
    places : iterable of (float, float)
        East and north of everything that must be in sight.
    margin : float
        Dots at every edge.
    name_room : int
        Columns at the right for the name of a point that lies there.
    """

    def __init__(
        self,
        canvas: Canvas,
        places: Iterable[tuple[float, float]],
        *,
        margin: float,
        name_room: int,
    ) -> None:
        every = list(places)
        self.low = [min(p[i] for p in every) for i in (0, 1)]
        span = [max(max(p[i] for p in every) - self.low[i], 1e-3) for i in (0, 1)]
        room = (
            2 * (canvas.width - name_room) - 2 * margin - 1,
            4 * canvas.height - 2 * margin - 1,
        )
        self.scale = min(room[0] / span[0], room[1] / span[1])
        self.shift = [margin + 0.5 * (room[i] - span[i] * self.scale) for i in (0, 1)]
        self.bottom = 4 * canvas.height - 1

    def __call__(self, place: tuple[float, float]) -> tuple[float, float]:
        """Dots to the right and down."""
        x = self.shift[0] + (place[0] - self.low[0]) * self.scale
        return x, self.bottom - self.shift[1] - (place[1] - self.low[1]) * self.scale


def draw_ellipse(
    canvas: Canvas, at: tuple[float, float], *, a: float, b: float, azimuth: float
) -> None:
    """Dots of an ellipse with half axes in dots and the azimuth of the long one [rad]."""
    for k in range(ELLIPSE_STEPS):
        angle = math.tau * k / ELLIPSE_STEPS
        u, w = a * math.cos(angle), b * math.sin(angle)
        east = u * math.sin(azimuth) + w * math.cos(azimuth)
        north = u * math.cos(azimuth) - w * math.sin(azimuth)
        canvas.dot(at[0] + east, at[1] - north)


def enlargement(largest_m: float, scale: float) -> float:
    """Round factor by which ellipses are enlarged, ``scale`` in dots per metre."""
    if largest_m <= 0.0:
        return 1.0
    wanted = ELLIPSE_DOTS / (largest_m * scale)
    power = 10.0 ** math.floor(math.log10(wanted))
    return max(m * power for m in (1.0, 2.0, 5.0) if m * power <= wanted * (1.0 + 1e-9))
