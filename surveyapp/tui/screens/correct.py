"""Correct a station, an instrument or a session: choose it, change what is wrong, F8 writes it."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Vertical, VerticalScroll
from textual.screen import ModalScreen, Screen
from textual.widgets import Footer, Input, OptionList, Select, Static
from textual.widgets.option_list import Option

from surveyapp.errors import SurveyError
from surveyapp.observation.corrections import (
    YES,
    CorrectionField,
    TableName,
    correct,
    fields_of,
    table_names,
)
from surveyapp.tui import texts
from surveyapp.tui.widgets.field import ChoiceField, TextField
from surveyapp.tui.widgets.problems import problems_text
from surveyapp.tui.widgets.titlebar import TitleBar


class ChooseTableScreen(ModalScreen[None]):
    """The list of what can be corrected."""

    BINDINGS: ClassVar[list[BindingType]] = [Binding("escape", "leave", texts.KEY_LEAVE)]

    def __init__(self, folder: str) -> None:
        super().__init__()
        self.folder = folder
        self.tables: tuple[TableName, ...] = ()

    def compose(self) -> ComposeResult:
        """A heading and the tables."""
        with Vertical(id="dialog"):
            yield Static(texts.CORRECT_TITLE, classes="heading", markup=False)
            yield OptionList(id="tables", markup=False)
            yield Static(id="trouble", markup=False)

    def on_mount(self) -> None:
        """Fill the list, or say why it stays empty."""
        try:
            self.tables = table_names(Path(self.folder))
        except SurveyError as error:
            self.query_one("#trouble", Static).update(problems_text(error))
        if not self.tables:
            self.query_one("#trouble", Static).update(texts.CORRECT_NOTHING)
        options = self.query_one(OptionList)
        options.add_options([Option(f"{texts.TABLE_KINDS[t.kind]} {t.name}") for t in self.tables])
        options.focus()
        options.action_first()

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """Open the form in place of the list."""
        self.app.switch_screen(CorrectScreen(self.folder, self.tables[event.option_index]))

    def action_leave(self) -> None:
        """Nothing is corrected."""
        self.dismiss(None)


class CorrectScreen(Screen[None]):
    """The form of one table."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("tab", "app.focus_next", texts.KEY_FIELD),
        Binding("f8", "write", texts.KEY_WRITE),
        Binding("escape", "leave", texts.KEY_LEAVE),
    ]

    def __init__(self, folder: str, table: TableName) -> None:
        super().__init__()
        self.folder = folder
        self.table = table
        self.warned = False
        self.trouble = ""
        try:
            self.fields = fields_of(Path(folder), table)
        except SurveyError as error:
            self.fields, self.trouble = {}, problems_text(error).plain

    def compose(self) -> ComposeResult:
        """All fields below each other, as they stand in project.toml."""
        kind = texts.TABLE_KINDS[self.table.kind]
        yield TitleBar(texts.CORRECT_FORM.format(kind=kind, name=self.table.name))
        with VerticalScroll(can_focus=False, classes="form"):
            for item, text in self.fields.items():
                label = texts.CORRECT_LABELS[item.id]
                if item.kind == "yes":
                    yield ChoiceField(label, item.id, texts.YES_NO)
                else:
                    yield TextField(label, item.id, value=text)
        yield Static(self.trouble, id="trouble", markup=False)
        yield Footer(show_command_palette=False)

    def on_mount(self) -> None:
        """Begin at the first field."""
        self.query_one(TitleBar).state = texts.CORRECT_STATE
        for item, text in self.fields.items():
            if item.kind == "yes":
                self.query_one(f"#{item.id}", Select).value = YES if text else ""
        for line in list(self.query(Input))[:1]:
            line.focus()

    def typed(self, item: CorrectionField) -> str:
        """What stands in a field."""
        if item.kind == "yes":
            value = self.query_one(f"#{item.id}", Select).value
            return value if isinstance(value, str) else ""
        return self.query_one(f"#{item.id}", Input).value.strip()

    def action_write(self) -> None:
        """Write what was changed, or say what is wrong."""
        try:
            changed = correct(
                Path(self.folder), self.table, {item.id: self.typed(item) for item in self.fields}
            )
        except SurveyError as error:
            self.query_one("#trouble", Static).update(problems_text(error))
            return
        names = ", ".join(texts.CORRECT_LABELS[name] for name in changed)
        told = texts.CORRECTED.format(names=names) if changed else texts.CORRECTED_NOTHING
        self.app.notify(told, markup=False)
        self.app.pop_screen()

    def action_leave(self) -> None:
        """Leave; what was changed and not written is asked about once."""
        changed = any(self.typed(item) != text for item, text in self.fields.items())
        if changed and not self.warned:
            self.warned = True
            self.query_one("#trouble", Static).update(texts.CORRECT_UNWRITTEN)
            return
        self.app.pop_screen()
