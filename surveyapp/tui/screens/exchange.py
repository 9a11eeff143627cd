"""Files of other programs: a list, a preview of what was understood, one key to take it; and out.

Reading and writing run in a thread; nothing is written before the key.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import ClassVar

from textual import work
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Horizontal, Vertical, VerticalScroll
from textual.screen import Screen
from textual.widgets import Footer, Input, OptionList, Static
from textual.widgets.option_list import Option

from surveyapp.domain.fieldfile import ImportResult
from surveyapp.domain.filing import ExportResult
from surveyapp.errors import SurveyError
from surveyapp.languages import shown, translated
from surveyapp.observation import exchange
from surveyapp.tui import texts
from surveyapp.tui.cells import padded
from surveyapp.tui.views.exchange import entry_text, import_text
from surveyapp.tui.widgets.field import TextField, typed
from surveyapp.tui.widgets.problems import problems_text
from surveyapp.tui.widgets.titlebar import TitleBar


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
            with VerticalScroll(id="preview"):
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
        try:
            result = exchange.bring(entry, self.folder, options, preview=preview)
        except SurveyError as error:
            self.app.call_from_thread(partial(self.refused, error))
        else:
            self.app.call_from_thread(partial(self.show, result))

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


class ExportScreen(Screen[None]):
    """A project for other programs."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("tab", "app.focus_next", texts.KEY_FIELD),
        Binding("f8", "write", texts.KEY_WRITE),
        Binding("escape", "leave", texts.KEY_BACK),
    ]
    DEFAULT_CSS = "ExportScreen #formats { height: 1fr; } ExportScreen #told { height: auto; }"

    def __init__(self, folder: str) -> None:
        super().__init__()
        self.folder = folder
        self.formats = exchange.export_formats()

    def compose(self) -> ComposeResult:
        """Formats, the file, what became of it."""
        name = Path(self.folder).resolve().name
        yield TitleBar(texts.EXPORT_TITLE.format(name=name))
        with Vertical():
            lines = [
                Option(f"{padded(form, 8)} {translated(title)}")
                for form, title in self.formats.items()
            ]
            yield OptionList(*lines, id="formats", compact=True)
            yield TextField(texts.EXPORT_FILE, "file")
            yield Static(id="told", markup=False)
        yield Footer(show_command_palette=False)

    def on_mount(self) -> None:
        """Begin at the first format."""
        self.query_one(TitleBar).state = texts.EXPORT_STATE
        self.query_one("#formats").focus()

    def form(self) -> str:
        """The format under the cursor."""
        return list(self.formats)[self.query_one("#formats", OptionList).highlighted or 0]

    def on_option_list_option_highlighted(self) -> None:
        """Each format has its usual file."""
        path = exchange.export_path(self.folder, self.form())
        self.query_one("#file", Input).value = path

    def action_write(self) -> None:
        """Write the file in a thread."""
        self.write(self.form(), typed(self, "file"))

    @work(thread=True, exclusive=True)
    def write(self, form: str, path: str) -> None:
        """Write; the answer comes back to the screen."""
        try:
            result = exchange.hand_over(form, self.folder, path)
        except SurveyError as error:
            answer = self.query_one("#told", Static).update
            self.app.call_from_thread(partial(answer, problems_text(error)))
        else:
            self.app.call_from_thread(partial(self.show, result))

    def show(self, result: ExportResult) -> None:
        """Say what was written and what was left out."""
        lines = [texts.EXPORT_DONE.format(path=result.path, items=result.items)]
        lines += [f"{item.code}: {shown(item.text)}" for item in result.warnings]
        self.query_one("#told", Static).update("\n".join(lines))

    def action_leave(self) -> None:
        """Back to the project."""
        self.dismiss(None)
