"""A surveyor who hits any key: random keystrokes on the session screen, and what must hold."""

from __future__ import annotations

import random
import re
from datetime import timedelta
from pathlib import Path

from textual.events import Paste
from textual.pilot import Pilot
from textual.widgets import Input, Static

from surveyapp import api
from surveyapp.errors import SurveyError
from surveyapp.io.fieldbook.problems import moment_problems
from surveyapp.tui.app import SurveyApp
from surveyapp.tui.screens.remark import RemarkScreen
from surveyapp.tui.screens.session import SessionScreen
from surveyapp.tui.screens.strike import StrikeScreen
from surveyapp.tui.widgets.entry import EntryLine, ReadingInput
from tests.tui.helpers_tui import SMALL, Clock, make_project, rows_on_disk

METHODS = ("tracking", "amplitude", "transit", "automatic")
TEXTS = (
    "102-00-14", "98-01-04", "59 08", "12", "-6.5", "7.25", "163.7", "12,4", "400 Hz", "179-01-56",
    "359-02-12", "361-00-00", "0", "18", "98-02-30@-20", "98-02-30@08:00:00", "x", "6.1@07:00:00",
    "88-10-00", "1e5", ".5", "@", "102-00-14@09:30", " ", "5@-9999",
    "\uff11\uff17\uff19-\uff10\uff11-\uff15\uff16", "7\uff0c25", "24,1 \u0412", "400 \u0413\u0446",
    "\u0662\u0664", "\u5ea6 12", "12,5@-0,5", "-0", "\u00b2", "\u221e", "nan", "9" * 400, "0@",
    "101-59-07@-212", "6.1\u3002", "\u200b12", "98-02-30@@", "\t7",
)  # fmt: skip
KEYS = ("f2", "f3", "f4", "f5", "f7", "f8", "f8", "ctrl+z", "space", "enter", "enter", "backspace")
PASTES = ("102-00-14\n98-01-04\r\n101-59-07\n", "\n\n 7.25 \n", "\x1b[31m12\x07", "", "a\tb\n")
WORDS = (
    "observer M. Weber", 'booker "A. Li", 14 C', "step result", "=1+1", "\u5929\u6c14 \u6674",
    "\u041d\u0430\u0431\u043b. \u0418\u0432\u0430\u043d\u043e\u0432", "a\u202eb", "x" * 3000,
    ",;\t'", "", "\U0001f9ed", "\u0627\u0644\u0637\u0642\u0633",
)  # fmt: skip
FEW = re.compile(
    r"too few|Observe more|not finished|no reading|nothing to|needs|no clamp|two target"
    r"|only a reversal run"
)
_ON_DISK = re.compile(r"on disk: row (\d+), (.*?) (\S+?)(;|$)")


class Hand:
    """One session and the hand that works it.

    Parameters
    ----------
    pilot : Pilot
    folder : Path
    rng : Random
    clock : Clock
    """

    def __init__(self, pilot: Pilot[int], folder: Path, rng: random.Random, clock: Clock) -> None:
        self.pilot, self.folder, self.rng, self.clock = pilot, folder, rng, clock
        self.confirmed: dict[str, str] = {}

    @property
    def screen(self) -> SessionScreen:
        """The session screen, which is open."""
        screen = self.pilot.app.screen
        assert isinstance(screen, SessionScreen)
        return screen

    @property
    def line(self) -> str:
        """What stands in the line."""
        return self.screen.query_one(EntryLine).text

    async def open(self) -> None:
        """Go to the session."""
        for _ in range(2):
            await self.pilot.app.workers.wait_for_complete()
            await self.pilot.pause()
        if not isinstance(self.pilot.app.screen, SessionScreen):
            await self.pilot.press("enter")
            await self.pilot.pause()

    async def act(self) -> None:
        """Do anything, and see that at most one row was added and none altered."""
        self.clock.pass_by(self.rng.choice((0.3, 4.0, 60.0, 212.0, 213.0)))
        acts = (self.type_text, self.press, self.paste, self.remark, self.strike, self.leave)
        (act,) = self.rng.choices(acts, (55, 33, 3, 3, 4, 2))
        before = rows_on_disk(self.folder)
        await act()
        after = rows_on_disk(self.folder)
        assert after[: len(before)] == before, "a row was altered"
        assert len(after) <= len(before) + 1, "a row was doubled"

    async def type_text(self) -> None:
        """Type a text and enter it."""
        self.screen.query_one(EntryLine).text = self.rng.choice(TEXTS)
        await self.pilot.pause()
        await self.enter("enter")

    async def press(self) -> None:
        """Press a key on whatever stands in the line."""
        await self.enter(self.rng.choice((*KEYS, "ctrl+o") if self.rng.random() < 0.1 else KEYS))

    async def enter(self, key: str) -> None:
        """Press a key; a row is of the kind that was asked for, and is told with its value."""
        screen, pending = self.screen, self.line
        step, kind = screen.desk.step, screen.desk.what().kind
        before = len(rows_on_disk(self.folder))
        await self.pilot.press(key)
        await self.pilot.pause()
        if not isinstance(self.pilot.app.screen, SessionScreen):
            return
        after = rows_on_disk(self.folder)
        if key == "enter" and len(after) > before:
            new = after[-1]
            assert new["kind"] == str(kind), (pending, step, kind, new)
            assert new["value"].isascii(), new
            said = str(screen.query_one("#message", Static).content)
            assert _ON_DISK.match(said), said
            self.confirmed[new["seq"]] = new["value"]
        if pending and key in ("f2", "f5", "f7", "f8"):
            assert (screen.desk.step, len(after)) == (step, before), key

    async def paste(self) -> None:
        """Paste some lines: they are typed, none is entered."""
        before, strange = len(rows_on_disk(self.folder)), not self.line.isprintable()
        self.screen.query_one(ReadingInput).post_message(Paste(self.rng.choice(PASTES)))
        await self.pilot.pause()
        assert len(rows_on_disk(self.folder)) == before
        assert strange or self.line.isprintable()

    async def remark(self) -> None:
        """A remark: it is a note and nothing else, and the line keeps its text."""
        pending, before = self.line, len(rows_on_disk(self.folder))
        step = self.screen.desk.step
        await self.answer("ctrl+n", RemarkScreen)
        assert (self.line, self.screen.desk.step) == (pending, step)
        new = rows_on_disk(self.folder)[before:]
        assert [row["kind"] for row in new] in ([], ["note"])
        assert not any(row["note"].startswith("step") for row in new)

    async def strike(self) -> None:
        """Strike a row, or take a strike back."""
        before = len(rows_on_disk(self.folder))
        await self.answer("f6", StrikeScreen, downs=self.rng.randrange(6))
        new = rows_on_disk(self.folder)[before:]
        assert [row["kind"] for row in new] in ([], ["strike"], ["unstrike"])

    async def answer(self, key: str, screen: type, downs: int = 0) -> None:
        """Open a window, type words and enter them, or leave it."""
        await self.pilot.press(key)
        await self.pilot.pause()
        if not isinstance(self.pilot.app.screen, screen):
            return  # there is no row to strike
        await self.pilot.press(*["down"] * downs)
        self.pilot.app.screen.query(Input).first().value = self.rng.choice(WORDS)
        await self.pilot.press(self.rng.choice(("enter", "enter", "escape")))
        await self.pilot.pause()
        if isinstance(self.pilot.app.screen, screen):
            await self.pilot.press("escape")
            await self.pilot.pause()

    async def leave(self) -> None:
        """Leave the session and come again, the wall clock set meanwhile; the text comes back."""
        pending = self.line
        await self.pilot.press("escape", "escape")
        await self.pilot.pause()
        self.clock.wall += timedelta(seconds=self.rng.choice((0, 30, -30, 3600, -3600)))
        await self.open()
        if isinstance(self.pilot.app.screen, SessionScreen):  # a finished one shows its result
            assert self.line == pending


async def random_session(folder: Path, seed: int, keys: int) -> None:
    """Work a session at random; assert that what was confirmed stands in the book, and no more."""
    rng = random.Random(seed)
    make_project(folder, METHODS[seed % len(METHODS)])
    clock = Clock()
    app = SurveyApp(str(folder), now=clock.now, steady=clock.steady)
    async with app.run_test(size=SMALL) as pilot:
        hand = Hand(pilot, folder, rng, clock)
        await hand.open()
        for _ in range(keys):
            if not isinstance(app.screen, SessionScreen):
                break  # the result is shown
            await hand.act()
    rows = {row["seq"]: row["value"] for row in rows_on_disk(folder)}
    assert all(rows[seq] == value for seq, value in hand.confirmed.items())
    read_by_every_reader(folder)


def read_by_every_reader(folder: Path) -> None:
    """No command refuses the book for what the screen wrote; too few readings are no refusal."""
    project = api.open_project(folder)
    book = project.session("r1").book
    assert moment_problems(book, "r1") == []
    for act in (
        lambda: api.orient(folder),
        lambda: api.check(folder),
        lambda: api.report(folder, folder.parent / f"{folder.name}.pdf"),
        lambda: api.diagnose(folder, session="r1", log=False),
    ):
        try:
            act()
        except SurveyError as error:
            for problem in error.problems:
                assert FEW.search(str(problem)), str(problem)
