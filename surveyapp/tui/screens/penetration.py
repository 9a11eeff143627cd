"""A breakthrough: plan, budget, evaluation, steps, and what would change the number.

The prediction and every trial are computed in a thread on a value; nothing is written.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import ClassVar

from textual import work
from textual.binding import Binding, BindingType
from textual.widget import Widget
from textual.widgets import Static

from surveyapp import api
from surveyapp.api import Trial
from surveyapp.domain.penetration import ProcedureStep
from surveyapp.domain.penetration_result import Prediction
from surveyapp.errors import SurveyError
from surveyapp.languages import shown
from surveyapp.tui import texts
from surveyapp.tui.drafts import Draft
from surveyapp.tui.page_keys import page_bindings
from surveyapp.tui.screens.paged import PagedScreen
from surveyapp.tui.screens.record_step import RecordStepScreen
from surveyapp.tui.views import penetration as view
from surveyapp.tui.widgets.blocks_pane import BlocksPane
from surveyapp.tui.widgets.heading_plan import HeadingPlan
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


class PenetrationScreen(PagedScreen[Trial]):
    """Shows the breakthrough of a project."""

    PAGES = PAGES
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
    """

    def __init__(self, folder: str) -> None:
        super().__init__(texts.PENETRATION_TITLE.format(name=Path(folder).resolve().name))
        self.folder = folder
        self.trial: Trial | None = None
        self.before: Prediction | None = None
        self.draft: Draft = {}

    def above(self) -> Iterable[Widget]:
        """What is tried."""
        yield Static(id="tried", markup=False)

    def page(self, name: str) -> Iterable[Widget]:
        """The plan, a text, or the steps."""
        if name == "headings":
            yield HeadingPlan()
        elif name == "steps":
            yield Records(empty=texts.P_EMPTY)
        else:
            yield BlocksPane(empty=texts.P_NOT_MEASURED)

    def action_reload(self) -> None:
        """Predict anew, from the folder as it is now."""
        self.trial = self.before = None
        super().action_reload()

    def read(self) -> Trial:
        """Predict from the folder as it is now."""
        return api.trial(self.folder)

    @work(thread=True, exclusive=True)
    def compute_trial(self, trial: Trial, change: str) -> None:
        """Try something in a thread."""
        self.post_message(self.Done(TRIALS[change](trial)))

    def action_try(self, change: str) -> None:
        """Change one thing; the number follows."""
        if self.trial is not None:
            self.compute_trial(self.trial, change)

    def fill(self, found: Trial) -> None:
        """Fill the pages."""
        self.trial = found
        result = found.prediction
        if self.before is None:
            self.before = result
        self.query_one(TitleBar).state = view.state_text(result)
        self.query_one("#tried", Static).update(view.tried_text(found, self.before))
        self.query_one(HeadingPlan).show(result)
        self.show_pages(view.pages(result))

    def action_done(self) -> None:
        """Record the step under the cursor."""
        if self.trial is None or self.active != "steps":
            return
        step = view.step_of_row(self.trial.prediction, self.row_of("steps"))
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
            self.post_message(self.Done(api.trial(self.folder)))
        except SurveyError as error:
            words = "; ".join(shown(problem.text) for problem in error.problems)
            self.app.call_from_thread(self.notify, words, severity="error", markup=False)
