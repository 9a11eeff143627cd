"""The result of one session: the chain from reading to grid azimuth, checks, budget, the record."""

from __future__ import annotations

from typing import ClassVar

from rich.text import Text
from textual import work
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import VerticalScroll
from textual.message import Message
from textual.screen import Screen
from textual.widgets import Footer, Static

from surveyapp import api
from surveyapp.domain.project import Project
from surveyapp.domain.results import OrientationResult
from surveyapp.errors import SurveyError
from surveyapp.tui import texts
from surveyapp.tui.views.checks import summary
from surveyapp.tui.views.result import result_headline, result_sections
from surveyapp.tui.widgets.problems import problems_text
from surveyapp.tui.widgets.records import table_text
from surveyapp.tui.widgets.titlebar import TitleBar


class ResultScreen(Screen[None]):
    """Shows what one session says; it changes nothing."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("f5", "reload", texts.KEY_RELOAD),
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

    def __init__(self, folder: str, session: str) -> None:
        super().__init__()
        self.folder = folder
        self.session = session
        self.result: OrientationResult | None = None

    def compose(self) -> ComposeResult:
        """Title, headline, sections, keys."""
        yield TitleBar(texts.RESULT_TITLE.format(project="", session=self.session).strip())
        yield Static(id="headline", markup=False)
        with VerticalScroll():
            yield Static(id="sections", markup=False)
        yield Footer(show_command_palette=False)

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
        self.result = message.result
        unit = message.project.angle_unit
        self.query_one(TitleBar).state = summary(message.result)
        self.query_one("#headline", Static).update(
            result_headline(message.result, self.session, unit)
        )
        text = Text()
        for heading, rows in result_sections(message.result, self.session, unit):
            text.append(f"{heading}\n", style="bold")
            text.append_text(table_text(rows))
            text.append("\n")
        self.query_one("#sections", Static).update(text)

    def on_result_screen_failed(self, message: Failed) -> None:
        """Say in words why there is none."""
        self.query_one(TitleBar).state = ""
        self.query_one("#headline", Static).update("")
        self.query_one("#sections", Static).update(problems_text(message.error))

    def action_leave(self) -> None:
        """Back to the session."""
        self.app.pop_screen()
