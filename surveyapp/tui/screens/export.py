"""A project for other programs: a format, a file, one key; what was left out is told.

Writing runs in a thread.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import ClassVar

from textual import work
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Vertical
from textual.screen import Screen
from textual.widgets import Input, OptionList, Static
from textual.widgets.option_list import Option

from surveyapp.domain.filing import ExportResult
from surveyapp.errors import SurveyError
from surveyapp.languages import shown, translated
from surveyapp.observation import exchange
from surveyapp.tui import texts
from surveyapp.tui.cells import padded
from surveyapp.tui.widgets.field import TextField, typed
from surveyapp.tui.widgets.key_bar import KeyBar
from surveyapp.tui.widgets.problems import problems_text
from surveyapp.tui.widgets.titlebar import TitleBar


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
        yield KeyBar()

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
