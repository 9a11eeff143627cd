"""The form for a new session of a project."""

from __future__ import annotations

from typing import ClassVar, cast

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import VerticalScroll
from textual.screen import Screen
from textual.widgets import Footer, Static

from surveyapp.domain.project import Method, Project, Purpose
from surveyapp.errors import Problem, SurveyError
from surveyapp.observation import home as api_home
from surveyapp.observation.home import NewSession
from surveyapp.observation.proposal import propose_session
from surveyapp.tui import texts
from surveyapp.tui.drafts import Draft, keep, put_back
from surveyapp.tui.widgets.field import ChoiceField, TextField, chosen, typed
from surveyapp.tui.widgets.problems import problems_text
from surveyapp.tui.widgets.titlebar import TitleBar


class NewSessionScreen(Screen[str | None]):
    """Returns the id of the new session, or None."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("tab", "app.focus_next", texts.KEY_FIELD),
        Binding("f8", "make", texts.KEY_MAKE),
        Binding("escape", "leave", texts.KEY_LEAVE),
    ]

    def __init__(self, folder: str, project: Project, draft: Draft) -> None:
        super().__init__()
        self.draft = draft
        self.folder = folder
        self.project = project

    def compose(self) -> ComposeResult:
        """All fields below each other."""
        stations = {station.name: station.name for station in self.project.stations}
        instruments = {i.id: f"{i.id}  {i.card.title}" for i in self.project.instruments}
        yield TitleBar(texts.NEW_SESSION_TITLE)
        with VerticalScroll(can_focus=False, classes="form"):
            yield TextField(texts.F_ID, "id")
            yield ChoiceField(texts.F_STATION, "station", stations or {"": texts.NOT_DETERMINED})
            yield ChoiceField(texts.F_TARGET, "target", {"": texts.NO_TARGET, **stations})
            yield ChoiceField(
                texts.F_INSTRUMENT, "instrument", instruments or {"": texts.NOT_DETERMINED}
            )
            yield ChoiceField(texts.F_METHOD, "method", texts.METHODS)
            yield ChoiceField(texts.F_PURPOSE, "purpose", texts.PURPOSES)
            yield TextField(texts.F_KNOWN, "known", hint=texts.F_KNOWN_HINT)
            yield TextField(texts.F_WANTED, "wanted", hint=texts.F_WANTED_HINT)
        yield Static(id="trouble", markup=False)
        yield Footer(show_command_palette=False)

    def on_mount(self) -> None:
        """Begin at the id."""
        self.query_one(TitleBar).state = texts.NEW_STATE
        put_back(self, self.draft or self.proposed())
        self.query_one("#id").focus()

    def proposed(self) -> Draft:
        """A free id, and what the last session had."""
        proposal = propose_session(self.project)
        return {
            "id": proposal.id,
            "station": proposal.station,
            "target": proposal.target,
            "instrument": proposal.instrument,
            "method": proposal.method,
            "purpose": proposal.purpose,
        }

    def form(self) -> NewSession:
        """What stands in the fields.

        Raises
        ------
        SurveyError
            If the id is missing or the wanted interval is no number.
        """
        identity, wanted = typed(self, "id"), typed(self, "wanted")
        if not identity:
            raise SurveyError(Problem(texts.MISSING_FIELD.format(field=texts.F_ID)))
        try:
            interval = float(wanted) if wanted else None
        except ValueError:
            raise SurveyError(Problem(texts.WANTED_NOT, texts.F_WANTED, wanted)) from None
        return NewSession(
            id=identity,
            station=chosen(self, "station"),
            target=chosen(self, "target"),
            instrument=chosen(self, "instrument"),
            method=cast("Method", chosen(self, "method")),
            purpose=cast("Purpose", chosen(self, "purpose")),
            azimuth_known=typed(self, "known"),
            wanted_interval_arcsec=interval,
        )

    def action_make(self) -> None:
        """Add the session, or say what is wrong."""
        try:
            form = self.form()
            api_home.create_session(self.folder, form)
        except SurveyError as error:
            self.query_one("#trouble", Static).update(problems_text(error))
            return
        self.draft.clear()
        self.dismiss(form.id)

    def action_leave(self) -> None:
        """Make nothing; what was filled in waits for the next opening."""
        keep(self, self.draft)
        self.dismiss(None)
