"""The steps of the observation with their state, and which one is open."""

from __future__ import annotations

from collections.abc import Sequence

from rich.text import Text
from textual.widgets import Static

from surveyapp.core.observing.steps import Step, StepState
from surveyapp.tui import texts
from surveyapp.tui.cells import cut, padded


class StepList(Static):
    """A list that shows; one goes through it with the keys of the screen."""

    def __init__(self, method: str) -> None:
        super().__init__(markup=False)
        self.method = method

    def show(self, states: Sequence[StepState], here: Step) -> None:
        """Show the state of every step."""
        text = Text()
        for state in states:
            name = texts.STEP_NAMES[state.step]
            if state.step is Step.SWING:
                name = texts.SWING_NAMES[self.method]
            mark = texts.STEP_HERE if state.step is here else texts.STEP_MARKS[state.state]
            count = f"{state.count:>3}" if state.count else "   "
            text.append(
                f"{mark} {padded(cut(name, 15), 15)}{count}\n",
                style="reverse" if state.step is here else "",
            )
        self.update(text)
