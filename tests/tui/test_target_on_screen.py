"""The target on the screen: from the session, from the rule book with its clause, or none."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from textual.widgets import Static

from surveyapp.core.observing.progress import Progress
from surveyapp.core.simulate.session import book_text
from surveyapp.io.rulebooks import installed_rule_book_ids
from surveyapp.observation.session import SessionDesk
from surveyapp.tui.app import SurveyApp
from surveyapp.tui.views.progress import outlook_text, target_source_text
from tests.tui.helpers_tui import SMALL, Clock, make_project, simulated

ROOM = 56
"""Columns beside the list of steps in a terminal of 80."""
WANTED = "wanted_interval_arcsec = 8.0\n"


def with_rule_book(folder: Path, name: str | None, *, wanted: bool = False) -> SessionDesk:
    """A session whose project names a rule book."""
    make_project(folder)
    text = (folder / "project.toml").read_text(encoding="utf-8")
    if not wanted:
        text = text.replace(WANTED, "")
    if name is not None:
        text = text.replace("format = 1\n", f'format = 1\nrule_book = "{name}"\n')
    (folder / "project.toml").write_text(text, encoding="utf-8")
    clock = Clock()
    return SessionDesk(folder, "r1", now=clock.now, steady=clock.steady)


@pytest.mark.parametrize("name", installed_rule_book_ids())
def test_every_rule_book_sets_a_target_or_says_that_it_sets_none(tmp_path: Path, name: str) -> None:
    aim = with_rule_book(tmp_path / "p", name).aim()
    outlook, source = outlook_text(Progress(), aim), target_source_text(aim.target)
    if aim.target is None:
        assert outlook == f"no target in {name}"
        assert source == ""
        return
    assert outlook.startswith("rule book ±")
    assert f"x 1.96: {name}, {aim.target.clause}" in source
    assert source.endswith(", unconfirmed") is not aim.target.confirmed
    assert len(source) <= ROOM


def test_the_coal_regulations_are_quoted_with_their_article(tmp_path: Path) -> None:
    aim = with_rule_book(tmp_path / "p", "cn-coal-15").aim()
    assert outlook_text(Progress(), aim) == 'rule book ±27.7"'
    assert target_source_text(aim.target) == 'm 14.1" x 1.96: cn-coal-15, Art. 62'


def test_what_the_session_wants_wins_over_the_rule_book(tmp_path: Path) -> None:
    aim = with_rule_book(tmp_path / "p", "cn-coal-15", wanted=True).aim()
    assert outlook_text(Progress(), aim) == 'wanted ±8.0"'
    assert target_source_text(aim.target) == ""


def test_without_a_rule_book_there_is_no_target_and_never_enough(tmp_path: Path) -> None:
    aim = with_rule_book(tmp_path / "p", None).aim()
    assert outlook_text(Progress(interval95=1e-9), aim) == "no target set"


def test_a_rule_book_that_is_not_there_is_told_and_stops_nothing(tmp_path: Path) -> None:
    aim = with_rule_book(tmp_path / "p", "cn-coal-51").aim()
    assert aim.target is None
    assert outlook_text(Progress(), aim).startswith("no target: ")


async def test_enough_rings_at_the_rule_books_target(tmp_path: Path) -> None:
    folder = tmp_path / "p"
    with_rule_book(folder, "cn-coal-15").close()
    text = book_text(simulated(points=12).rows[:17])
    (folder / "observations" / "r1.csv").write_text(text, encoding="utf-8")
    app = SurveyApp(str(folder))
    async with app.run_test(size=SMALL) as pilot:
        await pilot.app.workers.wait_for_complete()
        await pilot.press("enter")
        for _ in range(3):
            await pilot.app.workers.wait_for_complete()
            await pilot.pause()
        shown = str(app.screen.query_one("#facts", Static).render())
    assert 'ENOUGH  ±4.8" after two more  rule book ±27.7"' in shown
    assert "Art. 62" in shown
    told = re.findall(r'(next|else): .{10,30}: ±(\d+\.\d)", cause (\d+)%', shown)
    assert [first for first, _, _ in told] == ["next", "else"]
    assert all(0.0 < float(interval) < 27.7 for _, interval, _ in told)
