"""One traverse after the adjustment: plan, adjustment, points, observations, checks.

Nothing is changed here.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import ClassVar

from textual.binding import Binding, BindingType
from textual.widget import Widget

from surveyapp import api
from surveyapp.domain.adjustment import AdjustmentResult
from surveyapp.domain.results import Check
from surveyapp.report.blocks import Block
from surveyapp.report.sections import checks as of_checks
from surveyapp.tui import texts
from surveyapp.tui.page_keys import page_bindings
from surveyapp.tui.screens.paged import PagedScreen
from surveyapp.tui.views import traverse as view
from surveyapp.tui.widgets.blocks_pane import BlocksPane
from surveyapp.tui.widgets.plan import PlanCanvas
from surveyapp.tui.widgets.records import Records
from surveyapp.tui.widgets.titlebar import TitleBar
from surveyapp_models.angles import AngleUnit

PAGES = {
    "plan": texts.TAB_PLAN,
    "adjustment": texts.TAB_ADJUSTMENT,
    "points": texts.TAB_POINTS,
    "observations": texts.TAB_OBSERVATIONS,
    "checks": texts.TAB_ALL_CHECKS,
}


class TraverseScreen(PagedScreen[tuple[AdjustmentResult, tuple[Check, ...]]]):
    """Shows the traverses of a project, one after the other."""

    PAGES = PAGES
    BINDINGS: ClassVar[list[BindingType]] = [
        *page_bindings(PAGES),
        Binding("t", "next", texts.KEY_NEXT_TRAVERSE),
        Binding("f5", "reload", texts.KEY_RELOAD, tooltip=texts.LONG_RELOAD),
        Binding("escape", "leave", texts.KEY_BACK),
    ]
    DEFAULT_CSS = "PlanCanvas { width: 1fr; height: 1fr; padding: 0 1; text-wrap: nowrap; }"

    def __init__(self, folder: str, names: tuple[str, ...], unit: AngleUnit) -> None:
        super().__init__(texts.TRAVERSE_TITLE.format(name=Path(folder).resolve().name))
        self.folder = folder
        self.names = names
        self.unit = unit
        self.place = 0
        self.checks: list[Check] = []

    def page(self, name: str) -> Iterable[Widget]:
        """The plan, a text, or a list."""
        if name == "plan":
            yield PlanCanvas()
        elif name == "adjustment":
            yield BlocksPane()
        elif name == "checks":
            yield Records(empty=texts.NO_CHECK_ROWS, details=self._check)
        else:
            yield Records(empty=texts.PLAN_EMPTY)

    def action_next(self) -> None:
        """Show the next traverse."""
        if len(self.names) > 1:
            self.place = (self.place + 1) % len(self.names)
            self.action_reload()

    def read(self) -> tuple[AdjustmentResult, tuple[Check, ...]]:
        """Adjust the book as it is now."""
        found = api.compute(self.folder)
        return api.adjust(found, traverse=self.names[self.place]), found.result.checks

    def fill(self, found: tuple[AdjustmentResult, tuple[Check, ...]]) -> None:
        """Fill the pages."""
        result, checks = found
        self.checks = of_checks.ordered(checks)
        name = self.names[self.place]
        self.query_one(TitleBar).state = f"{name}: {view.state_text(result)}"
        self.query_one(PlanCanvas).show(result)
        self.show_pages(view.pages(result, checks, self.unit))

    def _check(self, row: int) -> tuple[Block, ...]:
        return of_checks.details(self.checks[row])
