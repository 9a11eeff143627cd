"""Traverses on the screen: numbers of the adjustment, a plan that is right way up."""

from __future__ import annotations

from pathlib import Path

import pytest
from textual.widgets import DataTable, TabbedContent

from surveyapp import api
from surveyapp.tui import texts
from surveyapp.tui.app import SurveyApp
from surveyapp.tui.screens.project import ProjectScreen
from surveyapp.tui.screens.traverse import PAGES, TraverseScreen
from surveyapp.tui.views import traverse as view
from surveyapp.tui.widgets.blocks_pane import BlocksPane
from surveyapp.tui.widgets.canvas import enlargement
from surveyapp.tui.widgets.plan import FIXED, FREE, PlanCanvas, draw_plan
from surveyapp.tui.widgets.problems import Problems
from tests.tui.helpers_tui import NETWORK, NETWORK_BOOK, make_network


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    return make_network(tmp_path / "gallery")


async def opened(app: SurveyApp, pilot) -> None:  # type: ignore[no-untyped-def]
    await app.workers.wait_for_complete()
    await pilot.pause()
    assert isinstance(app.screen, ProjectScreen)
    await pilot.press("t")
    for _ in range(3):
        await app.workers.wait_for_complete()
        await pilot.pause()
    assert isinstance(app.screen, TraverseScreen)


@pytest.mark.parametrize("size", [(80, 24), (120, 40)])
async def test_the_pages_show_the_adjustment(size: tuple[int, int], folder: Path) -> None:
    app = SurveyApp(str(folder))
    expected = api.adjust(folder)
    async with app.run_test(size=size) as pilot:
        await opened(app, pilot)
        screen = app.screen
        assert isinstance(screen, TraverseScreen)
        picture = screen.query_one(PlanCanvas).render().plain
        assert picture.count(FREE) == 3  # two points and the legend
        assert picture.count(FIXED) == 3
        canvas = screen.query_one(PlanCanvas)
        shown = [canvas.render_line(y).text for y in range(canvas.size.height)]
        drawn = picture.splitlines()
        shifts = {
            s.index(FREE) - d.index(FREE) for s, d in zip(shown, drawn, strict=True) if FREE in d
        }
        assert len(shifts) == 1, "blanks at the left were cut off"
        for key, page in enumerate(tuple(PAGES)[1:], 2):
            await pilot.press(str(key))
            await pilot.pause()
            assert screen.query_one(TabbedContent).active == page
        points = screen.query_one("#points DataTable", DataTable)
        assert [str(c) for c in points.get_row_at(3)][:2] == ["D", f"{expected.point('D').e:.4f}"]
        sights = screen.query_one("#observations DataTable", DataTable)
        row = [str(cell) for cell in sights.get_row_at(3)]
        residual = expected.observations[3].residual
        assert row[:3] == ["distance", "C", "D"]
        assert row[4] == f"{residual * 1e3:+.1f} mm"
        assert row[6] == f"{expected.observations[3].redundancy:.2f}"
        told = screen.query_one("#adjustment BlocksPane", BlocksPane)
        assert told.blocks == view.pages(expected, (), screen.unit)["adjustment"]
        await pilot.press("escape")
        await pilot.pause()
        assert isinstance(app.screen, ProjectScreen)


def test_the_plan_has_north_up_and_east_to_the_right(folder: Path) -> None:
    lines = draw_plan(api.adjust(folder), 70, 18).plain.splitlines()
    place = {
        name: next((r, line.index(name)) for r, line in enumerate(lines[:-1]) if name in line)
        for name in "ABCD"
    }
    assert place["B"][0] < place["A"][0]
    assert place["B"][1] == place["A"][1]
    assert place["C"][1] > place["B"][1]
    assert len(lines) == 18
    assert max(map(len, lines)) <= 70


def test_ellipses_are_enlarged_by_round_numbers() -> None:
    assert enlargement(0.01, 1.0) == 500.0
    assert enlargement(0.0, 1.0) == 1.0
    assert enlargement(100.0, 1.0) == pytest.approx(0.05)


async def test_what_cannot_be_adjusted_is_told(folder: Path) -> None:
    book = folder / "observations" / "main.csv"
    kept = [r for r in NETWORK_BOOK.splitlines() if not r.startswith(("angle,C", "distance,D,,A"))]
    book.write_text("\n".join(kept) + "\n", encoding="utf-8")
    app = SurveyApp(str(folder))
    async with app.run_test(size=(80, 24)) as pilot:
        await opened(app, pilot)
        assert app.screen.query(Problems)


async def test_a_project_without_traverse_says_so(folder: Path) -> None:
    toml = folder / "project.toml"
    toml.write_text(NETWORK[: NETWORK.index("[[traverse]]")], encoding="utf-8")
    app = SurveyApp(str(folder))
    async with app.run_test(size=(80, 24)) as pilot:
        await app.workers.wait_for_complete()
        await pilot.pause()
        await pilot.press("t")
        await pilot.pause()
        assert isinstance(app.screen, ProjectScreen)
        assert any(texts.NO_TRAVERSE in n.message for n in app._notifications)
