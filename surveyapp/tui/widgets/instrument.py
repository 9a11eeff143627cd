"""The simulated instrument as the eye sees it: the scale with its mark, and the circle."""

from __future__ import annotations

from rich.text import Text
from textual.widgets import Static

from surveyapp.api_practice import Practice
from surveyapp.core.practice import View
from surveyapp.tui import texts
from surveyapp.tui.desk import Desk
from surveyapp.tui.views.form import number_text
from surveyapp_models.angles import AngleUnit, format_angle

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
        view = self.practice.view(self.desk.observation, self.desk.what())
        self.update(picture(view, self.desk.unit, self.practice.speed))


def picture(view: View, unit: AngleUnit, speed: float) -> Text:
    """The scale with the mark, and the readings."""
    text = Text(f"{texts.PRACTICE_INSTRUMENT.format(speed=speed)}\n", style="bold")
    middle = WIDTH // 2
    scale = ["─"] * WIDTH
    scale[0], scale[middle], scale[-1] = "├", "┼", "┤"
    if view.swing is not None:
        place = round(middle + view.swing * (middle - 1))
        text.append(" " * place + "▼\n")
    else:
        text.append("\n")
    text.append("".join(scale) + "\n")
    if view.circle is not None:
        text.append(texts.PRACTICE_CIRCLE.format(reading=format_angle(view.circle, unit)))
    elif view.scale_div is not None:
        text.append(texts.PRACTICE_SCALE.format(div=number_text(view.scale_div, 2, sign=True)))
    else:
        text.append(texts.PRACTICE_NOTHING)
    return text
