"""A breakthrough: plan, budget, evaluation, steps, and what would change the number.

The prediction and every trial are computed in a thread on a value; nothing is written.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import ClassVar

from rich.text import Text
from textual import work
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.message import Message
from textual.screen import Screen
from textual.widgets import DataTable, Footer, Static, TabbedContent, TabPane

from surveyapp import api
from surveyapp.api import Trial
from surveyapp.domain.penetration import ProcedureStep
from surveyapp.domain.penetration_result import Prediction
from surveyapp.errors import SurveyError
from surveyapp.languages import shown
from surveyapp.tui import texts
from surveyapp.tui.drafts import Draft
from surveyapp.tui.page_keys import page_bindings
from surveyapp.tui.screens.record_step import RecordStepScreen
from surveyapp.tui.views import penetration as view
from surveyapp.tui.widgets.heading_plan import HeadingPlan
from surveyapp.tui.widgets.problems import Problems
from surveyapp.tui.widgets.records import Records
from surveyapp.tui.widgets.titlebar import TitleBar

PAGES = {
    "headings": texts.TAB_HEADINGS,
    "budget": texts.TAB_BUDGET,
    "evaluation": texts.TAB_EVALUATION,
    "steps": texts.TAB_STEPS,
}
TRIALS: dict[str, Callable[[Trial], Trial]] = {
    "add": lambda trial: trial.add_side(),
    "remove": lambda trial: trial.remove_side(),
    "ends": lambda trial: trial.both_ends(),
    "survey": lambda trial: trial.survey(),
    "angles": lambda trial: trial.better_angles(),
    "gyro": lambda trial: trial.better_gyro(),
}


class PenetrationScreen(Screen[None]):
    """Shows the breakthrough of a project."""

    BINDINGS: ClassVar[list[BindingType]] = [
        *page_bindings(PAGES),
        Binding("a", "try('add')", texts.KEY_ADD_SIDE, tooltip=texts.LONG_ADD_SIDE),
        Binding("x", "try('remove')", texts.KEY_REMOVE_SIDE, tooltip=texts.LONG_REMOVE_SIDE),
        Binding("r", "try('ends')", texts.KEY_BOTH_ENDS, tooltip=texts.LONG_BOTH_ENDS),
        Binding("s", "try('survey')", texts.KEY_SURVEY, tooltip=texts.LONG_SURVEY),
        Binding("w", "try('angles')", texts.KEY_ANGLES, tooltip=texts.LONG_ANGLES),
        Binding("g", "try('gyro')", texts.KEY_GYRO, tooltip=texts.LONG_GYRO),
        Binding("d", "done", texts.KEY_RECORD_STEP, tooltip=texts.LONG_RECORD_STEP, show=False),
        Binding("f5", "reload", texts.KEY_RELOAD, tooltip=texts.LONG_RELOAD, show=False),
        Binding("escape", "leave", texts.KEY_BACK),
    ]
    DEFAULT_CSS = """
    HeadingPlan { width: 1fr; height: 1fr; padding: 0 1; text-wrap: nowrap; }
    #tried { height: auto; padding: 0 1; }
    #budget DataTable { max-height: 100%; }
    """

    class Predicted(Message):
        """A computation has ended."""

        def __init__(self, trial: Trial) -> None:
            super().__init__()
            self.trial = trial

    class Failed(Message):
        """The breakthrough cannot be predicted."""

        def __init__(self, error: SurveyError) -> None:
            super().__init__()
            self.error = error

    def __init__(self, folder: str) -> None:
        super().__init__()
        self.folder = folder
        self.trial: Trial | None = None
        self.before: Prediction | None = None
        self.draft: Draft = {}

    def compose(self) -> ComposeResult:
        """Title, pages, keys."""
        yield TitleBar(texts.PENETRATION_TITLE.format(name=Path(self.folder).resolve().name))
        yield Static(id="tried", markup=False)
        with TabbedContent():
            with TabPane(texts.TAB_HEADINGS, id="headings"):
                yield HeadingPlan()
            with TabPane(texts.TAB_BUDGET, id="budget"):
                yield Records(view.BUDGET_COLUMNS, empty=texts.P_EMPTY)
            with TabPane(texts.TAB_EVALUATION, id="evaluation"):
                yield Records(
                    view.EVALUATION_COLUMNS, empty=texts.P_NOT_MEASURED, details=self._evaluation
                )
            with TabPane(texts.TAB_STEPS, id="steps"):
                yield Records(view.STEP_COLUMNS, empty=texts.P_EMPTY, details=self._step)
        yield Footer(show_command_palette=False)

    def on_mount(self) -> None:
        """Begin to compute."""
        self.action_reload()

    def action_reload(self) -> None:
        """Predict anew, from the folder as it is now."""
        self.trial = self.before = None
        self.query_one(TitleBar).state = texts.COMPUTING
        self.compute()

    @work(thread=True, exclusive=True)
    def compute(self) -> None:
        """Predict in a thread; the result comes as a message."""
        try:
            self.post_message(self.Predicted(api.trial(self.folder)))
        except SurveyError as error:
            self.post_message(self.Failed(error))

    @work(thread=True, exclusive=True)
    def compute_trial(self, trial: Trial, change: str) -> None:
        """Try something in a thread."""
        self.post_message(self.Predicted(TRIALS[change](trial)))

    def action_try(self, change: str) -> None:
        """Change one thing; the number follows."""
        if self.trial is not None:
            self.compute_trial(self.trial, change)

    async def on_penetration_screen_predicted(self, message: Predicted) -> None:
        """Fill the pages."""
        await self.query(Problems).remove()
        self.query_one(TabbedContent).display = True
        self.trial = message.trial
        result = message.trial.prediction
        if self.before is None:
            self.before = result
        self.query_one(TitleBar).state = view.state_text(result)
        self.query_one("#tried", Static).update(view.tried_text(message.trial, self.before))
        self.query_one(HeadingPlan).show(result)
        for page, rows in (
            ("budget", view.budget_rows(result)),
            ("evaluation", view.evaluation_rows(result)),
            ("steps", view.step_rows(result)),
        ):
            self.query_one(f"#{page} Records", Records).show(rows)

    async def on_penetration_screen_failed(self, message: Failed) -> None:
        """Say in words what is wrong."""
        await self.query(Problems).remove()
        self.query_one(TitleBar).state = ""
        self.query_one(TabbedContent).display = False
        await self.mount(Problems(message.error), before=self.query_one(Footer))

    def action_page(self, name: str) -> None:
        """Show one page."""
        pages = self.query_one(TabbedContent)
        if pages.display:
            pages.active = name
            for table in self.query(f"#{name} DataTable").results(DataTable):
                table.focus()

    def action_done(self) -> None:
        """Record the step under the cursor."""
        if self.trial is None or self.query_one(TabbedContent).active != "steps":
            return
        row = self.query_one("#steps DataTable", DataTable).cursor_row
        step = view.step_of_row(self.trial.prediction, row)
        self.app.push_screen(RecordStepScreen(step, self.draft), self._recorded)

    def _recorded(self, entry: ProcedureStep | None) -> None:
        if entry is not None:
            self.write_step(entry)

    @work(thread=True, exclusive=True)
    def write_step(self, entry: ProcedureStep) -> None:
        """Record in a thread and predict anew."""
        try:
            api.record_step(
                self.folder,
                entry.id,
                by=entry.by,
                file=entry.file,
                note=entry.note,
                centre_line_mm=entry.centre_line_mm,
                waist_line_mm=entry.waist_line_mm,
            )
            self.post_message(self.Predicted(api.trial(self.folder)))
        except SurveyError as error:
            words = "; ".join(shown(problem.text) for problem in error.problems)
            self.app.call_from_thread(self.notify, words, severity="error", markup=False)

    def action_leave(self) -> None:
        """Back to the project."""
        self.dismiss(None)

    def _evaluation(self, _: int) -> Text:
        return Text() if self.trial is None else Text(view.evaluation_text(self.trial.prediction))

    def _step(self, row: int) -> Text:
        return Text() if self.trial is None else Text(view.step_notes(self.trial.prediction)[row])
