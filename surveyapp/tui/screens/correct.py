"""Correct a station, an instrument or a session: choose it, change what is wrong, F8 writes it."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Vertical
from textual.screen import ModalScreen
from textual.widget import Widget
from textual.widgets import Input, OptionList, Static
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
from surveyapp.tui.drafts import Draft
from surveyapp.tui.screens.form import FormScreen
from surveyapp.tui.widgets.field import ChoiceField, TextField, chosen, typed
from surveyapp.tui.widgets.problems import problems_text


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


class CorrectScreen(FormScreen[None]):
    """The form of one table, as it stands in project.toml."""

    BINDINGS: ClassVar[list[BindingType]] = [Binding("f8", "make", texts.KEY_WRITE)]
    STATE = texts.CORRECT_STATE

    def __init__(self, folder: str, table: TableName) -> None:
        kind = texts.TABLE_KINDS[table.kind]
        super().__init__(texts.CORRECT_FORM.format(kind=kind, name=table.name), {})
        self.folder = folder
        self.table = table
        self.warned = False
        self.error: SurveyError | None = None
        self.known: dict[CorrectionField, str] = {}
        try:
            self.known = dict(fields_of(Path(folder), table))
        except SurveyError as error:
            self.error = error

    def fields(self) -> Iterable[Widget]:
        """Every value that may be corrected."""
        for item in self.known:
            label = texts.CORRECT_LABELS[item.id]
            if item.kind == "yes":
                yield ChoiceField(label, item.id, texts.YES_NO)
            else:
                yield TextField(label, item.id)

    def filled(self) -> Draft:
        """What stands in the file."""
        return {
            item.id: (YES if text else "") if item.kind == "yes" else text
            for item, text in self.known.items()
        }

    def on_mount(self) -> None:
        """Begin at the first field, or say why there is none."""
        if self.error is not None:
            self.query_one("#trouble", Static).update(problems_text(self.error))
        for line in list(self.query(Input))[:1]:
            line.focus()

    def typed(self, item: CorrectionField) -> str:
        """What stands in a field."""
        return chosen(self, item.id) if item.kind == "yes" else typed(self, item.id)

    def make(self) -> None:
        """Write what was changed."""
        values = {item.id: self.typed(item) for item in self.known}
        changed = correct(Path(self.folder), self.table, values)
        names = ", ".join(texts.CORRECT_LABELS[name] for name in changed)
        told = texts.CORRECTED.format(names=names) if changed else texts.CORRECTED_NOTHING
        self.app.notify(told, markup=False)

    def action_leave(self) -> None:
        """Leave; what was changed and not written is asked about once."""
        changed = any(self.typed(item) != text for item, text in self.known.items())
        if changed and not self.warned:
            self.warned = True
            self.query_one("#trouble", Static).update(texts.CORRECT_UNWRITTEN)
            return
        super().action_leave()
