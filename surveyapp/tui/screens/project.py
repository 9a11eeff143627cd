"""One project: its sessions, lines, constants, checks and warnings.

The screen reads and shows. The computation runs in a thread on the project as it was read; its
result comes back as a message.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import ClassVar, cast

from rich.text import Text
from textual import work
from textual.app import App, ComposeResult
from textual.binding import Binding, BindingType
from textual.message import Message
from textual.screen import Screen
from textual.widgets import DataTable, Footer, TabbedContent, TabPane

from surveyapp import api
from surveyapp.domain.project import Project
from surveyapp.domain.results import OrientationResult
from surveyapp.errors import SurveyError
from surveyapp.observation import session as api_session
from surveyapp.observation.by_hand import PROJECT_FILE, file_of
from surveyapp.tui import texts
from surveyapp.tui.drafts import Draft
from surveyapp.tui.hand_editor import edit_by_hand, first_problem
from surveyapp.tui.page_keys import page_bindings
from surveyapp.tui.screens.new_session import NewSessionScreen
from surveyapp.tui.views.checks import summary
from surveyapp.tui.views.project import LISTS, details_of, page_rows
from surveyapp.tui.widgets.constants import ConstantsPage
from surveyapp.tui.widgets.problems import Problems
from surveyapp.tui.widgets.records import Records
from surveyapp.tui.widgets.titlebar import TitleBar

SIDES = 6
"""Columns beside the details: padding and scroll bar."""
PAGES = {
    "sessions": texts.TAB_SESSIONS,
    "lines": texts.TAB_LINES,
    "constants": texts.TAB_CONSTANTS,
    "checks": texts.TAB_CHECKS,
    "warnings": texts.TAB_WARNINGS,
}


class ProjectScreen(Screen[None]):
    """Shows one project folder."""

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

    class Oriented(Message):
        """The computation has ended."""

        def __init__(self, project: Project, result: OrientationResult) -> None:
            super().__init__()
            self.project = project
            self.result = result

    class Failed(Message):
        """The project cannot be used."""

        def __init__(self, error: SurveyError) -> None:
            super().__init__()
            self.error = error

    def __init__(self, folder: str, name: str) -> None:
        super().__init__()
        self.folder = folder
        self.title_text = texts.PROJECT_TITLE.format(name=name)
        self.project: Project | None = None
        self.left = False
        self.result: OrientationResult | None = None
        self.error: SurveyError | None = None
        self.resumed = False
        self.draft: Draft = {}

    def compose(self) -> ComposeResult:
        """Title, pages, keys."""
        yield TitleBar(self.title_text)
        with TabbedContent():
            for page, title in PAGES.items():
                with TabPane(title, id=page):
                    if page == "constants":
                        yield ConstantsPage()
                    else:
                        columns, empty = LISTS[page]
                        details = partial(self.details, page)
                        yield Records(columns, empty=empty, details=details)
        yield Footer(show_command_palette=False, compact=True)

    def on_mount(self) -> None:
        """Begin to compute."""
        self.action_reload()

    def on_screen_suspend(self) -> None:
        """Another screen stands before this one: what it does may change the folder."""
        self.left = True

    def on_screen_resume(self) -> None:
        """Back from another screen, whichever way it was left."""
        if self.left:
            self.left = False
            self.action_reload()

    def action_reload(self) -> None:
        """Read the folder again."""
        self.query_one(TitleBar).state = texts.COMPUTING
        self.compute()

    @work(thread=True, exclusive=True)
    def compute(self) -> None:
        """Orient in a thread; the result comes as a message."""
        try:
            project = api.open_project(self.folder)
            result = api_session.orient_observed(project)
            self.post_message(self.Oriented(project, result))
        except SurveyError as error:
            self.post_message(self.Failed(error))

    def on_project_screen_oriented(self, message: Oriented) -> None:
        """Fill the pages."""
        self.query(Problems).remove()
        self.query_one(TabbedContent).display = True
        self.project, self.result, self.error = message.project, message.result, None
        result = message.result
        self.query_one(TitleBar).state = summary(result)
        for page, rows in page_rows(message.project, result).items():
            self.query_one(f"#{page} Records", Records).show(rows)
        self.query_one(ConstantsPage).show(result)
        self.action_page(self.query_one(TabbedContent).active)
        if not self.resumed:
            self.resumed = True
            unfinished = api_session.unfinished_session(message.project)
            if unfinished is not None:
                self.post_message(self.SessionChosen(unfinished))

    async def on_project_screen_failed(self, message: Failed) -> None:
        """Say in words what is wrong."""
        self.error = message.error
        await self.query(Problems).remove()
        self.query_one(TitleBar).state = ""
        self.query_one(TabbedContent).display = False
        await self.mount(Problems(message.error), before=self.query_one(Footer))

    def action_page(self, name: str) -> None:
        """Show one page."""
        pages = self.query_one(TabbedContent)
        if pages.display:
            pages.active = name
            self.query_one(f"#{name} DataTable", DataTable).focus()

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
        row = self.query_one("#sessions DataTable", DataTable).cursor_row
        on_sessions = self.query_one(TabbedContent).active == "sessions"
        if not on_sessions or self.project is None or not self.project.sessions:
            return None
        return self.project.sessions[row].id

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
        self.app.push_screen(DiagnosisScreen(self.folder, name), self._diagnosed)

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

    def _diagnosed(self, _: None) -> None:
        self.action_reload()

    def _made(self, session: str | None) -> None:
        if session is not None:
            self.post_message(self.SessionChosen(session))

    async def action_back(self) -> None:
        """Leave the project; nothing is unsaved here."""
        await self.app.run_action("leave")

    def details(self, page: str, row: int) -> Text:
        """What is known of a row of a page."""
        if self.result is None or self.project is None:
            return Text()
        width = self.size.width - SIDES
        return details_of(self.project, self.result, page, row, width=width)
