"""A guided programme: steps on the left, what to do and what is undetermined on the right.

One screen for every programme. A line typed and entered is on the disk; the log of a run is looked
at again whenever it has grown.
"""

from __future__ import annotations

from functools import partial
from typing import ClassVar

from textual import work
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Horizontal, VerticalScroll
from textual.message import Message
from textual.screen import Screen
from textual.widgets import Input, OptionList, Static
from textual.widgets.option_list import Option

from surveyapp import api
from surveyapp.domain.programme import ProgrammeState, ProgrammeStep
from surveyapp.errors import SurveyError
from surveyapp.languages import shown
from surveyapp.observation.sensors.programmes import ProgrammeDesk
from surveyapp.observation.sensors.tasks import Examined
from surveyapp.tui import texts
from surveyapp.tui.views import programmes as view
from surveyapp.tui.widgets.field import TextField
from surveyapp.tui.widgets.key_bar import KeyBar
from surveyapp.tui.widgets.titlebar import TitleBar

LOOK_EVERY_S = 5.0


class ProgrammeScreen(Screen[None]):
    """Goes through a run.

    Parameters
    ----------
    desk : ProgrammeDesk
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("up", "step(-1)", texts.LONG_STEP_UP, show=False, priority=True),
        Binding("down", "step(1)", texts.LONG_STEP_DOWN, show=False, priority=True),
        Binding("f5", "look", texts.KEY_LOOK, tooltip=texts.LONG_LOOK),
        Binding("ctrl+z", "undo", texts.KEY_UNDO_ENTRY, tooltip=texts.LONG_UNDO_ENTRY),
        Binding("f8", "finish", texts.KEY_FINISH, tooltip=texts.LONG_FINISH),
        Binding("escape", "leave", texts.KEY_BACK, tooltip=texts.LONG_BACK),
    ]
    DEFAULT_CSS = """
    ProgrammeScreen #steps { width: 45%; height: 1fr; border: none; }
    ProgrammeScreen #guide { width: 1fr; height: 1fr; padding: 0 1; border-left: solid $primary; }
    ProgrammeScreen #programme { height: 1fr; }
    ProgrammeScreen .label { width: 10; padding: 0 1; }
    ProgrammeScreen #said { height: auto; max-height: 4; padding: 0 1; }
    """

    class Ended(Message):
        """The calibration has ended."""

        def __init__(self, found: Examined) -> None:
            super().__init__()
            self.found = found

    class Refused(Message):
        """Something cannot be done."""

        def __init__(self, error: SurveyError) -> None:
            super().__init__()
            self.error = error

    class Looked(Message):
        """The run was read again."""

        def __init__(self, state: ProgrammeState) -> None:
            super().__init__()
            self.state = state

    def __init__(self, desk: ProgrammeDesk) -> None:
        super().__init__()
        self.desk = desk
        self.mark = desk.log_mark()

    def compose(self) -> ComposeResult:
        """Title, steps and guide, the line, keys."""
        yield TitleBar(self.desk.programme.title)
        with Horizontal(id="programme"):
            yield OptionList(id="steps", compact=True)
            with VerticalScroll(id="guide", can_focus=False):
                yield Static(id="guidance", markup=False)
        yield Static(id="said", markup=False)
        yield TextField(texts.PROGRAMME_LINE, "line")
        yield KeyBar()

    def on_mount(self) -> None:
        """Show where the run stands, and follow it."""
        self.query_one("#steps", OptionList).can_focus = False
        self.query_one("#line", Input).focus()
        self.show_state(self.desk.state)
        self.set_interval(LOOK_EVERY_S, self.follow)

    @property
    def chosen(self) -> ProgrammeStep:
        """The step under the cursor."""
        row = self.query_one("#steps", OptionList).highlighted or 0
        return self.desk.programme.steps[row]

    def show_state(self, state: ProgrammeState) -> None:
        """Fill the list, go to the next step."""
        steps = self.query_one("#steps", OptionList)
        steps.clear_options()
        steps.add_options([Option(view.step_line(item)) for item in state.steps])
        here = next((i for i, s in enumerate(state.steps) if s.status == "here"), None)
        steps.highlighted = len(state.steps) - 1 if here is None else here
        done = sum(item.status in ("done", "short") for item in state.steps)
        self.query_one(TitleBar).state = texts.PROGRAMME_COUNT.format(
            done=done, count=len(state.steps)
        )
        self.show_guide()

    def show_guide(self) -> None:
        """What to do in the chosen step."""
        width = self.query_one("#guide").size.width - 2
        text = view.guide_text(self.desk.state, self.chosen, width=width or 40)
        self.query_one("#guidance", Static).update(text)

    def on_resize(self) -> None:
        """Another width breaks the lines anew."""
        self.call_after_refresh(self.show_guide)

    def action_step(self, by: int) -> None:
        """Choose another step."""
        steps = self.query_one("#steps", OptionList)
        last = len(self.desk.programme.steps) - 1
        steps.highlighted = min(max((steps.highlighted or 0) + by, 0), last)
        self.show_guide()

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Write the line down."""
        step, text = self.chosen, event.value.strip()
        try:
            state = self.desk.record(step.id, text)
        except SurveyError as error:
            self.say(error)
            return
        self.query_one("#line", Input).value = ""
        told = texts.PROGRAMME_WRITTEN.format(step=step.title, value=text or step.told)
        self.query_one("#said", Static).update(told)
        self.mark = self.desk.log_mark()
        self.show_state(state)

    def say(self, error: SurveyError) -> None:
        """What is wrong, in words; what was typed stays."""
        self.query_one("#said", Static).update(shown(error.text))

    def action_undo(self) -> None:
        """Strike the latest entry."""
        try:
            state = self.desk.undo(texts.PROGRAMME_UNDO_WHY)
        except SurveyError as error:
            self.say(error)
            return
        self.query_one("#said", Static).update(texts.PROGRAMME_UNDONE)
        self.show_state(state)

    def follow(self) -> None:
        """Look again where the log has grown or a wait is open."""
        mark = self.desk.log_mark()
        if mark != self.mark or self.desk.state.waits_min:
            self.mark = mark
            self.look()

    def action_look(self) -> None:
        """Look at the log again."""
        self.look()

    @work(thread=True, exclusive=True, group="look")
    def look(self) -> None:
        """Read the run and its log in a thread."""
        try:
            self.post_message(self.Looked(self.desk.look()))
        except SurveyError as error:
            self.post_message(self.Refused(error))

    def on_programme_screen_looked(self, message: Looked) -> None:
        """Show where it stands now."""
        self.show_state(message.state)

    def on_programme_screen_refused(self, message: Refused) -> None:
        """Say why not."""
        self.query_one(TitleBar).state = texts.TASK_REFUSED
        self.say(message.error)

    def action_finish(self) -> None:
        """Calibrate with the options that stand in the line."""
        task = texts.TASK_NAMES[self.desk.programme.ends_in]
        self.query_one(TitleBar).state = texts.TASK_COMPUTING.format(task=task)
        self.finish(self.query_one("#line", Input).value.strip())

    @work(thread=True, exclusive=True, group="finish")
    def finish(self, options: str) -> None:
        """Calibrate in a thread."""
        task = texts.TASK_NAMES[self.desk.programme.ends_in]

        def advance(share: float) -> None:
            line = texts.TASK_RUNNING.format(task=task, share=share)
            self.app.call_from_thread(partial(setattr, self.query_one(TitleBar), "state", line))

        try:
            self.post_message(self.Ended(self.desk.finish(options, progress=advance)))
        except SurveyError as error:
            self.post_message(self.Refused(error))

    def on_programme_screen_ended(self, message: Ended) -> None:
        """Show the result on the screen of the log."""
        from surveyapp.tui.screens.sensor_log import SensorLogScreen

        self.show_state(self.desk.state)
        if message.found.card:
            self.notify(texts.CARD_SAVED.format(path=message.found.card), markup=False)
        logs = api.open_project(self.desk.folder).sensor_logs
        entry = next(entry for entry in logs if entry.id == self.desk.identity)
        self.app.push_screen(SensorLogScreen(self.desk.folder, entry, message.found))

    def action_leave(self) -> None:
        """Back to the list; everything is on the disk."""
        self.dismiss(None)
