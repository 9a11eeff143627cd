"""What the model lacks: subjects of a project, each diagnosed on demand, with an adopt action.

The engine runs in a thread on the project as it was read; adopting asks once, writes, and the
project is oriented anew when one returns.
"""

from __future__ import annotations

from typing import ClassVar

from textual import work
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.message import Message
from textual.screen import Screen
from textual.widgets import DataTable

from surveyapp import api
from surveyapp.errors import SurveyError
from surveyapp.languages import shown, translated
from surveyapp.report.blocks import Block, Paragraph
from surveyapp.tui import texts
from surveyapp.tui.screens.confirm import ConfirmScreen
from surveyapp.tui.views.diagnosis import Diagnosed, diagnosis_blocks, subject_table
from surveyapp.tui.widgets.key_bar import KeyBar
from surveyapp.tui.widgets.problems import problem_blocks
from surveyapp.tui.widgets.records import Records
from surveyapp.tui.widgets.titlebar import TitleBar
from surveyapp_models.angles import AngleUnit

DIAGNOSING = (Paragraph(texts.DIAGNOSING),)


class DiagnosisScreen(Screen[None]):
    """Diagnoses runs and campaigns of one project."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("a", "adopt", texts.KEY_ADOPT, tooltip=texts.LONG_ADOPT),
        Binding("f5", "diagnose", texts.KEY_RELOAD, tooltip=texts.LONG_RELOAD),
        Binding("escape", "leave", texts.KEY_BACK),
    ]

    class Found(Message):
        """A diagnosis has ended."""

        def __init__(self, row: int, found: Diagnosed) -> None:
            super().__init__()
            self.row = row
            self.found = found

    class Failed(Message):
        """A subject cannot be diagnosed, and why."""

        def __init__(self, row: int, error: SurveyError) -> None:
            super().__init__()
            self.row = row
            self.error = error

    def __init__(self, folder: str, name: str, unit: AngleUnit = AngleUnit.DMS) -> None:
        super().__init__()
        self.folder = folder
        self.unit = unit
        self.title_text = texts.DIAGNOSIS_TITLE.format(name=name)
        self.subjects: tuple[tuple[str, str], ...] = ()
        self.found: dict[int, Diagnosed] = {}
        self.told: dict[int, tuple[Block, ...]] = {}

    def compose(self) -> ComposeResult:
        """Title, subjects with their verdict, the diagnosis of the chosen one, keys."""
        yield TitleBar(self.title_text)
        yield Records(empty=texts.NO_SUBJECTS, details=self._details, beside=True)
        yield KeyBar()

    def on_mount(self) -> None:
        """List the subjects and diagnose the first."""
        try:
            self.subjects = tuple((s.keyword, s.id) for s in api.subjects(self.folder))
        except SurveyError as error:
            self.notify(shown(error.text), severity="error", markup=False)
        self._list()
        if self.subjects:
            self.query_one(DataTable).focus()
            self.action_diagnose()

    def _list(self) -> None:
        self.query_one(Records).show(subject_table(self.subjects, self.found))

    @property
    def row(self) -> int:
        """The chosen subject."""
        return self.query_one(DataTable).cursor_row

    def on_data_table_row_highlighted(self, event: DataTable.RowHighlighted) -> None:
        """Diagnose a subject when it is looked at for the first time."""
        if 0 <= event.cursor_row < len(self.subjects) and event.cursor_row not in self.told:
            self.action_diagnose()

    def action_diagnose(self) -> None:
        """Diagnose the chosen subject."""
        if self.subjects:
            row = self.row
            self.told[row] = DIAGNOSING
            self.query_one(TitleBar).state = texts.COMPUTING
            self.diagnose(row, *self.subjects[row], adopt=False)

    @work(thread=True, exclusive=True)
    def diagnose(self, row: int, option: str, identity: str, *, adopt: bool) -> None:
        """Run the engine in a thread; the result comes as a message."""
        try:
            if option == "session":
                found = api.diagnose(self.folder, session=identity, adopt=adopt, log=adopt)
            elif option == "traverse":
                found = api.diagnose(self.folder, traverse=identity, adopt=adopt, log=adopt)
            else:
                found = api.diagnose(self.folder, campaign=identity, adopt=adopt, log=adopt)
            self.post_message(self.Found(row, found))
        except SurveyError as error:
            self.post_message(self.Failed(row, error))

    def on_diagnosis_screen_found(self, message: Found) -> None:
        """Show a diagnosis."""
        self.query_one(TitleBar).state = ""
        self.found[message.row] = message.found
        self.told[message.row] = diagnosis_blocks(message.found, self.unit)
        self._list()
        for place in message.found.written:
            self.notify(texts.ADOPTED.format(place=place), markup=False)
        for item in message.found.not_written:
            self.notify(str(item), severity="warning", markup=False)

    def on_diagnosis_screen_failed(self, message: Failed) -> None:
        """Say in words why there is none."""
        self.query_one(TitleBar).state = ""
        self.told[message.row] = problem_blocks(message.error)
        self._list()

    def _details(self, row: int) -> tuple[Block, ...]:
        return self.told.get(row, DIAGNOSING)

    def action_adopt(self) -> None:
        """Ask once, then write the named effects into the project."""
        found = self.found.get(self.row)
        if found is None or found.diagnosis is None or not found.diagnosis.adopted:
            self.notify(texts.NOTHING_TO_ADOPT, severity="warning", markup=False)
            return
        names = ", ".join(translated(item.title) for item in found.diagnosis.adopted)
        self.app.push_screen(ConfirmScreen(texts.ADOPT_ASK.format(names=names)), self._adopt)

    def _adopt(self, confirmed: bool | None) -> None:
        if confirmed:
            self.query_one(TitleBar).state = texts.COMPUTING
            self.diagnose(self.row, *self.subjects[self.row], adopt=True)

    def action_leave(self) -> None:
        """Back to the project."""
        self.dismiss(None)
