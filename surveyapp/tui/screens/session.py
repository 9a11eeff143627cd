"""The guided session: steps, readings, and what the run says so far.

The screen passes keys to the desk and results to the widgets. Each reading is on the disk before
the screen says so.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Horizontal, Vertical
from textual.screen import Screen
from textual.widgets import Input

from surveyapp.core.observing.steps import Step
from surveyapp.errors import SurveyError
from surveyapp.observation.practice import Practice
from surveyapp.observation.session import SessionDesk
from surveyapp.tui import texts
from surveyapp.tui.cable_keys import ask_instrument
from surveyapp.tui.drafts import Draft
from surveyapp.tui.entry_desk import Desk, NotWrittenError, Pending, problem_text
from surveyapp.tui.messages import ResultWanted, SessionLeft
from surveyapp.tui.screens.help import HelpScreen
from surveyapp.tui.screens.remark import RemarkScreen
from surveyapp.tui.screens.strike import StrikeScreen
from surveyapp.tui.session_keys import HIDDEN, KEYS, ORDERED
from surveyapp.tui.texts import help_texts
from surveyapp.tui.views.observation import opening_warning, session_state, session_title
from surveyapp.tui.widgets.entry import EntryLine, ReadingInput
from surveyapp.tui.widgets.instrument import InstrumentPane
from surveyapp.tui.widgets.key_bar import KeyBar
from surveyapp.tui.widgets.run import RunPane
from surveyapp.tui.widgets.steps import StepList
from surveyapp.tui.widgets.titlebar import TitleBar


class SessionScreen(Screen[None]):
    """Observes one session.

    Parameters
    ----------
    observation : SessionDesk
        Open; the screen closes it when it is left.
    draft : Pending or None
        What was half typed when the session was left.
    practice : Practice or None
        The simulated instrument that is shown, in practice.
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding(key, action, name, show=action not in HIDDEN, tooltip=long)
        for key, (action, name, long) in KEYS.items()
    ]

    def __init__(
        self,
        observation: SessionDesk,
        draft: Pending | None = None,
        practice: Practice | None = None,
    ) -> None:
        super().__init__()
        self.practice = practice
        self.observation = observation
        self.desk = Desk(observation)
        self.draft = draft
        self.reason: Draft = {}
        self.remark: Draft = {}
        self.warned = False
        self.shown = observation.book

    def compose(self) -> ComposeResult:
        """Title, steps, the run, the entry line, keys."""
        session = self.observation.session
        yield TitleBar(session_title(self.observation))
        with Horizontal(id="work"):
            with Vertical(id="side", classes="steps-only" if self.practice is None else ""):
                yield StepList(session.method)
                if self.practice is not None:
                    yield InstrumentPane(self.practice, self.desk)
            yield RunPane(self.desk)
        yield EntryLine(self.enter, ORDERED)
        yield KeyBar()

    def on_mount(self) -> None:
        """Show where the book stands."""
        self.query_one(TitleBar).state = session_state(self.observation)
        entry = self.query_one(EntryLine)
        warning = opening_warning(self.observation)
        if warning:
            entry.tell(warning, serious=True)
        if self.draft is not None:
            self.desk.take_up(self.draft)
            entry.text = self.draft.text
        self.query_one(ReadingInput).focus()
        self.show_book()
        self.set_interval(1.0, self.watch_book)

    def watch_book(self) -> None:
        """Take over what another hand has changed in the book, and say so."""
        if not self.observation.changed_outside():
            return
        try:
            self.observation.read_again()
        except SurveyError as error:
            told = texts.BOOK_BROKEN.format(what=problem_text(error))
            self.query_one(EntryLine).tell(told, serious=True)
            return
        self.query_one(EntryLine).tell(texts.BOOK_CHANGED, serious=True)
        self.show_book()

    def show_book(self) -> None:
        """Show steps, readings and prompt as the book stands."""
        self.shown = self.observation.book
        self.query_one(StepList).show(self.observation.steps(), self.desk.step)
        self.query_one(RunPane).show_book()
        self.show_prompt()
        self.refresh_bindings()

    def show_prompt(self) -> None:
        """Say what is to be read."""
        entry = self.query_one(EntryLine)
        entry.ask(self.desk.prompt(), self.desk.hint())
        entry.understood(self.desk.typing(entry.text))

    def on_run_pane_judged(self) -> None:
        """The side and the forecast of the next point are known now."""
        self.show_prompt()

    def on_input_changed(self, event: Input.Changed) -> None:
        """Say how the typed text is understood; its first character is the moment of reading."""
        self.warned = False
        self.query_one(EntryLine).understood(self.desk.typing(event.value))

    def enter(self, text: str) -> bool:
        """Write the reading; whether it is on the disk."""
        if self.desk.step is Step.RESULT:
            self.post_message(ResultWanted(self.observation.session_id))
            return False
        return bool(text.strip()) and self.attempt(lambda: self.desk.enter(text))

    def attempt(self, act: Callable[[], str]) -> bool:
        """Do something that writes, and tell what became of it."""
        entry = self.query_one(EntryLine)
        try:
            told = act()
        except NotWrittenError as refusal:
            entry.tell(str(refusal), serious=True)
            if self.observation.book is not self.shown:
                self.show_book()
            return False
        entry.tell(told + self.desk.clock_note())
        self.show_book()
        return True

    def action_passage(self) -> None:
        """Space in the empty line: a timed passage."""
        self.attempt(self.desk.passage)

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Show the keys that mean something in this step."""
        if action == "other":
            return self.desk.has_other(str(parameters[0]))
        if action == "passage":
            return self.desk.times()
        return action != "missed" or self.desk.swings()

    def refused(self, key: str) -> bool:
        """Whether a text in the line keeps a key from its work, which is told in words."""
        entry = self.query_one(EntryLine)
        self.desk.typing(entry.text)
        obstacle = self.desk.obstacle(key)
        if obstacle:
            entry.tell(obstacle, serious=True)
        return bool(obstacle)

    def action_other(self, which: str) -> None:
        """The other kind of reading, face or target; a text in the line keeps its kind."""
        if which == "kind" and self.refused("F2"):
            return
        self.desk.take_other(which)
        self.show_prompt()

    def action_missed(self) -> None:
        """A turning point was not read."""
        if self.refused("F5"):
            return
        self.attempt(self.desk.missed)

    def action_instrument(self, *, follow: bool = False) -> None:
        """Read the total station on the cable into the line."""
        work = ask_instrument(self.app, self.query_one(EntryLine), self.desk, follow=follow)
        if work is not None:
            self.run_worker(work, thread=True, exclusive=True, group="cable")

    def action_follow(self) -> None:
        """Follow a turning point by the total station on the cable."""
        self.action_instrument(follow=True)

    def action_undo(self) -> None:
        """Clear the line; an empty one: strike the latest reading."""
        entry = self.query_one(EntryLine)
        if entry.text:
            entry.text = ""
            self.desk.typing("")
            entry.understood("")
            entry.tell(texts.CLEARED)
            return
        self.attempt(self.desk.undo)

    def action_strike(self) -> None:
        """Choose a reading to strike."""
        rows, struck_rows = self.desk.strikable(), self.desk.struck()
        if not rows and not struck_rows:
            self.query_one(EntryLine).tell(texts.NOTHING_TO_STRIKE)
            return
        back = {row.seq for row in struck_rows}

        def struck(choice: tuple[int, str] | None) -> None:
            if choice is not None:
                act = self.desk.unstrike if choice[0] in back else self.desk.strike
                self.attempt(lambda: act(*choice))

        self.app.push_screen(StrikeScreen(rows, struck_rows, self.reason), struck)

    def action_remark(self) -> None:
        """Note a remark; what stands in the line stays there."""

        def noted(text: str | None) -> None:
            if text is not None:
                self.attempt(lambda: self.desk.remark(text))

        self.app.push_screen(RemarkScreen(self.remark), noted)

    def action_typing_up(self) -> None:
        """Type up a book afterwards: readings without moments; and back."""
        self.desk.timed = not self.desk.timed
        told = texts.TYPING_UP_OFF if self.desk.timed else texts.TYPING_UP_ON
        self.query_one(EntryLine).tell(told)
        self.show_prompt()

    def action_step(self, places: int) -> None:
        """Go on, or back, by one step."""
        if self.refused("F8" if places > 0 else "F7"):
            return
        if places > 0 and self.desk.step is Step.RESULT:
            self.post_message(ResultWanted(self.observation.session_id))
        else:
            self.attempt(lambda: self.desk.go(places))

    def action_help(self) -> None:
        """Explain this step."""
        words = help_texts.help_of(self.desk.step, self.observation.session.method)
        self.app.push_screen(HelpScreen(self.desk.step_name(), words))

    def action_leave(self) -> None:
        """Leave; what is half typed is kept."""
        text = self.query_one(EntryLine).text
        if text and not self.warned:
            self.warned = True
            self.query_one(EntryLine).tell(texts.DRAFT_KEPT)
            return
        self.observation.close()
        self.post_message(SessionLeft(self.observation.session_id, self.desk.pending))
