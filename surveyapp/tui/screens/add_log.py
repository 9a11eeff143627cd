"""A sensor log into a project: choose a file, say which column is what, see what was understood."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import ClassVar

from textual import work
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Horizontal, VerticalScroll
from textual.screen import Screen
from textual.widgets import Footer, Input, OptionList, Static
from textual.widgets.option_list import Option

from surveyapp.domain.log_preview import LogPreview
from surveyapp.errors import SurveyError
from surveyapp.observation.exchange import Entry
from surveyapp.observation.sensors import adding
from surveyapp.tui import texts
from surveyapp.tui.views.exchange import entry_text
from surveyapp.tui.views.sensors import preview_text
from surveyapp.tui.widgets.field import TextField, typed
from surveyapp.tui.widgets.problems import problems_text
from surveyapp.tui.widgets.titlebar import TitleBar


class AddLogScreen(Screen[str | None]):
    """Returns the id of the log that was taken, or None.

    Parameters
    ----------
    folder : str
        The project.
    begin : str
        Folder whose files are listed first.
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("tab", "app.focus_next", texts.KEY_FIELD),
        Binding("f8", "take", texts.KEY_TAKE),
        Binding("escape", "leave", texts.KEY_BACK),
    ]
    DEFAULT_CSS = """
    AddLogScreen #files { width: 28; height: 1fr; }
    AddLogScreen #preview { width: 1fr; height: 1fr; padding: 0 1; }
    AddLogScreen #exchange { height: 1fr; }
    AddLogScreen #understood-log { text-wrap: nowrap; width: auto; }
    """

    def __init__(self, folder: str, begin: str = ".") -> None:
        super().__init__()
        self.folder = folder
        self.place = begin
        self.entries: list[Entry] = []
        self.chosen: Entry | None = None

    def compose(self) -> ComposeResult:
        """Title, files and preview, options, keys."""
        yield TitleBar(texts.ADD_LOG_TITLE.format(name=Path(self.folder).resolve().name))
        with Horizontal(id="exchange"):
            yield OptionList(id="files", compact=True)
            with VerticalScroll(id="preview"):
                yield Static(texts.ADD_LOG_CHOOSE, id="understood-log", markup=False)
        yield TextField(texts.LOG_OPTIONS, "options", hint=texts.ADD_LOG_HINT)
        yield Footer(show_command_palette=False)

    def on_mount(self) -> None:
        """List the files where the program was started."""
        self.show_files(self.place)

    def show_files(self, place: str) -> None:
        """List one folder."""
        try:
            found = adding.log_entries(place)
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

    def action_take(self) -> None:
        """Take the log into the project."""
        self.begin(preview=False)

    def begin(self, *, preview: bool) -> None:
        """Read the chosen file in a thread."""
        if self.chosen is not None:
            self.query_one(TitleBar).state = texts.IMPORT_READING
            self.read(self.chosen, typed(self, "options"), preview=preview)

    @work(thread=True, exclusive=True)
    def read(self, entry: Entry, options: str, *, preview: bool) -> None:
        """Preview or take; the answer comes back to the screen."""
        try:
            if preview:
                found = adding.look_at(entry, options)
            else:
                found = adding.take(self.folder, entry, options)
        except SurveyError as error:
            self.app.call_from_thread(partial(self.refused, error))
        else:
            self.app.call_from_thread(partial(self.show, found))

    def show(self, found: LogPreview) -> None:
        """Show what was understood."""
        self.query_one("#understood-log", Static).update(preview_text(found))
        bar = self.query_one(TitleBar)
        if found.written is not None:
            self.chosen = None
            bar.state = texts.ADD_LOG_TAKEN.format(path=found.written)
        else:
            bar.state = texts.ADD_LOG_BAD if found.problems else texts.ADD_LOG_GOOD

    def refused(self, error: SurveyError) -> None:
        """Say in words what is wrong."""
        self.query_one("#understood-log", Static).update(problems_text(error))
        self.query_one(TitleBar).state = texts.IMPORT_REFUSED

    def action_leave(self) -> None:
        """Back to the sensors."""
        self.dismiss(None)
