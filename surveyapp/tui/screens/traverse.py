"""One traverse after the adjustment: plan, points, observations, closures, checks.

The adjustment runs in a thread; its result comes back as a message. Nothing is changed here.
"""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

from rich.text import Text
from textual import work
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.message import Message
from textual.screen import Screen
from textual.widgets import DataTable, Footer, TabbedContent, TabPane

from surveyapp import api
from surveyapp.domain.adjustment import AdjustmentResult
from surveyapp.domain.results import Check
from surveyapp.errors import SurveyError
from surveyapp.languages import shown
from surveyapp.tui import texts
from surveyapp.tui.page_keys import page_bindings
from surveyapp.tui.views import traverse as view
from surveyapp.tui.widgets.plan import PlanCanvas
from surveyapp.tui.widgets.problems import Problems
from surveyapp.tui.widgets.records import Records, pairs_text
from surveyapp.tui.widgets.titlebar import TitleBar
from surveyapp_models.angles import AngleUnit

PAGES = {
    "plan": texts.TAB_PLAN,
    "points": texts.TAB_POINTS,
    "observations": texts.TAB_OBSERVATIONS,
    "closures": texts.TAB_CLOSURES,
    "checks": texts.TAB_ALL_CHECKS,
}


class TraverseScreen(Screen[None]):
    """Shows the traverses of a project, one after the other."""

    BINDINGS: ClassVar[list[BindingType]] = [
        *page_bindings(PAGES),
        Binding("t", "next", texts.KEY_NEXT_TRAVERSE),
        Binding("f5", "reload", texts.KEY_RELOAD, tooltip=texts.LONG_RELOAD),
        Binding("escape", "leave", texts.KEY_BACK),
    ]
    DEFAULT_CSS = "PlanCanvas { width: 1fr; height: 1fr; padding: 0 1; text-wrap: nowrap; }"

    class Adjusted(Message):
        """The computation has ended."""

        def __init__(self, result: AdjustmentResult, checks: tuple[Check, ...]) -> None:
            super().__init__()
            self.result = result
            self.checks = checks

    class Failed(Message):
        """The traverse cannot be adjusted."""

        def __init__(self, error: SurveyError) -> None:
            super().__init__()
            self.error = error

    def __init__(self, folder: str, names: tuple[str, ...], unit: AngleUnit) -> None:
        super().__init__()
        self.folder = folder
        self.names = names
        self.unit = unit
        self.place = 0
        self.result: AdjustmentResult | None = None
        self.checks: tuple[Check, ...] = ()

    def compose(self) -> ComposeResult:
        """Title, pages, keys."""
        yield TitleBar(texts.TRAVERSE_TITLE.format(name=Path(self.folder).resolve().name))
        with TabbedContent():
            with TabPane(texts.TAB_PLAN, id="plan"):
                yield PlanCanvas()
            with TabPane(texts.TAB_POINTS, id="points"):
                yield Records(view.POINT_COLUMNS, empty=texts.PLAN_EMPTY, details=self._point)
            with TabPane(texts.TAB_OBSERVATIONS, id="observations"):
                yield Records(
                    view.OBSERVATION_COLUMNS, empty=texts.PLAN_EMPTY, details=self._observation
                )
            with TabPane(texts.TAB_CLOSURES, id="closures"):
                yield Records(view.CLOSURE_COLUMNS, empty=texts.NO_CLOSURES)
            with TabPane(texts.TAB_ALL_CHECKS, id="checks"):
                yield Records(view.CHECK_COLUMNS, empty=texts.NO_CHECK_ROWS, details=self._check)
        yield Footer(show_command_palette=False)

    def on_mount(self) -> None:
        """Begin to compute."""
        self.action_reload()

    def action_reload(self) -> None:
        """Adjust again, from the book as it is now."""
        self.query_one(TitleBar).state = texts.COMPUTING
        self.compute(self.names[self.place])

    def action_next(self) -> None:
        """Show the next traverse."""
        if len(self.names) > 1:
            self.place = (self.place + 1) % len(self.names)
            self.action_reload()

    @work(thread=True, exclusive=True)
    def compute(self, name: str) -> None:
        """Adjust in a thread; the result comes as a message."""
        try:
            found = api.compute(self.folder)
            result = api.adjust(found, traverse=name)
            self.post_message(self.Adjusted(result, found.result.checks))
        except SurveyError as error:
            self.post_message(self.Failed(error))

    async def on_traverse_screen_adjusted(self, message: Adjusted) -> None:
        """Fill the pages."""
        await self.query(Problems).remove()
        self.query_one(TabbedContent).display = True
        self.result, self.checks = message.result, message.checks
        name = self.names[self.place]
        bar = self.query_one(TitleBar)
        bar.state = f"{name}: {view.state_text(message.result)}"
        self.query_one(PlanCanvas).show(message.result)
        rows = {
            "points": view.point_rows(message.result),
            "observations": view.observation_rows(message.result),
            "closures": view.closure_rows(message.result),
            "checks": view.check_rows(message.checks),
        }
        for page, values in rows.items():
            self.query_one(f"#{page} Records", Records).show(values)

    async def on_traverse_screen_failed(self, message: Failed) -> None:
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

    def action_leave(self) -> None:
        """Back to the project."""
        self.dismiss(None)

    def _point(self, row: int) -> Text:
        return Text() if self.result is None else pairs_text(view.point_details(self.result, row))

    def _observation(self, row: int) -> Text:
        if self.result is None:
            return Text()
        return pairs_text(view.observation_details(self.result, row, self.unit))

    def _check(self, row: int) -> Text:
        if not self.checks:
            return Text()
        check = view.ordered(self.checks)[row]
        return Text("\n".join(shown(part) for part in (check.where, check.clause) if part))
