"""A field of braille dots with characters over it: what plans and plots are drawn on."""

from __future__ import annotations

import math

from rich.text import Text

from surveyapp.tui.widgets.swing import BRAILLE, DOTS


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
