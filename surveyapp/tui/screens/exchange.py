"""Files of other programs: a list, a preview of what was understood, one key to take it.

Reading runs in a thread; nothing is written before the key.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import ClassVar, Final

from textual import work
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Horizontal, VerticalScroll
from textual.screen import Screen
from textual.widgets import Footer, Input, OptionList, Static
from textual.widgets.option_list import Option

from surveyapp.domain.fieldfile import ImportResult
from surveyapp.errors import SurveyError
from surveyapp.observation import exchange
from surveyapp.tui import texts
from surveyapp.tui.views.exchange import entry_text, import_text
from surveyapp.tui.widgets.field import TextField, typed
from surveyapp.tui.widgets.problems import problems_text
from surveyapp.tui.widgets.titlebar import TitleBar

_EVERY_PERCENT: Final = 5


class ImportScreen(Screen[None]):
    """A field file into a project.

    Parameters
    ----------
    folder : str
        The project.
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
    ImportScreen #files { width: 34; height: 1fr; }
    ImportScreen #preview { width: 1fr; height: 1fr; padding: 0 1; }
    ImportScreen #exchange { height: 1fr; }
    """

    def __init__(self, folder: str, begin: str = ".") -> None:
        super().__init__()
        self.folder = folder
        self.place = begin
        self.entries: list[exchange.Entry] = []
        self.chosen: exchange.Entry | None = None

    def compose(self) -> ComposeResult:
        """Title, files and preview, options, keys."""
        name = Path(self.folder).resolve().name
        yield TitleBar(texts.IMPORT_TITLE.format(name=name))
        with Horizontal(id="exchange"):
            yield OptionList(id="files", compact=True)
            with VerticalScroll(id="preview", can_focus=False):
                yield Static(texts.IMPORT_CHOOSE, id="understood-file", markup=False)
        yield TextField(texts.IMPORT_OPTIONS, "options", hint=texts.IMPORT_HINT)
        yield Footer(show_command_palette=False)

    def on_mount(self) -> None:
        """List the files where the program was started."""
        self.show_files(self.place)

    def show_files(self, place: str) -> None:
        """List one folder."""
        try:
            found = exchange.entries(place)
        except SurveyError as error:
            self.query_one("#understood-file", Static).update(problems_text(error))
            return
        self.place, self.entries = place, found
        files = self.query_one("#files", OptionList)
        files.clear_options()
        files.add_options([Option(entry_text(entry)) for entry in found])
        files.focus()
        files.highlighted = 0

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """A folder is listed, a file previewed."""
        entry = self.entries[event.option_index]
        if entry.format:
            self.chosen = entry
            self.begin(preview=True)
        else:
            self.show_files(entry.path)

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Options change what is understood."""
        self.begin(preview=True)

    def action_turn(self, pages: int) -> None:
        """Move the preview: the list of files keeps the cursor."""
        preview = self.query_one("#preview", VerticalScroll)
        (preview.scroll_page_down if pages > 0 else preview.scroll_page_up)()

    def action_take(self) -> None:
        """Take the file into the project."""
        self.begin(preview=False)

    def begin(self, *, preview: bool) -> None:
        """Read the chosen file in a thread."""
        if self.chosen is None:
            return
        self.query_one(TitleBar).state = texts.IMPORT_READING
        self.read(self.chosen, typed(self, "options"), preview=preview)

    @work(thread=True, exclusive=True)
    def read(self, entry: exchange.Entry, options: str, *, preview: bool) -> None:
        """Preview or take; the answer comes back to the screen."""
        told = -1

        def progress(part: float) -> None:
            nonlocal told
            percent = int(100.0 * part)
            if percent >= told + _EVERY_PERCENT:
                told = percent
                self.app.call_from_thread(self.tell_part, percent)

        try:
            result = exchange.bring(entry, self.folder, options, preview=preview, progress=progress)
        except SurveyError as error:
            self.app.call_from_thread(partial(self.refused, error))
        else:
            self.app.call_from_thread(partial(self.show, result))

    def tell_part(self, percent: int) -> None:
        """Say how much of a large file is read."""
        self.query_one(TitleBar).state = texts.IMPORT_PART.format(percent=percent)

    def show(self, result: ImportResult) -> None:
        """Show what was understood."""
        self.query_one("#understood-file", Static).update(import_text(result))
        taken = texts.IMPORT_TAKEN if result.written else texts.IMPORT_PREVIEW
        self.query_one(TitleBar).state = taken
        if result.written:
            self.chosen = None

    def refused(self, error: SurveyError) -> None:
        """Say in words what is wrong."""
        self.query_one("#understood-file", Static).update(problems_text(error))
        self.query_one(TitleBar).state = texts.IMPORT_REFUSED

    def action_leave(self) -> None:
        """Back to the project."""
        self.dismiss(None)
