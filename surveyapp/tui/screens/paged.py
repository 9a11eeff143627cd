"""What every screen with pages is: a title, pages behind number keys, one computation in a thread.

A screen says which pages it has, what stands on them, how it reads and how it fills them.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterable, Mapping
from typing import ClassVar, Generic, TypeVar, cast

from textual import work
from textual.app import ComposeResult
from textual.message import Message
from textual.screen import Screen
from textual.widget import Widget
from textual.widgets import DataTable, TabbedContent, TabPane

from surveyapp.errors import SurveyError
from surveyapp.report.blocks import Block, Table
from surveyapp.tui import texts
from surveyapp.tui.widgets.blocks_pane import BlocksPane
from surveyapp.tui.widgets.key_bar import KeyBar
from surveyapp.tui.widgets.problems import Problems
from surveyapp.tui.widgets.records import Records
from surveyapp.tui.widgets.titlebar import TitleBar

Found = TypeVar("Found")


class PagedScreen(Screen[None], Generic[Found]):
    """A screen with pages.

    Parameters
    ----------
    title : str
    """

    PAGES: ClassVar[Mapping[str, str]] = {}
    """Tab by the id of its page."""
    READS_AGAIN: ClassVar[bool] = False
    """Whether it reads again when one comes back from another screen."""

    class Done(Message):
        """The computation has ended."""

        def __init__(self, found: object) -> None:
            super().__init__()
            self.found = found

    class Failed(Message):
        """There is nothing to show, and why."""

        def __init__(self, error: SurveyError) -> None:
            super().__init__()
            self.error = error

    def __init__(self, title: str) -> None:
        super().__init__()
        self.title_text = title
        self.left = False

    @abstractmethod
    def page(self, name: str) -> Iterable[Widget]:
        """What stands on a page."""

    @abstractmethod
    def read(self) -> Found:
        """Read and compute, in a thread; it touches no widget."""

    @abstractmethod
    def fill(self, found: Found) -> None:
        """Show what was found."""

    def refused(self, error: SurveyError) -> None:
        """What a screen keeps of an error."""

    def above(self) -> Iterable[Widget]:
        """What stands between the title and the pages."""
        return ()

    def compose(self) -> ComposeResult:
        """Title, pages, keys."""
        yield TitleBar(self.title_text)
        yield from self.above()
        with TabbedContent():
            for name, tab in self.PAGES.items():
                with TabPane(tab, id=name):
                    yield from self.page(name)
        yield KeyBar()

    def on_mount(self) -> None:
        """Begin to compute."""
        self.action_reload()

    def on_screen_suspend(self) -> None:
        """Another screen stands before this one."""
        self.left = True

    def on_screen_resume(self) -> None:
        """Back from another screen, whichever way it was left."""
        if self.left and self.READS_AGAIN:
            self.action_reload()
        self.left = False

    def action_reload(self) -> None:
        """Read the folder again."""
        self.query_one(TitleBar).state = texts.COMPUTING
        self.compute()

    @work(thread=True, exclusive=True)
    def compute(self) -> None:
        """Read in a thread; the result comes as a message."""
        try:
            self.post_message(PagedScreen.Done(self.read()))
        except SurveyError as error:
            self.post_message(PagedScreen.Failed(error))

    async def on_paged_screen_done(self, message: Done) -> None:
        """Fill the pages."""
        await self.query(Problems).remove()
        pages = self.query_one(TabbedContent)
        pages.display = True
        self.query_one(TitleBar).state = ""
        self.fill(cast("Found", message.found))
        self.action_page(pages.active)

    async def on_paged_screen_failed(self, message: Failed) -> None:
        """Say in words what is wrong."""
        self.refused(message.error)
        await self.query(Problems).remove()
        self.query_one(TitleBar).state = ""
        self.query_one(TabbedContent).display = False
        await self.mount(Problems(message.error), before=self.query_one(KeyBar))

    def show_pages(self, pages: Mapping[str, tuple[Block, ...]]) -> None:
        """Show blocks of the record: a page with a list shows its table."""
        for name, blocks in pages.items():
            for pane in self.query(f"#{name} BlocksPane").results(BlocksPane):
                pane.show(blocks)
            for records in self.query(f"#{name} Records").results(Records):
                for table in blocks:
                    if isinstance(table, Table):
                        records.show(table)

    @property
    def active(self) -> str:
        """Id of the page that is shown; empty where a problem stands in their place."""
        pages = self.query_one(TabbedContent)
        return pages.active if pages.display else ""

    def row_of(self, page: str) -> int:
        """The row under the cursor of a page with a list."""
        return self.query_one(f"#{page} DataTable", DataTable).cursor_row

    def action_page(self, name: str) -> None:
        """Show one page; the keys of its list or text work at once."""
        pages = self.query_one(TabbedContent)
        if not pages.display:
            return
        pages.active = name
        for widget in self.query(f"#{name} DataTable, #{name} BlocksPane"):
            widget.focus()
            break

    def action_leave(self) -> None:
        """Back to where one came from."""
        self.dismiss(None)
