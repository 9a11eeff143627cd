"""A surveyor who hits any key: random keystrokes on the session screen, and what must hold."""

from __future__ import annotations

import random
import re
from pathlib import Path

from textual.widgets import Static

from surveyapp import api
from surveyapp.errors import SurveyError
from surveyapp.io.fieldbook.problems import moment_problems
from surveyapp.tui.app import SurveyApp
from surveyapp.tui.screens.session import SessionScreen
from surveyapp.tui.widgets.entry import EntryLine
from tests.tui.helpers_tui import SMALL, Clock, make_project, rows_on_disk

METHODS = ("tracking", "amplitude", "transit", "automatic")
TEXTS = (
    "102-00-14", "98-01-04", "59 08", "12", "-6.5", "7.25", "163.7", "12,4", "400 Hz", "179-01-56",
    "359-02-12", "361-00-00", "0", "18", "98-02-30@-20", "98-02-30@08:00:00", "x", "6.1@07:00:00",
    "88-10-00", "1e5", ".5", "@", "102-00-14@09:30", " ", "5@-9999",
)  # fmt: skip
KEYS = ("f2", "f3", "f4", "f5", "f7", "f8", "f8", "ctrl+z", "space", "enter", "enter", "backspace")
FEW = re.compile(
    r"too few|Observe more|not finished|no reading|nothing to|needs|no clamp|two target"
    r"|only a reversal run"
)
_ON_DISK = re.compile(r"on disk: row (\d+), (.*?) (\S+?)(;|$)")


async def random_session(folder: Path, seed: int, keys: int) -> None:
    """Work a session at random; assert that what was confirmed stands in the book, and no more."""
    rng = random.Random(seed)
    method = METHODS[seed % len(METHODS)]
    make_project(folder, method)
    clock = Clock()
    app = SurveyApp(str(folder), now=clock.now, steady=clock.steady)
    confirmed: dict[str, str] = {}
    async with app.run_test(size=SMALL) as pilot:
        for _ in range(2):
            await app.workers.wait_for_complete()
            await pilot.pause()
        if not isinstance(app.screen, SessionScreen):
            await pilot.press("enter")
            await pilot.pause()
        for _ in range(keys):
            screen = app.screen
            if not isinstance(screen, SessionScreen):
                break
            clock.pass_by(rng.choice((0.3, 4.0, 60.0, 212.0, 213.0)))
            step, kind = screen.desk.step, screen.desk.what().kind
            pending = screen.query_one(EntryLine).text
            if rng.random() < 0.55:
                typed = rng.choice(TEXTS)
                screen.query_one(EntryLine).text = typed
                await pilot.pause()
                key = "enter"
            else:
                typed, key = pending, rng.choice(KEYS)
            before = rows_on_disk(folder)
            await pilot.press(key)
            await pilot.pause()
            after = rows_on_disk(folder)
            assert after[: len(before)] == before, "a row was altered"
            assert len(after) <= len(before) + 1, "a row was doubled"
            if key == "enter" and len(after) > len(before):
                new = after[-1]
                assert new["kind"] == str(kind), (typed, step, kind, new)
                said = str(screen.query_one("#message", Static).content)
                assert _ON_DISK.match(said), said
                confirmed[new["seq"]] = new["value"]
            if pending and key in ("f2", "f5", "f7", "f8"):
                assert (screen.desk.step, len(after)) == (step, len(before)), key
    rows = {row["seq"]: row["value"] for row in rows_on_disk(folder)}
    assert all(rows[seq] == value for seq, value in confirmed.items())
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
