"""The simulated instrument as the eye sees it: the scale with its mark, and the circle."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.text import Text
from textual.widgets import Static

from surveyapp.domain.readings import ReadingKind
from surveyapp.observation.practice import Practice
from surveyapp.report.numbers import plain
from surveyapp.tui import texts
from surveyapp.tui.entry_desk import Desk
from surveyapp_models.angles import AngleUnit, format_angle

if TYPE_CHECKING:
    from surveyapp.core.practice.simulated_instrument import View

WIDTH = 19
FRAMES_PER_SECOND = 10


class InstrumentPane(Static):
    """Moves by itself."""

    def __init__(self, practice: Practice, desk: Desk) -> None:
        super().__init__(markup=False)
        self.practice = practice
        self.desk = desk

    def on_mount(self) -> None:
        """Begin to move."""
        self.set_interval(1.0 / FRAMES_PER_SECOND, self.look)
        self.look()

    def look(self) -> None:
        """Draw what is seen now."""
        what = self.desk.what()
        view = self.practice.view(self.desk.observation, what)
        delivers = what.kind in (ReadingKind.AZIMUTH, ReadingKind.NORTH)
        self.update(picture(view, self.desk.unit, self.practice.speed, delivers=delivers))


def picture(view: View, unit: AngleUnit, speed: float, *, delivers: bool = False) -> Text:
    """The scale with the mark, and the readings.

    Parameters
    ----------
    view : View
    unit : AngleUnit
    speed : float
        How many times faster than life.
    delivers : bool
        Whether the instrument delivers values, so that the mark tells how far the round is.
    """
    text = Text(f"{texts.PRACTICE_INSTRUMENT.format(speed=speed)}\n", style="bold")
    middle = WIDTH // 2
    scale = ["─"] * WIDTH
    scale[0], scale[middle], scale[-1] = "├", "─" if delivers else "┼", "┤"
    if view.swing is not None:
        place = round(middle + min(max(view.swing, -1.0), 1.0) * (middle - 1))
        text.append(" " * place + "▼\n")
    else:
        text.append("\n")
    text.append("".join(scale) + "\n")
    return text.append("\n".join(_readings(view, unit, delivers=delivers)))


def _readings(view: View, unit: AngleUnit, *, delivers: bool) -> list[str]:
    lines = []
    if view.circle is not None:
        pattern = texts.PRACTICE_AZIMUTH if delivers else texts.PRACTICE_CIRCLE
        lines.append(pattern.format(reading=format_angle(view.circle, unit)))
    if view.scale_div is not None:
        div = plain(view.scale_div, 2, sign=True)
        lines.append(texts.PRACTICE_SCALE.format(div=div))
    if delivers and view.swing is not None:
        lines.append(texts.PRACTICE_MEASURING)
    return lines or [texts.PRACTICE_NOTHING]
