"""One sensor log: calibrate it, look at its noise, lines and motion, diagnose it, write a card.

Each task runs in a thread with a line of progress and can be cancelled; nothing is written before a
card is asked for.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import ClassVar

from rich.text import Text
from textual import work
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import VerticalScroll
from textual.message import Message
from textual.screen import Screen
from textual.widgets import Input, Static, TabbedContent, TabPane
from textual.worker import Worker, get_current_worker

from surveyapp.domain.sensor_entry import SensorLogEntry
from surveyapp.errors import SurveyError
from surveyapp.languages import shown
from surveyapp.languages.names import named
from surveyapp.observation.sensors.desk import card_path, save_card
from surveyapp.observation.sensors.tasks import (
    CancelledError,
    Examined,
    adopt_effects,
    examine,
    first_task,
)
from surveyapp.report.text import blocks_text
from surveyapp.tui import texts
from surveyapp.tui.page_keys import page_bindings
from surveyapp.tui.screens.confirm import ConfirmScreen
from surveyapp.tui.widgets.chart import ChartPane
from surveyapp.tui.widgets.field import TextField, typed
from surveyapp.tui.widgets.key_bar import KeyBar
from surveyapp.tui.widgets.problems import problems_text
from surveyapp.tui.widgets.titlebar import TitleBar

PAGES = {"result": texts.TAB_RESULT, "pictures": texts.TAB_PICTURES}
TASK_KEYS = (
    ("c", "calibrate", texts.KEY_CALIBRATE, texts.LONG_CALIBRATE, True),
    ("d", "diagnose", texts.KEY_DIAGNOSE, texts.LONG_DIAGNOSE_LOG, True),
    ("l", "allan", texts.KEY_ALLAN, texts.LONG_ALLAN, True),
    ("f", "filter", texts.KEY_FILTER, texts.LONG_FILTER, False),
    ("s", "spectrum", texts.KEY_SPECTRUM, texts.LONG_SPECTRUM, False),
    ("m", "motion", texts.KEY_MOTION, texts.LONG_MOTION, False),
    ("n", "north", texts.KEY_NORTH, texts.LONG_NORTH, False),
    ("p", "plan", texts.KEY_STOPS, texts.LONG_STOPS, False),
)
"""Key, task, name and description of every task, and whether the footer shows it."""
NARROWEST = 40


class SensorLogScreen(Screen[None]):
    """Runs tasks on one log.

    Parameters
    ----------
    folder : str
        The project.
    entry : SensorLogEntry
    found : Examined or None
        What is shown to begin with.
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        *page_bindings(PAGES),
        *(
            Binding(key, f"run('{task}')", name, tooltip=long, show=shown)
            for key, task, name, long, shown in TASK_KEYS
        ),
        Binding("a", "adopt", texts.KEY_ADOPT, tooltip=texts.LONG_ADOPT_SENSOR, show=False),
        Binding("k", "card", texts.KEY_SAVE_CARD, tooltip=texts.LONG_SAVE_CARD),
        Binding("v", "picture", texts.KEY_PICTURE, tooltip=texts.LONG_PICTURE, show=False),
        Binding("x", "cancel", texts.KEY_CANCEL, tooltip=texts.LONG_CANCEL, show=False),
        Binding("escape", "leave", texts.KEY_BACK, tooltip=texts.LONG_BACK),
    ]
    DEFAULT_CSS = """
    SensorLogScreen #result VerticalScroll { padding: 0 1; height: 1fr; }
    SensorLogScreen ChartPane { width: 1fr; height: 1fr; padding: 0 1; text-wrap: nowrap; }
    """

    class Found(Message):
        """A task has ended."""

        def __init__(self, found: Examined) -> None:
            super().__init__()
            self.found = found

    class Refused(Message):
        """A task cannot be done."""

        def __init__(self, error: SurveyError) -> None:
            super().__init__()
            self.error = error

    def __init__(self, folder: str, entry: SensorLogEntry, found: Examined | None = None) -> None:
        super().__init__()
        self.folder = folder
        self.entry = entry
        self.chosen_task = first_task(entry)
        self.found = found
        self.place = 0
        self.job: Worker[None] | None = None

    def compose(self) -> ComposeResult:
        """Title, result and pictures, options, keys."""
        yield TitleBar(texts.LOG_TITLE.format(log=self.entry.id))
        with TabbedContent():
            with TabPane(texts.TAB_RESULT, id="result"), VerticalScroll():
                yield Static(texts.LOG_BEGIN, id="found", markup=False)
            with TabPane(texts.TAB_PICTURES, id="pictures"):
                yield ChartPane()
        yield TextField(texts.LOG_OPTIONS, "options", hint=texts.LOG_OPTIONS_HINT)
        yield KeyBar()

    def on_mount(self) -> None:
        """The keys of the tasks work at once."""
        self.query_one("#result VerticalScroll").focus()
        if self.found is not None:
            self.post_message(self.Found(self.found))

    def action_run(self, task: str) -> None:
        """Begin a task."""
        self.chosen_task = task
        self.query_one(TitleBar).state = texts.TASK_COMPUTING.format(task=texts.TASK_NAMES[task])
        self.job = self.work_on(task, typed(self, "options"))

    def on_input_submitted(self, _: Input.Submitted) -> None:
        """Other options: the task again."""
        self.query_one("#result VerticalScroll").focus()
        self.action_run(self.chosen_task)

    @work(thread=True, exclusive=True)
    def work_on(self, task: str, options: str) -> None:
        """Run a task in a thread; what was cancelled is forgotten."""
        worker = get_current_worker()

        def advance(share: float) -> None:
            if worker.is_cancelled:
                raise CancelledError
            self.app.call_from_thread(partial(self.tell, task, share))

        try:
            found = examine(self.folder, self.entry, task, options, progress=advance)
        except CancelledError:
            return
        except SurveyError as error:
            if not worker.is_cancelled:
                self.post_message(self.Refused(error))
            return
        if not worker.is_cancelled:
            self.post_message(self.Found(found))

    def tell(self, task: str, share: float) -> None:
        """How much of the log was read."""
        done = share >= 1.0
        line = texts.TASK_COMPUTING if done else texts.TASK_RUNNING
        self.query_one(TitleBar).state = line.format(task=texts.TASK_NAMES[task], share=share)

    def action_cancel(self) -> None:
        """Forget what is being computed."""
        if self.job is not None and not self.job.is_finished:
            self.job.cancel()
            self.query_one(TitleBar).state = texts.TASK_CANCELLED

    def on_sensor_log_screen_found(self, message: Found) -> None:
        """Show a result and its first picture."""
        self.found, self.place = message.found, 0
        line = texts.TASK_DONE if message.found.met else texts.TASK_NOT_MET
        line = texts.TASK_NAMED if message.found.adoptable else line
        self.query_one(TitleBar).state = line.format(task=texts.TASK_NAMES[message.found.task])
        self.show_result()
        self.show_picture()
        if not message.found.pictures:
            self.action_page("result")

    def show_result(self) -> None:
        """The blocks as text, as wide as the screen."""
        if self.found is not None:
            width = max(self.size.width - 4, NARROWEST)
            text = Text(blocks_text(self.found.blocks, width))
            self.query_one("#found", Static).update(text)
            self.query_one("#result VerticalScroll").scroll_home(animate=False)

    def on_resize(self) -> None:
        """Another width breaks the lines anew."""
        self.show_result()

    def on_sensor_log_screen_refused(self, message: Refused) -> None:
        """Say in words what is wrong."""
        self.found = None
        self.query_one(TitleBar).state = texts.TASK_REFUSED
        self.query_one("#found", Static).update(problems_text(message.error))
        self.query_one(ChartPane).show(None)
        self.action_page("result")

    def show_picture(self) -> None:
        """The picture in its turn."""
        pictures = () if self.found is None else self.found.pictures
        self.query_one(ChartPane).show(pictures[self.place] if pictures else None)

    def action_picture(self) -> None:
        """The next picture; the first one where the result was shown."""
        pictures = () if self.found is None else self.found.pictures
        if not pictures:
            self.notify(texts.PICTURE_NONE, markup=False)
            return
        if self.query_one(TabbedContent).active == "pictures":
            self.place = (self.place + 1) % len(pictures)
        self.show_picture()
        self.action_page("pictures")
        told = texts.PICTURE_OF.format(place=self.place + 1, count=len(pictures))
        self.query_one(TitleBar).state = told

    def action_page(self, name: str) -> None:
        """Show one page."""
        self.query_one(TabbedContent).active = name
        if name == "result":
            self.query_one("#result VerticalScroll").focus()

    def action_card(self) -> None:
        """Ask once, then write the card of the calibration."""
        if self.found is None or self.found.calibration is None:
            self.notify(texts.NO_CARD_YET, severity="warning", markup=False)
            return
        path = card_path(self.entry.id)
        there = (Path(self.folder) / path).exists()
        question = (texts.CARD_REPLACE if there else texts.CARD_ASK).format(path=path)
        self.app.push_screen(ConfirmScreen(question), self._save)

    def _save(self, confirmed: bool | None) -> None:
        if confirmed and self.found is not None:
            self.write_card(self.found, card_path(self.entry.id))

    @work(thread=True, exclusive=True)
    def write_card(self, found: Examined, path: str) -> None:
        """Write the card in a thread."""
        try:
            save_card(self.folder, self.entry, found, path)
        except SurveyError as error:
            self.post_message(self.Refused(error))
        else:
            told = texts.CARD_SAVED.format(path=path)
            self.app.call_from_thread(partial(self.notify, told, markup=False))

    def action_adopt(self) -> None:
        """Ask once, then write the named effects into the entry of the log."""
        names = () if self.found is None else self.found.adoptable
        if not names:
            self.notify(texts.NOTHING_TO_ADOPT, severity="warning", markup=False)
            return
        told = ", ".join(shown(named(name)) for name in names)
        self.app.push_screen(ConfirmScreen(texts.ADOPT_ASK.format(names=told)), self._adopt)

    def _adopt(self, confirmed: bool | None) -> None:
        if confirmed:
            self.query_one(TitleBar).state = texts.TASK_COMPUTING.format(
                task=texts.TASK_NAMES["diagnose"]
            )
            self.adopt()

    @work(thread=True, exclusive=True)
    def adopt(self) -> None:
        """Diagnose again and write, in a thread."""
        try:
            written, refused = adopt_effects(self.folder, self.entry)
        except SurveyError as error:
            self.post_message(self.Refused(error))
            return
        for line in (*(texts.ADOPTED.format(place=place) for place in written), *refused):
            self.app.call_from_thread(partial(self.notify, line, markup=False))
        done = texts.TASK_DONE.format(task=texts.TASK_NAMES["diagnose"])
        self.app.call_from_thread(partial(setattr, self.query_one(TitleBar), "state", done))

    def action_leave(self) -> None:
        """Back to the list; what runs is forgotten."""
        self.action_cancel()
        self.dismiss(None)
