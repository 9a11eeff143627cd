"""Countdown, forecast, gyro north now and the residual channels, as lines of text."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from rich.text import Text
from textual.app import ComposeResult
from textual.containers import Vertical
from textual.widgets import Static

from surveyapp.core.observing.progress import Progress
from surveyapp.observation.aim import Aim
from surveyapp.tui import texts
from surveyapp.tui.views.progress import (
    alert_text,
    channel_lines,
    countdown_text,
    forecast_text,
    is_near,
    next_lines,
    north_text,
    outlook_text,
    schuler_text,
    target_source_text,
    time_difference_text,
)
from surveyapp_models.angles import AngleUnit

if TYPE_CHECKING:
    from surveyapp.diagnosis.outlook import ActionResult


class Forecast(Vertical):
    """What the run says so far."""

    def __init__(self, unit: AngleUnit, method: str, aim: Aim) -> None:
        super().__init__()
        self.unit = unit
        self.method = method
        self.aim = aim
        self.progress: Progress | None = None

    def compose(self) -> ComposeResult:
        """Countdown, then the lines, then the alarm."""
        yield Static(id="countdown", markup=False)
        yield Static(id="facts", markup=False)
        yield Static(id="alert", markup=False)

    def show(self, progress: Progress, actions: Sequence[ActionResult] = ()) -> None:
        """Show another state of the run, and what could be observed next once it is enough."""
        self.progress = progress
        north = north_text(progress, self.unit, self.method)
        text = Text(f"{north}  ", no_wrap=True)
        outlook = outlook_text(progress, self.aim)
        if progress.north is not None:
            style = "bold" if outlook.startswith(texts.ENOUGH) else ""
            text.append(f"\n{outlook}", style=style)
            if source := target_source_text(self.aim.target):
                text.append(f"\n{source}")
            for line in next_lines(actions):
                text.append(f"\n{line}")
        lines = (time_difference_text(progress), schuler_text(progress, self.unit))
        for line in (*filter(None, lines), *channel_lines(progress)):
            text.append(f"\n{line}")
        self.query_one("#facts", Static).update(text)
        alert = self.query_one("#alert", Static)
        alert.update(alert_text(progress, self.method))
        alert.display = progress.alert is not None

    def count_down(self, remaining_s: float | None) -> bool:
        """Show the time to the next turning point; True while the moment is near."""
        if self.progress is None:
            return False
        text = countdown_text(self.progress, remaining_s)
        near = is_near(self.progress, remaining_s)
        line = Text(text, style="reverse bold" if near else "bold")
        line.append("  " + forecast_text(self.progress, self.unit), style="not reverse")
        self.query_one("#countdown", Static).update(line)
        return near
