"""The run under observation: the swing, its forecast, and the readings of the step.

The judgement is computed in a thread on the project as it then was; it comes back as a message.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from textual import work
from textual.app import ComposeResult
from textual.containers import Vertical
from textual.message import Message
from textual.widgets import Static

from surveyapp.core.observing.owner_values import OwnerValue, missing_at
from surveyapp.core.observing.progress import Progress
from surveyapp.core.observing.step_values import step_values
from surveyapp.core.observing.steps import Step, kinds_of
from surveyapp.domain.readings import ReadingKind
from surveyapp.errors import SurveyError
from surveyapp.observation import session as api_session
from surveyapp.observation.next_action import next_actions
from surveyapp.tui import texts
from surveyapp.tui.entry_desk import Desk
from surveyapp.tui.views.ledger import QUIET, book_rows, ledger_rows
from surveyapp.tui.views.step_values import care_text, value_lines
from surveyapp.tui.widgets.forecast import Forecast
from surveyapp.tui.widgets.ledger import Ledger
from surveyapp.tui.widgets.swing import SwingPlot

if TYPE_CHECKING:
    from surveyapp.diagnosis.outlook import ActionResult


class RunPane(Vertical):
    """Swing, forecast and ledger.

    Parameters
    ----------
    desk : Desk
    """

    class Judged(Message):
        """The run has been judged as it was at some row."""

        def __init__(self, progress: Progress, actions: tuple[ActionResult, ...] = ()) -> None:
            super().__init__()
            self.progress = progress
            self.actions = actions

    class Near(Message):
        """The next turning point is near."""

    def __init__(self, desk: Desk) -> None:
        super().__init__()
        self.desk = desk
        self.near = False

    def compose(self) -> ComposeResult:
        """The three parts."""
        yield SwingPlot()
        observation = self.desk.observation
        yield Forecast(self.desk.unit, observation.session.method, observation.aim())
        yield Static(id="care", markup=False)
        yield Static(id="values", markup=False)
        yield Ledger()

    def on_mount(self) -> None:
        """Count down every second."""
        self.set_interval(1.0, self.tick)

    def swinging(self) -> bool:
        """Whether the observation itself is being read, whatever its method."""
        return self.desk.step is Step.SWING

    def show_book(self) -> None:
        """Show the readings of the step, and judge the run anew while it swings."""
        swinging = self.swinging()
        swings = self.desk.observation.session.method != "automatic"
        self.query_one(SwingPlot).display = swinging and swings
        self.query_one("#countdown").display = swings
        self.query_one(Forecast).display = swinging
        self.show_rows()
        self.show_values()
        if swinging:
            self.judge()

    def show_values(self) -> None:
        """Show means and differences of the step, and what is to be done with clamp and brake."""
        observation = self.desk.observation
        session = observation.session
        progress, target = self.desk.progress, observation.aim().target
        enough = progress is not None and target is not None and progress.enough(target.interval95)
        care = care_text(self.desk.step, session.method, enough=enough)
        values = step_values(observation.book, self.desk.step, target=session.target)
        lines = value_lines(values, self.desk.unit)
        for name, text in (("#care", care), ("#values", "\n".join(lines))):
            shown = self.query_one(name, Static)
            shown.update(text)
            shown.display = bool(text)

    def show_rows(self) -> None:
        """Show the readings of the step."""
        observation = self.desk.observation
        kinds = kinds_of(self.desk.step, observation.session.method)
        if self.desk.step is Step.SWING:
            kinds = (*kinds, ReadingKind.MISSED)
        elif self.desk.step is Step.RESULT:  # once more all that was read
            kinds = tuple(kind for kind in ReadingKind if kind not in QUIET)
        rows = book_rows(observation.book, kinds)
        progress = self.desk.progress
        self.query_one(Ledger).show(
            ledger_rows(observation.book, progress, rows),
            hint=texts.STEP_HINTS[self.desk.step] + self.missing_told(),
            scale=progress is not None and progress.scale,
        )

    def missing_told(self) -> str:
        """What the owner has not entered and this step needs."""
        observation = self.desk.observation
        instrument = observation.project.instrument(observation.session.instrument)
        absent = missing_at(instrument.card, observation.session.method, self.desk.step)
        if not absent:
            return ""
        without = texts.OWNER_WITHOUT[self.desk.step]
        if absent == (OwnerValue.PERIOD,):
            without = texts.OWNER_NO_PERIOD
        values = ", ".join(absent)
        return texts.OWNER_MISSING.format(instrument=instrument.id, values=values, without=without)

    @work(thread=True, exclusive=True)
    def judge(self) -> None:
        """Judge the run in a thread."""
        observation = self.desk.observation
        try:
            result = api_session.progress(observation.project, observation.session_id)
        except SurveyError:
            result = Progress()
        target = observation.aim().target
        enough = target is not None and result.enough(target.interval95)
        actions = next_actions(observation.project, observation.session_id) if enough else ()
        self.post_message(self.Judged(result, actions))

    def on_run_pane_judged(self, message: Judged) -> None:
        """Show forecast and alarm."""
        self.desk.progress = message.progress
        self.query_one(SwingPlot).show(message.progress)
        self.query_one(Forecast).show(message.progress, message.actions)
        self.show_rows()
        self.show_values()
        self.tick()

    def tick(self) -> None:
        """Count down to the next turning point."""
        if self.desk.progress is None or not self.swinging():
            return
        remaining = self.desk.observation.remaining_s(self.desk.progress)
        near = self.query_one(Forecast).count_down(remaining)
        if near and not self.near:
            self.post_message(self.Near())
        self.near = near
