"""The project screen shows what the API computes, and says in words what it cannot use."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from rich.text import Text
from textual.widgets import DataTable, Static

from surveyapp import api
from surveyapp.tui import texts
from surveyapp.tui.app import SurveyApp
from surveyapp.tui.widgets.problems import Problems
from surveyapp.tui.widgets.titlebar import TitleBar
from surveyapp_models.angles import AngleUnit, format_angle

PROJECTS = Path(__file__).resolve().parents[2] / "projects"
SMALL, LARGE = (80, 24), (120, 40)


def sample(tmp_path: Path, name: str) -> Path:
    copy = tmp_path / name
    shutil.copytree(PROJECTS / name, copy)
    return copy


def table_of(app: SurveyApp, page: str) -> list[list[str]]:
    table: DataTable[Text] = app.screen.query_one(f"#{page} DataTable", DataTable)
    return [[cell.plain for cell in table.get_row_at(i)] for i in range(table.row_count)]


@pytest.mark.parametrize("size", [SMALL, LARGE])
async def test_shows_the_grid_azimuths_that_the_api_computes(
    tmp_path: Path, size: tuple[int, int]
) -> None:
    folder = sample(tmp_path, "tongjin-2015")
    expected = api.orient(folder)
    app = SurveyApp(str(folder))
    async with app.run_test(size=size) as pilot:
        await app.workers.wait_for_complete()
        await pilot.pause()
        await pilot.press("2")
        shown = {row[0]: row[4] for row in table_of(app, "lines")}
    assert shown == {
        f"{line.station}-{line.target}": format_angle(line.grid_azimuth.value, AngleUnit.DMS)
        for line in expected.lines
        if line.grid_azimuth is not None
    }
    assert len(shown) == 3


async def test_the_title_counts_the_checks_that_are_not_met(tmp_path: Path) -> None:
    folder = sample(tmp_path, "johannesburg-1966")
    failed = [c for c in api.check(folder) if c.confirmed and c.passed is False]
    app = SurveyApp(str(folder))
    async with app.run_test(size=SMALL) as pilot:
        await app.workers.wait_for_complete()
        await pilot.pause()
        state = app.screen.query_one(TitleBar).state
        await pilot.press("4")
        verdicts = [row[0] for row in table_of(app, "checks")]
    assert state.startswith(f"{len(failed)} of ")
    assert verdicts.count(texts.NOT_MET) == len(failed) > 0


async def test_a_broken_project_is_told_in_words_and_can_be_read_again(tmp_path: Path) -> None:
    folder = sample(tmp_path, "gi-b1-1966")
    book = folder / "observations" / "round-3.csv"
    good = book.read_text(encoding="utf-8")
    book.write_text(good.replace("107-57-34", "365-57-34"), encoding="utf-8")
    app = SurveyApp(str(folder))
    async with app.run_test(size=SMALL) as pilot:
        await app.workers.wait_for_complete()
        await pilot.pause()
        words = str(app.screen.query_one(Problems).query_one(Static).content)
        assert "365-57-34" in words
        assert "Traceback" not in words
        book.write_text(good, encoding="utf-8")
        await pilot.press("f5")
        await app.workers.wait_for_complete()
        await pilot.pause()
        assert not app.screen.query(Problems)
        assert len(table_of(app, "sessions")) == 1
        await pilot.press("escape")
    assert app.return_value == 0
