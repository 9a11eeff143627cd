"""One project: its sessions, lines, constants, checks and warnings.

The screen reads and shows. The computation runs in a thread on the project as it was read; its
result comes back as a message.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from pathlib import Path
from typing import ClassVar, cast

from textual.app import App
from textual.binding import Binding, BindingType
from textual.message import Message
from textual.widget import Widget

from surveyapp import api
from surveyapp.domain.project import Project
from surveyapp.domain.results import OrientationResult
from surveyapp.errors import SurveyError
from surveyapp.observation import session as api_session
from surveyapp.observation.by_hand import PROJECT_FILE, file_of
from surveyapp.report.blocks import Block
from surveyapp.tui import texts
from surveyapp.tui.drafts import Draft
from surveyapp.tui.hand_editor import edit_by_hand, first_problem
from surveyapp.tui.page_keys import page_bindings
from surveyapp.tui.screens.new_session import NewSessionScreen
from surveyapp.tui.screens.paged import PagedScreen
from surveyapp.tui.views.checks import summary
from surveyapp.tui.views.project import EMPTY, details_of, page_tables
from surveyapp.tui.widgets.constants import ConstantsPage
from surveyapp.tui.widgets.records import Records
from surveyapp.tui.widgets.titlebar import TitleBar
from surveyapp_models.angles import AngleUnit

PAGES = {
    "sessions": texts.TAB_SESSIONS,
    "lines": texts.TAB_LINES,
    "constants": texts.TAB_CONSTANTS,
    "checks": texts.TAB_CHECKS,
    "warnings": texts.TAB_WARNINGS,
}


class ProjectScreen(PagedScreen[tuple[Project, OrientationResult]]):
    """Shows one project folder."""

    PAGES = PAGES
    READS_AGAIN = True

    BINDINGS: ClassVar[list[BindingType]] = [
        *page_bindings(PAGES),
        Binding("o", "observe", texts.KEY_OBSERVE, tooltip=texts.LONG_OBSERVE),
        Binding("n", "new", texts.KEY_NEW, tooltip=texts.LONG_NEW),
        Binding("d", "diagnose", texts.KEY_DIAGNOSE, tooltip=texts.LONG_DIAGNOSE),
        Binding("e", "edit", texts.KEY_EDIT, tooltip=texts.LONG_EDIT),
        Binding(
            "E", "edit('project')", texts.KEY_EDIT, tooltip=texts.LONG_EDIT_PROJECT, show=False
        ),
        Binding("t", "traverses", texts.KEY_TRAVERSE, tooltip=texts.LONG_TRAVERSES),
        Binding("c", "correct", texts.KEY_CORRECT, tooltip=texts.LONG_CORRECT, show=False),
        Binding("i", "import", texts.KEY_IMPORT, tooltip=texts.LONG_IMPORT, show=False),
        Binding("x", "export", texts.KEY_EXPORT, tooltip=texts.LONG_EXPORT, show=False),
        Binding(
            "p", "breakthrough", texts.KEY_PENETRATION, tooltip=texts.LONG_PENETRATION, show=False
        ),
        Binding("l", "sensors", texts.KEY_SENSORS, tooltip=texts.LONG_SENSORS),
        Binding("s", "shafts", texts.KEY_SHAFTS, tooltip=texts.LONG_SHAFTS, show=False),
        Binding("f5", "reload", texts.KEY_RELOAD, tooltip=texts.LONG_RELOAD, show=False),
        Binding("escape", "back", texts.KEY_BACK, tooltip=texts.LONG_BACK),
    ]

    class SessionChosen(Message):
        """A session is to be observed."""

        def __init__(self, session: str) -> None:
            super().__init__()
            self.session = session

    def __init__(self, folder: str, name: str) -> None:
        super().__init__(texts.PROJECT_TITLE.format(name=name))
        self.folder = folder
        self.project: Project | None = None
        self.result: OrientationResult | None = None
        self.error: SurveyError | None = None
        self.resumed = False
        self.draft: Draft = {}

    def page(self, name: str) -> Iterable[Widget]:
        """A list with its details; the constants are drawn as well."""
        if name == "constants":
            yield ConstantsPage()
        else:
            details = partial(self.details, name)
            yield Records(empty=EMPTY[name], details=details, beside=name == "warnings")

    def read(self) -> tuple[Project, OrientationResult]:
        """Orient the folder as it is now."""
        project = api.open_project(self.folder)
        return project, api_session.orient_observed(project)

    def fill(self, found: tuple[Project, OrientationResult]) -> None:
        """Fill the pages; an observation that was not ended is gone on with."""
        self.project, self.result = found
        self.error = None
        self.query_one(TitleBar).state = summary(self.result)
        self.show_pages({k: (table,) for k, table in page_tables(*found).items()})
        self.query_one(ConstantsPage).show(self.result)
        if not self.resumed:
            self.resumed = True
            unfinished = api_session.unfinished_session(self.project)
            if unfinished is not None:
                self.post_message(self.SessionChosen(unfinished))

    def refused(self, error: SurveyError) -> None:
        """What is wrong tells which file is edited by hand."""
        self.error = error

    def on_data_table_row_selected(self) -> None:
        """Enter on a session opens it."""
        self.action_observe()

    def action_observe(self) -> None:
        """Observe the session under the cursor."""
        session = self.chosen_session()
        if session is not None:
            self.post_message(self.SessionChosen(session))

    def chosen_session(self) -> str | None:
        """Id of the session under the cursor, None on the other pages."""
        if self.active != "sessions" or self.project is None or not self.project.sessions:
            return None
        return self.project.sessions[self.row_of("sessions")].id

    def action_edit(self, which: str = "") -> None:
        """Edit the book under the cursor, what a problem names, or the project file by hand."""
        session = None if which or self.error is not None else self.chosen_session()
        try:
            name = PROJECT_FILE if which else file_of(self.project, session, self.error)
            told = edit_by_hand(cast("App[int]", self.app), self.folder, name, session)
        except SurveyError as error:
            self.notify(first_problem(error), severity="error", markup=False)
            return
        self.notify(told, markup=False)
        self.action_reload()

    def action_correct(self) -> None:
        """Correct a station, an instrument or a session in a form."""
        from surveyapp.tui.screens.correct import ChooseTableScreen

        self.app.push_screen(ChooseTableScreen(self.folder))

    def action_new(self) -> None:
        """Begin another session."""
        if self.project is not None:
            self.app.push_screen(
                NewSessionScreen(self.folder, self.project, self.draft), self._made
            )

    def action_diagnose(self) -> None:
        """Ask what the model lacks; the project is read anew on return."""
        from surveyapp.tui.screens.diagnosis import DiagnosisScreen  # half of all there is to load

        name = Path(self.folder).resolve().name
        unit = AngleUnit.DMS if self.project is None else self.project.angle_unit
        self.app.push_screen(DiagnosisScreen(self.folder, name, unit))

    def action_traverses(self) -> None:
        """Show the adjusted traverses, if there are any."""
        if self.project is None:
            return
        from surveyapp.tui.screens.traverse import TraverseScreen

        names = tuple(item.id for item in api.subjects(self.project) if item.keyword == "traverse")
        if names:
            self.app.push_screen(TraverseScreen(self.folder, names, self.project.angle_unit))
        else:
            self.notify(texts.NO_TRAVERSE, severity="warning", markup=False)

    def action_import(self) -> None:
        """Import a field file; the project is read anew on return."""
        from surveyapp.tui.screens.exchange import ImportScreen

        self.app.push_screen(ImportScreen(self.folder))

    def action_export(self) -> None:
        """Export for other programs."""
        from surveyapp.tui.screens.export import ExportScreen

        self.app.push_screen(ExportScreen(self.folder))

    def action_breakthrough(self) -> None:
        """Show the breakthrough, if there is one."""
        if self.project is None:
            return
        from surveyapp.tui.screens.penetration import PenetrationScreen

        if api.has_breakthrough(self.project):
            self.app.push_screen(PenetrationScreen(self.folder))
        else:
            self.notify(texts.NO_PENETRATION, severity="warning", markup=False)

    def action_shafts(self) -> None:
        """Show the shafts, if there are any."""
        if self.project is None:
            return
        from surveyapp.tui.screens.shaft import ShaftScreen

        if api.has_shafts(self.project):
            self.app.push_screen(ShaftScreen(self.folder, self.project.angle_unit))
        else:
            self.notify(texts.NO_SHAFT, severity="warning", markup=False)

    def action_sensors(self) -> None:
        """Logs, calibrations, cards and guided programmes."""
        from surveyapp.tui.screens.sensors import SensorsScreen

        if self.project is not None:
            self.app.push_screen(SensorsScreen(self.folder))

    def _made(self, session: str | None) -> None:
        if session is not None:
            self.post_message(self.SessionChosen(session))

    async def action_back(self) -> None:
        """Leave the project; nothing is unsaved here."""
        await self.app.run_action("leave")

    def details(self, page: str, row: int) -> tuple[Block, ...]:
        """What is known of a row of a page."""
        if self.result is None or self.project is None:
            return ()
        return details_of(self.project, self.result, page, row)
