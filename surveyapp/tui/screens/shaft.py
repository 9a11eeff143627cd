"""The orientation through the shafts of a project: azimuths, swings, triangles, plumbing."""

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
from surveyapp.domain.shaft_result import ShaftOrientation, ShaftResult
from surveyapp.errors import SurveyError
from surveyapp.tui import texts
from surveyapp.tui.page_keys import page_bindings
from surveyapp.tui.views import shafts as view
from surveyapp.tui.widgets.problems import Problems
from surveyapp.tui.widgets.records import Records, pairs_text
from surveyapp.tui.widgets.shaft_pictures import SwingPictures, TrianglePictures
from surveyapp.tui.widgets.titlebar import TitleBar
from surveyapp_models.angles import AngleUnit

PAGES = {
    "azimuth": texts.TAB_SHAFT,
    "swings": texts.TAB_SWINGS,
    "triangles": texts.TAB_TRIANGLES,
    "plumbing": texts.TAB_PLUMBING,
}


class ShaftScreen(Screen[None]):
    """Shows the shafts of a project, one after the other."""

    BINDINGS: ClassVar[list[BindingType]] = [
        *page_bindings(PAGES),
        Binding("t", "next", texts.KEY_NEXT_SHAFT),
        Binding("f5", "reload", texts.KEY_RELOAD, tooltip=texts.LONG_RELOAD),
        Binding("escape", "leave", texts.KEY_BACK),
    ]
    DEFAULT_CSS = """
    SwingPictures, TrianglePictures { width: 1fr; height: 1fr; padding: 0 1; text-wrap: nowrap; }
    """

    class Oriented(Message):
        """The computation has ended."""

        def __init__(self, result: ShaftResult) -> None:
            super().__init__()
            self.result = result

    class Failed(Message):
        """The shafts cannot be used."""

        def __init__(self, error: SurveyError) -> None:
            super().__init__()
            self.error = error

    def __init__(self, folder: str, unit: AngleUnit) -> None:
        super().__init__()
        self.folder = folder
        self.unit = unit
        self.place = 0
        self.shafts: tuple[ShaftOrientation, ...] = ()

    def compose(self) -> ComposeResult:
        """Title, pages, keys."""
        yield TitleBar(texts.SHAFT_TITLE.format(name=Path(self.folder).resolve().name))
        with TabbedContent():
            with TabPane(texts.TAB_SHAFT, id="azimuth"):
                yield Records(view.AZIMUTH_COLUMNS, empty=texts.P_EMPTY, details=self._budget)
            with TabPane(texts.TAB_SWINGS, id="swings"):
                yield SwingPictures()
            with TabPane(texts.TAB_TRIANGLES, id="triangles"):
                yield TrianglePictures()
            with TabPane(texts.TAB_PLUMBING, id="plumbing"):
                yield Records(view.PLUMBING_COLUMNS, empty=texts.P_EMPTY)
        yield Footer(show_command_palette=False)

    def on_mount(self) -> None:
        """Begin to compute."""
        self.action_reload()

    def action_reload(self) -> None:
        """Orient again, from the books as they are now."""
        self.query_one(TitleBar).state = texts.COMPUTING
        self.compute()

    def action_next(self) -> None:
        """Show the next shaft."""
        if len(self.shafts) > 1:
            self.place = (self.place + 1) % len(self.shafts)
            self.show_shaft()

    @work(thread=True, exclusive=True)
    def compute(self) -> None:
        """Orient in a thread; the result comes as a message."""
        try:
            self.post_message(self.Oriented(api.shaft(self.folder)))
        except SurveyError as error:
            self.post_message(self.Failed(error))

    async def on_shaft_screen_oriented(self, message: Oriented) -> None:
        """Show the first shaft."""
        await self.query(Problems).remove()
        self.query_one(TabbedContent).display = True
        self.shafts = message.result.shafts
        self.place = min(self.place, len(self.shafts) - 1)
        self.show_shaft()

    def show_shaft(self) -> None:
        """Fill the pages."""
        shaft = self.shafts[self.place]
        self.query_one(TitleBar).state = view.state_text(shaft, self.unit)
        self.query_one("#azimuth Records", Records).show(view.azimuth_rows(shaft, self.unit))
        self.query_one("#plumbing Records", Records).show(view.plumbing_rows(shaft))
        self.query_one(SwingPictures).show(shaft)
        self.query_one(TrianglePictures).show(shaft)

    async def on_shaft_screen_failed(self, message: Failed) -> None:
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

    def _budget(self, _: int) -> Text:
        if not self.shafts:
            return Text()
        return pairs_text(view.budget_pairs(self.shafts[self.place]))
