"""The orientation through the shafts of a project: azimuths, swings, triangles, plumbing."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import ClassVar

from textual.binding import Binding, BindingType
from textual.widget import Widget

from surveyapp import api
from surveyapp.domain.shaft_result import ShaftResult
from surveyapp.tui import texts
from surveyapp.tui.page_keys import page_bindings
from surveyapp.tui.screens.paged import PagedScreen
from surveyapp.tui.views import shafts as view
from surveyapp.tui.widgets.blocks_pane import BlocksPane
from surveyapp.tui.widgets.shaft_pictures import SwingPictures, TrianglePictures
from surveyapp.tui.widgets.titlebar import TitleBar
from surveyapp_models.angles import AngleUnit

PAGES = {
    "azimuth": texts.TAB_SHAFT,
    "swings": texts.TAB_SWINGS,
    "triangles": texts.TAB_TRIANGLES,
    "plumbing": texts.TAB_PLUMBING,
}


class ShaftScreen(PagedScreen[ShaftResult]):
    """Shows the shafts of a project, one after the other."""

    PAGES = PAGES
    BINDINGS: ClassVar[list[BindingType]] = [
        *page_bindings(PAGES),
        Binding("t", "next", texts.KEY_NEXT_SHAFT),
        Binding("f5", "reload", texts.KEY_RELOAD, tooltip=texts.LONG_RELOAD),
        Binding("escape", "leave", texts.KEY_BACK),
    ]
    DEFAULT_CSS = """
    SwingPictures, TrianglePictures { width: 1fr; height: 1fr; padding: 0 1; text-wrap: nowrap; }
    """

    def __init__(self, folder: str, unit: AngleUnit) -> None:
        super().__init__(texts.SHAFT_TITLE.format(name=Path(folder).resolve().name))
        self.folder = folder
        self.unit = unit
        self.place = 0
        self.result: ShaftResult | None = None

    def page(self, name: str) -> Iterable[Widget]:
        """Pictures or a text."""
        if name == "swings":
            yield SwingPictures()
        elif name == "triangles":
            yield TrianglePictures()
        else:
            yield BlocksPane()

    def action_next(self) -> None:
        """Show the next shaft."""
        if self.result is not None and len(self.result.shafts) > 1:
            self.place = (self.place + 1) % len(self.result.shafts)
            self.fill(self.result)

    def read(self) -> ShaftResult:
        """Orient from the books as they are now."""
        return api.shaft(self.folder)

    def fill(self, found: ShaftResult) -> None:
        """Show one shaft."""
        self.result = found
        self.place = min(self.place, len(found.shafts) - 1)
        shaft = found.shafts[self.place]
        self.query_one(TitleBar).state = view.state_text(shaft, self.unit)
        self.query_one(SwingPictures).show(shaft)
        self.query_one(TrianglePictures).show(shaft)
        self.show_pages(view.pages(found, shaft, self.unit))
