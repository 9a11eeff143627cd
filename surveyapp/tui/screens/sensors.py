"""The sensors of a project: logs, cards with their validity, guided programmes."""

from __future__ import annotations

from datetime import datetime
from functools import partial
from pathlib import Path
from typing import ClassVar, cast

from rich.text import Text
from textual import work
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.message import Message
from textual.screen import Screen
from textual.widgets import DataTable, Footer, TabbedContent, TabPane

from surveyapp import api
from surveyapp.core.sensors.programmes.catalogue import PROGRAMMES
from surveyapp.errors import SurveyError
from surveyapp.languages import shown
from surveyapp.observation.sensors.desk import SensorDesk, sensor_desk
from surveyapp.observation.sensors.programmes import (
    ProgrammeDesk,
    RunShown,
    free_id,
    runs_of,
)
from surveyapp.tui import texts
from surveyapp.tui.page_keys import page_bindings
from surveyapp.tui.views import programmes as run_view
from surveyapp.tui.views import sensors as view
from surveyapp.tui.widgets.problems import Problems
from surveyapp.tui.widgets.records import Records
from surveyapp.tui.widgets.titlebar import TitleBar

PAGES = {
    "logs": texts.TAB_LOGS,
    "cards": texts.TAB_CARDS,
    "programmes": texts.TAB_PROGRAMMES,
}


class SensorsScreen(Screen[None]):
    """Lists what a project has of sensors."""

    BINDINGS: ClassVar[list[BindingType]] = [
        *page_bindings(PAGES),
        Binding("enter", "open", texts.KEY_OPEN, tooltip=texts.LONG_OPEN_LOG),
        Binding("a", "add", texts.KEY_ADD_LOG, tooltip=texts.LONG_ADD_LOG),
        Binding("f5", "reload", texts.KEY_RELOAD, tooltip=texts.LONG_RELOAD),
        Binding("escape", "leave", texts.KEY_BACK, tooltip=texts.LONG_BACK),
    ]

    class Read(Message):
        """The folder was read."""

        def __init__(self, desk: SensorDesk, runs: tuple[RunShown, ...]) -> None:
            super().__init__()
            self.desk = desk
            self.runs = runs

    class Failed(Message):
        """The folder cannot be used."""

        def __init__(self, error: SurveyError) -> None:
            super().__init__()
            self.error = error

    def __init__(self, folder: str) -> None:
        super().__init__()
        self.folder = folder
        self.desk: SensorDesk | None = None
        self.runs: tuple[RunShown, ...] = ()
        self.left = False

    def compose(self) -> ComposeResult:
        """Title, pages, keys."""
        yield TitleBar(texts.SENSORS_TITLE.format(name=Path(self.folder).resolve().name))
        with TabbedContent():
            with TabPane(texts.TAB_LOGS, id="logs"):
                yield Records(view.LOG_COLUMNS, empty=texts.SENSOR_NO_LOGS, details=self._log)
            with TabPane(texts.TAB_CARDS, id="cards"):
                yield Records(view.CARD_COLUMNS, empty=texts.SENSOR_NO_CARDS, details=self._card)
            with TabPane(texts.TAB_PROGRAMMES, id="programmes"):
                yield Records(run_view.RUN_COLUMNS, empty="", details=self._programme)
        yield Footer(show_command_palette=False)

    def on_mount(self) -> None:
        """Read the folder."""
        self.action_reload()

    def on_screen_suspend(self) -> None:
        """Another screen stands before this one: what it does may change the folder."""
        self.left = True

    def on_screen_resume(self) -> None:
        """Back from another screen."""
        if self.left:
            self.left = False
            self.action_reload()

    def action_reload(self) -> None:
        """Read the folder again."""
        self.read(self.moment())

    @work(thread=True, exclusive=True)
    def read(self, moment: datetime) -> None:
        """Read logs and cards in a thread."""
        try:
            runs, problems = runs_of(self.folder)
            self.post_message(self.Read(sensor_desk(self.folder, moment.date()), runs))
            for problem in problems:
                told = partial(self.notify, shown(problem.text), severity="error", markup=False)
                self.app.call_from_thread(told)
        except SurveyError as error:
            self.post_message(self.Failed(error))

    async def on_sensors_screen_read(self, message: Read) -> None:
        """Fill the pages."""
        await self.query(Problems).remove()
        self.query_one(TabbedContent).display = True
        self.desk, self.runs = message.desk, message.runs
        rows = {
            "logs": view.log_rows(message.desk.logs, message.desk.cards),
            "cards": view.card_rows(message.desk.cards),
            "programmes": run_view.run_rows(message.runs),
        }
        for page, found in rows.items():
            table = self.query_one(f"#{page} DataTable", DataTable)
            row = table.cursor_row
            self.query_one(f"#{page} Records", Records).show(found)
            if found:
                table.move_cursor(row=max(row, 0))
        self.action_page(self.query_one(TabbedContent).active)

    async def on_sensors_screen_failed(self, message: Failed) -> None:
        """Say in words what is wrong."""
        await self.query(Problems).remove()
        self.query_one(TabbedContent).display = False
        await self.mount(Problems(message.error), before=self.query_one(Footer))

    def action_page(self, name: str) -> None:
        """Show one page."""
        pages = self.query_one(TabbedContent)
        if pages.display:
            pages.active = name
            self.query_one(f"#{name} DataTable", DataTable).focus()

    def on_data_table_row_selected(self) -> None:
        """Enter on a row opens it."""
        self.action_open()

    def action_open(self) -> None:
        """Open the log or the programme under the cursor."""
        page = self.query_one(TabbedContent).active
        row = self.query_one(f"#{page} DataTable", DataTable).cursor_row
        if self.desk is None or page == "cards":
            return
        if page == "programmes":
            self.open_programme(row)
        elif self.desk.logs:
            from surveyapp.tui.screens.sensor_log import SensorLogScreen

            self.app.push_screen(SensorLogScreen(self.folder, self.desk.logs[row]))

    def open_programme(self, row: int) -> None:
        """Go on with a run, or begin a new one."""
        from surveyapp.tui.screens.programme import ProgrammeScreen

        begun = row < len(self.runs)
        try:
            if begun:
                identity = self.runs[row].run.id
            else:
                programme = PROGRAMMES[row - len(self.runs)]
                identity = free_id(self.folder, programme.id)
                api.begin_programme(self.folder, programme.id, identity, now=self.moment())
            desk = ProgrammeDesk(self.folder, identity, now=self.moment)
        except SurveyError as error:
            self.notify(shown(error.text), severity="error", markup=False)
            return
        self.app.push_screen(ProgrammeScreen(desk))

    def moment(self) -> datetime:
        """The wall clock of the program."""
        from surveyapp.tui.app import SurveyApp

        return cast("SurveyApp", self.app).now()

    def action_add(self) -> None:
        """Take a log into the project."""
        from surveyapp.tui.screens.add_log import AddLogScreen

        self.app.push_screen(AddLogScreen(self.folder))

    def action_leave(self) -> None:
        """Back to the project."""
        self.dismiss(None)

    def _log(self, row: int) -> Text:
        return Text() if self.desk is None else view.log_details(self.desk.logs[row])

    def _programme(self, row: int) -> Text:
        return run_view.run_details(self.runs, row)

    def _card(self, row: int) -> Text:
        return Text() if self.desk is None else view.card_details(self.desk.cards[row])
