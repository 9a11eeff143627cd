"""The form for a new project: grid, stations, instrument, rule book, and how angles are typed."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import ClassVar

from textual import work
from textual.binding import Binding, BindingType
from textual.events import Key
from textual.message import Message
from textual.widget import Widget
from textual.widgets import Input, OptionList, Select, Static, TextArea
from textual.widgets.option_list import Option

from surveyapp import api
from surveyapp.core.observing.owner_values import OwnerValue, missing_values
from surveyapp.errors import Problem, SurveyError
from surveyapp.observation import home as api_home
from surveyapp.observation.home import GridChoice, NewProject
from surveyapp.observation.owner_entries import OwnerEntries
from surveyapp.observation.station_lines import NewStation, read_stations
from surveyapp.tui import texts
from surveyapp.tui.drafts import Draft
from surveyapp.tui.screens.form import FormScreen
from surveyapp.tui.views.card import card_known, owner_values
from surveyapp.tui.widgets.field import AreaField, ChoiceField, TextField, chosen, typed

OWNER_FIELDS = {
    "scale": OwnerValue.SCALE,
    "periods": OwnerValue.PERIOD,
    "torsion": OwnerValue.TORSION,
}
"""Fields in the order of ``OwnerEntries``, and the value that the card may lack."""


class NewProjectScreen(FormScreen[str]):
    """Returns the new folder, or None; ``importing`` says that one goes on with a field file."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("f9", "make_import", texts.KEY_MAKE_IMPORT),
    ]
    FIRST = "name"

    class GridsFound(Message):
        """The search for a grid has ended."""

        def __init__(self, grids: tuple[GridChoice, ...] | None, *, here: bool) -> None:
            super().__init__()
            self.grids = grids
            self.here = here

    def __init__(self, draft: Draft) -> None:
        super().__init__(texts.NEW_TITLE, draft)
        self.importing = False

    def fields(self) -> Iterable[Widget]:
        """What a project is made of."""
        yield TextField(texts.F_NAME, "name")
        yield TextField(texts.F_FOLDER, "folder", hint=texts.F_FOLDER_HINT)
        yield Static(id="folder-told", classes="told", markup=False)
        yield ChoiceField(texts.F_UNIT, "unit", texts.UNITS)
        yield ChoiceField(texts.F_TYPING, "typing", texts.TYPINGS)
        yield AreaField(texts.F_STATIONS, "stations", hint=texts.F_STATIONS_HINT)
        yield TextField(texts.F_GRID, "grid", hint=texts.F_GRID_HINT)
        yield Static(id="grids-told", classes="told", markup=False)
        yield OptionList(id="grids", compact=True)
        yield TextField(texts.F_MINE_GRID, "mine-grid", hint=texts.F_MINE_GRID_HINT)
        cards = {"": texts.NOT_DETERMINED, **{c.id: c.title for c in api.models()}}
        yield ChoiceField(texts.F_INSTRUMENT, "card", cards)
        yield Static(id="card-told", classes="told", markup=False)
        yield TextField(texts.F_INSTRUMENT_ID, "instrument", value="G1")
        yield TextField(texts.F_SERIAL, "serial")
        yield TextField(texts.F_SCALE, "scale", hint=texts.F_SCALE_HINT)
        yield TextField(texts.F_PERIODS, "periods", hint=texts.F_PERIODS_HINT)
        yield TextField(texts.F_TORSION, "torsion", hint=texts.F_TORSION_HINT)
        yield TextField(texts.F_CONSTANT, "constant", hint=texts.F_CONSTANT_HINT)
        books = {"": texts.NOT_DETERMINED, **{name: name for name in api_home.rule_books()}}
        yield ChoiceField(texts.F_RULES, "rules", books)

    def on_mount(self) -> None:
        """Hidden is what is asked for only where it is needed."""
        self.query_one("#grids").display = False
        self.ask_owner(())

    def on_input_changed(self, event: Input.Changed) -> None:
        """Search the grid while it is typed, and say where the folder will be."""
        if event.input.id == "grid":
            self.search_grids()
        elif event.input.id in ("name", "folder"):
            folder = typed(self, "folder") or typed(self, "name")
            path = texts.F_FOLDER_MADE.format(path=Path(folder).expanduser().absolute())
            self.query_one("#folder-told", Static).update(path if folder else "")

    def on_text_area_changed(self) -> None:
        """Where the stations lie tells which grids are meant."""
        self.search_grids()

    def search_grids(self) -> None:
        """Search for what is typed, or without it for all grids where the stations lie."""
        self.search(typed(self, "grid"), self.query_one("#stations", TextArea).text)

    def stations(self) -> tuple[NewStation, ...]:
        """Stations typed, pasted, or in the file that is named."""
        return read_stations(self.query_one("#stations", TextArea).text)

    @work(thread=True, exclusive=True)
    def search(self, text: str, stations: str) -> None:
        """Look for grids in a thread; the stations may be a long file."""
        try:
            placed = read_stations(stations)
        except SurveyError:
            placed = ()  # not typed to their end yet
        local = any(s.lat is not None for s in placed)
        found = None
        if len(text) >= 3 or (not text and local):
            found = api_home.find_grids(text, placed)
        here = local or any(s.e is not None for s in placed)
        self.post_message(self.GridsFound(found, here=here))

    def on_new_project_screen_grids_found(self, message: GridsFound) -> None:
        """Show the grids, if any were asked for."""
        options = self.query_one("#grids", OptionList)
        if message.grids is None:
            options.display = False
            self.query_one("#grids-told", Static).update("")
            return
        options.clear_options()
        options.add_options([Option(f"{g.code}  {g.name}", id=g.code) for g in message.grids])
        exact = any(g.code == typed(self, "grid") for g in message.grids)
        options.display = bool(message.grids) and not exact
        told = message.grids[0].name if exact else grids_told(message.grids, here=message.here)
        self.query_one("#grids-told", Static).update(told)

    def on_key(self, event: Key) -> None:
        """Down and Up go through the grids while the field keeps the cursor."""
        options = self.query_one("#grids", OptionList)
        at_grid = self.focused is not None and self.focused.id == "grid"
        if at_grid and options.display and event.key in ("down", "up"):
            event.stop()
            event.prevent_default()
            if event.key == "down":
                options.action_cursor_down()
            else:
                options.action_cursor_up()

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Enter takes the grid that was gone to, or the only one."""
        options = self.query_one("#grids", OptionList)
        if event.input.id != "grid" or not options.display:
            return
        if options.highlighted is None and options.option_count == 1:
            options.action_first()
        if options.highlighted is not None:
            options.action_select()

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """Take a grid."""
        self.query_one("#grid", Input).value = event.option_id or ""
        self.query_one("#grid").focus()

    def on_select_changed(self, event: Select.Changed) -> None:
        """Show what is known of the instrument."""
        if event.select.id == "card":
            identity = event.value if isinstance(event.value, str) else ""
            card = api.model(identity) if identity else None
            known = "" if card is None else f"{card_known(card)}\n{owner_values(card)}".rstrip()
            self.query_one("#card-told", Static).update(known)
            self.ask_owner(() if card is None else missing_values(card))

    def ask_owner(self, absent: tuple[OwnerValue, ...]) -> None:
        """Show the fields of what a card leaves to the owner."""
        for name, value in OWNER_FIELDS.items():
            field = self.query_one(f"#{name}").parent
            if field is not None:
                field.display = value in absent

    def form(self) -> NewProject:
        """What stands in the fields."""
        card = chosen(self, "card")
        instrument = (typed(self, "instrument"), card, typed(self, "serial"))
        return NewProject(
            folder=typed(self, "folder") or typed(self, "name"),
            name=typed(self, "name") or Path(typed(self, "folder")).name,
            crs=typed(self, "grid"),
            mine_grid=typed(self, "mine-grid"),
            angle_unit=chosen(self, "unit"),
            angle_typing=chosen(self, "typing"),
            rule_book=chosen(self, "rules"),
            stations=self.stations(),
            instruments=(instrument,) if card and instrument[0] else (),
            constant=typed(self, "constant"),
            owner=OwnerEntries(*(self.owner_text(name) for name in OWNER_FIELDS)),
        )

    def owner_text(self, name: str) -> str:
        """What stands in a field that the chosen card leaves to the owner."""
        field = self.query_one(f"#{name}").parent
        return typed(self, name) if field is not None and field.display else ""

    def action_make_import(self) -> None:
        """Make the folder and begin with a field file."""
        self.importing = True
        super().action_make()

    def action_make(self) -> None:
        """Make the folder."""
        self.importing = False
        super().action_make()

    def make(self) -> str:
        """Make the folder."""
        if not typed(self, "name") and not typed(self, "folder"):
            self.query_one("#name").focus()
            raise SurveyError(Problem(texts.MISSING_FIELD.format(field=texts.F_NAME)))
        return api_home.create_project(self.form())


def grids_told(grids: tuple[GridChoice, ...], *, here: bool) -> str:
    """How many grids were found."""
    if not grids:
        return texts.F_GRIDS_NONE_HERE if here else texts.F_GRIDS_NONE
    if len(grids) == api_home.MOST_GRIDS:
        return texts.F_GRIDS_MANY.format(count=len(grids))
    return (texts.F_GRIDS_HERE if here else texts.F_GRIDS).format(count=len(grids))
