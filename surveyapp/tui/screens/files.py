"""A file of another program into the project: a list, a preview of what was understood, one key.

Reading runs in a thread; nothing is written before the key.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from functools import partial
from typing import ClassVar, Final, Generic, TypeVar

from textual import work
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Horizontal
from textual.screen import Screen
from textual.widgets import Input, OptionList
from textual.widgets.option_list import Option

from surveyapp.errors import SurveyError
from surveyapp.observation.exchange import Entry
from surveyapp.report.blocks import Block
from surveyapp.tui import texts
from surveyapp.tui.views.exchange import entry_text
from surveyapp.tui.widgets.blocks_pane import BlocksPane
from surveyapp.tui.widgets.field import TextField, typed
from surveyapp.tui.widgets.key_bar import KeyBar
from surveyapp.tui.widgets.problems import problem_blocks
from surveyapp.tui.widgets.titlebar import TitleBar

_EVERY_PERCENT: Final = 5
Understood = TypeVar("Understood")
PartRead = Callable[[float], None]


class FilesScreen(Screen[None], Generic[Understood]):
    """Files on the left, what is understood of one on the right, options below.

    Parameters
    ----------
    title : str
    begin : str
        Folder whose files are listed first.
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("tab", "app.focus_next", texts.KEY_FIELD),
        Binding("pagedown", "turn(1)", texts.KEY_PREVIEW, key_display="pgdn", priority=True),
        Binding("pageup", "turn(-1)", texts.KEY_PREVIEW, show=False, priority=True),
        Binding("f8", "take", texts.KEY_TAKE),
        Binding("escape", "leave", texts.KEY_BACK),
    ]
    DEFAULT_CSS = """
    FilesScreen #files {
        width: 34%; min-width: 24; height: 1fr; text-wrap: nowrap; text-overflow: ellipsis;
    }
    FilesScreen #preview { width: 1fr; height: 1fr; padding: 0 1; }
    FilesScreen #exchange { height: 1fr; }
    """
    CHOOSE: ClassVar[tuple[Block, ...]] = ()
    """What the preview says before a file is chosen."""
    OPTIONS: ClassVar[str] = ""
    HINT: ClassVar[str] = ""

    def __init__(self, title: str, begin: str) -> None:
        super().__init__()
        self.title_text = title
        self.place = begin
        self.entries: list[Entry] = []
        self.chosen: Entry | None = None

    @abstractmethod
    def listed(self, place: str) -> list[Entry]:
        """Folders and files of a folder that may be taken."""

    @abstractmethod
    def look(self, entry: Entry, options: str, *, preview: bool, progress: PartRead) -> Understood:
        """Preview or take a file, in a thread."""

    @abstractmethod
    def told(self, found: Understood) -> tuple[tuple[Block, ...], str, bool]:
        """What was understood, its state in a few words, and whether it was taken."""

    def compose(self) -> ComposeResult:
        """Title, files and preview, options, keys."""
        yield TitleBar(self.title_text)
        with Horizontal(id="exchange"):
            yield OptionList(id="files", compact=True, markup=False)
            pane = BlocksPane(can_focus=False)
            pane.id = "preview"
            yield pane
        yield TextField(self.OPTIONS, "options", hint=self.HINT)
        yield KeyBar()

    def on_mount(self) -> None:
        """List the files where the program was started."""
        self.query_one(BlocksPane).show(self.CHOOSE)
        self.show_files(self.place)

    def show_files(self, place: str) -> None:
        """List one folder."""
        try:
            found = self.listed(place)
        except SurveyError as error:
            self.refused(error)
            return
        self.place, self.entries = place, found
        files = self.query_one("#files", OptionList)
        files.clear_options()
        files.add_options([Option(entry_text(entry)) for entry in found])
        files.focus()
        files.highlighted = 0

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """A folder is listed, a file looked at."""
        entry = self.entries[event.option_index]
        if entry.format:
            self.chosen = entry
            self.begin(preview=True)
        else:
            self.show_files(entry.path)

    def on_input_submitted(self, _: Input.Submitted) -> None:
        """Options change what is understood."""
        self.begin(preview=True)

    def action_turn(self, pages: int) -> None:
        """Move the preview: the list of files keeps the cursor."""
        preview = self.query_one(BlocksPane)
        (preview.scroll_page_down if pages > 0 else preview.scroll_page_up)()

    def action_take(self) -> None:
        """Take the file into the project."""
        self.begin(preview=False)

    def begin(self, *, preview: bool) -> None:
        """Read the chosen file in a thread."""
        if self.chosen is None:
            self.query_one(TitleBar).state = texts.IMPORT_CHOOSE_FIRST
            return
        self.query_one(TitleBar).state = texts.IMPORT_READING
        self.work_on(self.chosen, typed(self, "options"), preview=preview)

    @work(thread=True, exclusive=True)
    def work_on(self, entry: Entry, options: str, *, preview: bool) -> None:
        """Preview or take; the answer comes back to the screen."""
        told = -1

        def progress(part: float) -> None:
            nonlocal told
            percent = int(100.0 * part)
            if percent >= told + _EVERY_PERCENT:
                told = percent
                self.app.call_from_thread(self.tell_part, percent)

        try:
            found = self.look(entry, options, preview=preview, progress=progress)
        except SurveyError as error:
            self.app.call_from_thread(partial(self.refused, error))
        else:
            self.app.call_from_thread(partial(self.show, found))

    def tell_part(self, percent: int) -> None:
        """Say how much of a large file is read."""
        self.query_one(TitleBar).state = texts.IMPORT_PART.format(percent=percent)

    def show(self, found: Understood) -> None:
        """Show what was understood."""
        blocks, state, taken = self.told(found)
        self.query_one(BlocksPane).show(blocks)
        self.query_one(BlocksPane).scroll_home(animate=False)
        self.query_one(TitleBar).state = state
        if taken:
            self.chosen = None

    def refused(self, error: SurveyError) -> None:
        """Say in words what is wrong."""
        self.query_one(BlocksPane).show(problem_blocks(error))
        self.query_one(TitleBar).state = texts.IMPORT_REFUSED

    def action_leave(self) -> None:
        """Back to where one came from."""
        self.dismiss(None)
