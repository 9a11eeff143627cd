"""The result of one session: the chain from reading to grid azimuth, checks, budget, the record."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

from textual import work
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import VerticalScroll
from textual.message import Message
from textual.screen import Screen
from textual.widgets import Static

from surveyapp import api
from surveyapp.api.office import undrawn_text
from surveyapp.domain.project import Project
from surveyapp.domain.results import OrientationResult
from surveyapp.errors import SurveyError
from surveyapp.languages import shown
from surveyapp.observation.practice import Practice
from surveyapp.observation.record import record_outdated, record_written, write_record
from surveyapp.tui import texts
from surveyapp.tui.drafts import Draft
from surveyapp.tui.entry_desk import problem_text
from surveyapp.tui.screens.signature import SignatureScreen
from surveyapp.tui.views.checks import summary
from surveyapp.tui.views.result import result_headline, result_text, truth_text
from surveyapp.tui.widgets.key_bar import KeyBar
from surveyapp.tui.widgets.problems import problems_text
from surveyapp.tui.widgets.titlebar import TitleBar

SIDES = 6
"""Columns beside the sections: padding and scroll bar."""


class ResultScreen(Screen[None]):
    """Shows what one session says; it changes nothing."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("f4", "record", texts.KEY_PDF, tooltip=texts.LONG_PDF),
        Binding("f6", "sign", texts.KEY_SIGN),
        Binding("f5", "reload", texts.KEY_RELOAD, tooltip=texts.LONG_RELOAD),
        Binding("escape", "leave", texts.KEY_BACK),
    ]

    class Computed(Message):
        """The computation has ended."""

        def __init__(self, project: Project, result: OrientationResult) -> None:
            super().__init__()
            self.project = project
            self.result = result

    class Failed(Message):
        """There is no result, and why."""

        def __init__(self, error: SurveyError) -> None:
            super().__init__()
            self.error = error

    class Told(Message):
        """Something was done, or could not be."""

        def __init__(self, text: str) -> None:
            super().__init__()
            self.text = text

    def __init__(self, folder: str, session: str, practice: Practice | None = None) -> None:
        super().__init__()
        self.practice = practice
        self.draft: Draft = {}
        self.folder = folder
        self.session = session
        self.project: Project | None = None
        self.result: OrientationResult | None = None

    def compose(self) -> ComposeResult:
        """Title, headline, sections, keys."""
        truth, told = Static(id="truth", markup=False), Static(id="told", markup=False)
        truth.display = told.display = False
        yield TitleBar(
            texts.RESULT_TITLE.format(
                project=Path(self.folder).resolve().name, session=self.session
            )
        )
        yield Static(id="headline", markup=False)
        yield truth
        with VerticalScroll():
            yield Static(id="sections", markup=False)
        yield told
        yield KeyBar()

    def on_mount(self) -> None:
        """Begin to compute."""
        self.query_one(VerticalScroll).focus()
        self.action_reload()

    def action_reload(self) -> None:
        """Compute again from the disk."""
        self.query_one(TitleBar).state = texts.COMPUTING
        self.compute()

    @work(thread=True, exclusive=True)
    def compute(self) -> None:
        """Orient in a thread; the result comes as a message."""
        try:
            project = api.open_project(self.folder)
            result = api.orient(project, session=self.session)
            self.post_message(self.Computed(project, result))
        except SurveyError as error:
            self.post_message(self.Failed(error))

    def on_result_screen_computed(self, message: Computed) -> None:
        """Show it."""
        self.project, self.result = message.project, message.result
        unit = message.project.angle_unit
        self.query_one(TitleBar).state = summary(message.result)
        self.query_one("#headline", Static).update(
            result_headline(message.result, self.session, unit)
        )
        if self.practice is not None:
            truth = truth_text(self.practice.outcome(message.result), unit)
            self.query_one("#truth", Static).update(truth)
            self.query_one("#truth").display = bool(truth)
        self.show_sections()
        if record_outdated(message.project):
            self.post_message(self.Told(texts.RECORD_OLD))

    def on_resize(self) -> None:
        """The drawing takes the width that there is."""
        self.show_sections()

    def show_sections(self) -> None:
        """Show every section below the other."""
        if self.project is None or self.result is None:
            return
        width = max(self.size.width - SIDES, 40)
        text = result_text(self.project, self.result, self.session, width)
        self.query_one("#sections", Static).update(text)

    def on_result_screen_failed(self, message: Failed) -> None:
        """Say in words why there is none."""
        self.query_one(TitleBar).state = ""
        self.query_one("#headline", Static).update("")
        self.query_one("#sections", Static).update(problems_text(message.error))

    @work(thread=True, exclusive=True, group="record")
    def action_record(self) -> None:
        """Write the record as PDF in a thread, and show its path."""
        try:
            path = write_record(self.folder)
            self.post_message(self.Told(texts.PDF_WRITTEN.format(path=path)))
        except SurveyError as error:
            self.post_message(self.Told(problem_text(error)))

    def action_sign(self) -> None:
        """Close the session; what the record cannot print is told before."""
        told = "" if self.project is None else undrawn_text(self.project)
        self.app.push_screen(SignatureScreen(self.draft, told), self._signed)

    def _signed(self, name: str | None) -> None:
        if name is None:
            return
        try:
            closed = api.close(self.folder, session=self.session, by=name)
        except SurveyError as error:
            self.post_message(self.Told(problem_text(error)))
            return
        told = texts.SIGNED.format(name=name, files=closed.files, head=closed.head)
        self.post_message(self.Told(told))
        if record_written(self.folder):
            self.write_again(told)

    @work(thread=True, exclusive=True, group="record")
    def write_again(self, told: str) -> None:
        """Make the PDF again, so that it shows the signature; else call it out of date."""
        try:
            again = texts.PDF_AGAIN.format(path=write_record(self.folder))
        except SurveyError as error:
            again = texts.PDF_OUT_OF_DATE.format(what=shown(error.problems[0].what))
        self.post_message(self.Told(f"{told}\n{again}"))

    def on_result_screen_told(self, message: Told) -> None:
        """Say what became of it."""
        told = self.query_one("#told", Static)
        told.update(message.text)
        told.display = True

    def action_leave(self) -> None:
        """Back to the session."""
        self.app.pop_screen()
