"""The form for a new session of a project."""

from __future__ import annotations

from collections.abc import Iterable
from typing import cast

from textual.widget import Widget

from surveyapp.domain.project import Method, Project, Purpose
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.decimals import typed_number
from surveyapp.observation import home as api_home
from surveyapp.observation.home import NewSession
from surveyapp.observation.proposal import propose_session
from surveyapp.tui import texts
from surveyapp.tui.drafts import Draft
from surveyapp.tui.screens.form import FormScreen
from surveyapp.tui.widgets.field import ChoiceField, TextField, chosen, typed


class NewSessionScreen(FormScreen[str]):
    """Returns the id of the new session, or None."""

    def __init__(self, folder: str, project: Project, draft: Draft) -> None:
        super().__init__(texts.NEW_SESSION_TITLE, draft)
        self.folder = folder
        self.project = project

    def fields(self) -> Iterable[Widget]:
        """What a session is made of."""
        stations = {station.name: station.name for station in self.project.stations}
        instruments = {i.id: f"{i.id}  {i.card.title}" for i in self.project.instruments}
        nothing = {"": texts.NOT_DETERMINED}
        yield TextField(texts.F_ID, "id")
        yield ChoiceField(texts.F_STATION, "station", stations or nothing)
        yield ChoiceField(texts.F_TARGET, "target", {"": texts.NO_TARGET, **stations})
        yield ChoiceField(texts.F_INSTRUMENT, "instrument", instruments or nothing)
        yield ChoiceField(texts.F_METHOD, "method", texts.METHODS)
        yield ChoiceField(texts.F_PURPOSE, "purpose", texts.PURPOSES)
        yield TextField(texts.F_KNOWN, "known", hint=texts.F_KNOWN_HINT)
        yield TextField(texts.F_WANTED, "wanted", hint=texts.F_WANTED_HINT)

    def filled(self) -> Draft:
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
            interval = typed_number(wanted) if wanted else None
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

    def make(self) -> str:
        """Add the session."""
        form = self.form()
        api_home.create_session(self.folder, form)
        return form.id
