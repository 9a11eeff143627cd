"""The swing as it was and as it will go on, drawn with braille dots.

Only places on the screen are computed here; the curve and the forecast come from the core.
"""

from __future__ import annotations

from rich.text import Text
from textual.widget import Widget

from surveyapp.core.observing.progress import Progress
from surveyapp.tui import texts

BRAILLE = 0x2800
DOTS = ((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80))
POINT, NEXT = "●", "○"


class SwingPlot(Widget):
    """Draws a ``Progress``."""

    def __init__(self) -> None:
        super().__init__()
        self.progress: Progress | None = None

    def show(self, progress: Progress | None) -> None:
        """Draw another state of the run."""
        self.progress = progress
        self.refresh()

    def render(self) -> Text:
        """The picture, or a sentence while there is nothing to draw."""
        progress = self.progress
        width, height = self.size
        if progress is None or not progress.curve or width < 8 or height < 3:
            return Text(texts.PLOT_EMPTY, style="dim")
        return draw(progress, width, height)


def draw(progress: Progress, width: int, height: int) -> Text:
    """The swing in a field of ``width`` times ``height`` characters."""
    offsets = [offset for _, offset in progress.curve]
    offsets += [point.offset for point in progress.points]
    low, high = min(offsets), max(offsets)
    last = progress.curve[-1][0] or 1.0

    def column(position: float, scale: int) -> int:
        return min(int(position / last * (scale - 1) + 0.5), scale - 1)

    def row(offset: float, scale: int) -> int:
        share = (high - offset) / (high - low) if high > low else 0.5
        return min(max(int(share * (scale - 1) + 0.5), 0), scale - 1)

    cells = [[0] * width for _ in range(height)]
    for position, offset in progress.curve:
        x, y = column(position, 2 * width), row(offset, 4 * height)
        cells[y // 4][x // 2] |= DOTS[y % 4][x % 2]
    lines = [[chr(BRAILLE + cell) for cell in line] for line in cells]  # all of one width
    if progress.middle is not None:
        middle = lines[row(progress.middle, height)]
        for x in range(0, width, 2):
            if middle[x] == chr(BRAILLE):
                middle[x] = "·"
    for point in progress.points:
        lines[row(point.offset, height)][column(point.index, width)] = POINT
    forecast = progress.next
    if forecast is not None and forecast.reading is not None:
        lines[row(forecast.reading, height)][column(forecast.index, width)] = NEXT
    return Text("\n".join("".join(line) for line in lines), no_wrap=True)
