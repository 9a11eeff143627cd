"""The keys of the session screen that ask the instrument on the cable, in a thread of their own.

Nothing is written here: what was read stands in the entry line until the surveyor confirms it.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Final

from surveyapp import api
from surveyapp.errors import SurveyError
from surveyapp.io.settings import read_settings
from surveyapp.tui import texts
from surveyapp.tui.entry_desk import Desk, problem_text
from surveyapp.tui.from_instrument import Taken, taken, taken_turn
from surveyapp.tui.widgets.entry import EntryLine

if TYPE_CHECKING:
    from textual.app import App

FOLLOWED_S: Final = 30.0
"""How long a turning point is followed: some 15 s to either side."""

Answer = tuple[Taken, str]


def ask_instrument(
    app: App[object], entry: EntryLine, desk: Desk, *, follow: bool = False
) -> Callable[[], None] | None:
    """What a thread is to do for the key, or None where the key does nothing.

    Parameters
    ----------
    app : App
    entry : EntryLine
        Told what happens, and filled.
    desk : Desk
        What is asked for.
    follow : bool
        Follow a turning point instead of one reading.
    """
    where = read_settings().instrument
    if not where or entry.text:
        told = texts.INSTRUMENT_BUSY if entry.text else texts.INSTRUMENT_NONE
        entry.tell(told, serious=True)
        return None
    what, unit = desk.what(), desk.unit
    asked = texts.INSTRUMENT_FOLLOWING.format(seconds=FOLLOWED_S)
    entry.tell(asked if follow else texts.INSTRUMENT_ASKED)

    def read() -> Answer:
        if follow:
            return taken_turn(api.follow_turn(where, seconds=FOLLOWED_S), where, unit)
        return taken(api.read_instrument(where), what, unit)

    def work() -> None:
        try:
            answer = read()
        except SurveyError as error:
            app.call_from_thread(partial(entry.tell, problem_text(error), serious=True))
            return
        app.call_from_thread(partial(_fill, entry, desk, answer))

    return work


def _fill(entry: EntryLine, desk: Desk, answer: Answer) -> None:
    """Put what was read into the line, unless something was typed meanwhile."""
    source, told = answer
    if entry.text:
        entry.tell(texts.INSTRUMENT_BUSY, serious=True)
        return
    desk.taken = source
    entry.text = source.text
    entry.tell(told, serious=not source.text)
