"""The sensors of a project: logs, cards with their validity, guided programmes."""

from __future__ import annotations

from collections.abc import Iterable
from datetime import datetime
from functools import partial
from pathlib import Path
from typing import ClassVar, cast

from textual.binding import Binding, BindingType
from textual.widget import Widget

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
from surveyapp.report.blocks import Block
from surveyapp.tui import texts
from surveyapp.tui.page_keys import page_bindings
from surveyapp.tui.screens.paged import PagedScreen
from surveyapp.tui.views import programmes as run_view
from surveyapp.tui.views import sensors as view
from surveyapp.tui.widgets.records import Records

PAGES = {
    "logs": texts.TAB_LOGS,
    "cards": texts.TAB_CARDS,
    "programmes": texts.TAB_PROGRAMMES,
}
EMPTY = {"logs": texts.SENSOR_NO_LOGS, "cards": texts.SENSOR_NO_CARDS, "programmes": ""}
"""What each page says without rows."""


class SensorsScreen(PagedScreen[tuple[SensorDesk, tuple[RunShown, ...]]]):
    """Lists what a project has of sensors."""

    PAGES = PAGES
    READS_AGAIN = True

    BINDINGS: ClassVar[list[BindingType]] = [
        *page_bindings(PAGES),
        Binding("o,enter", "open", texts.KEY_OPEN, tooltip=texts.LONG_OPEN_LOG),
        Binding("a", "add", texts.KEY_ADD_LOG, tooltip=texts.LONG_ADD_LOG),
        Binding("f5", "reload", texts.KEY_RELOAD, tooltip=texts.LONG_RELOAD),
        Binding("escape", "leave", texts.KEY_BACK, tooltip=texts.LONG_BACK),
    ]

    def __init__(self, folder: str) -> None:
        super().__init__(texts.SENSORS_TITLE.format(name=Path(folder).resolve().name))
        self.folder = folder
        self.desk: SensorDesk | None = None
        self.runs: tuple[RunShown, ...] = ()

    def page(self, name: str) -> Iterable[Widget]:
        """A list with its details."""
        yield Records(empty=EMPTY[name], details=partial(self.details, name), beside=True)

    def read(self) -> tuple[SensorDesk, tuple[RunShown, ...]]:
        """Logs, cards and runs, as the folder holds them."""
        runs, problems = runs_of(self.folder)
        for problem in problems:
            told = partial(self.notify, shown(problem.text), severity="error", markup=False)
            self.app.call_from_thread(told)
        return sensor_desk(self.folder, self.moment().date()), runs

    def fill(self, found: tuple[SensorDesk, tuple[RunShown, ...]]) -> None:
        """Fill the pages."""
        self.desk, self.runs = found
        self.show_pages(
            {
                "logs": (view.log_table(self.desk.logs, self.desk.cards),),
                "cards": (view.card_table(self.desk.cards),),
                "programmes": (run_view.run_table(self.runs),),
            }
        )

    def on_data_table_row_selected(self) -> None:
        """Enter on a row opens it."""
        self.action_open()

    def action_open(self) -> None:
        """Open the log or the programme under the cursor."""
        page = self.active
        if self.desk is None or page not in ("logs", "programmes"):
            return
        row = self.row_of(page)
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

    def details(self, page: str, row: int) -> tuple[Block, ...]:
        """What is known of a row of a page."""
        if self.desk is None:
            return ()
        if page == "programmes":
            return run_view.run_details(self.runs, row)
        if page == "cards":
            return view.card_details(self.desk.cards[row])
        return view.log_details(self.desk.logs[row])
