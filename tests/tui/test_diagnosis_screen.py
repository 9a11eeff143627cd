"""The diagnosis on the screen: the verdict of the engine, and an adoption that asks once."""

import shutil
from pathlib import Path

import pytest
from textual.widgets import DataTable

from surveyapp import api
from surveyapp.report.blocks import Paragraph
from surveyapp.tui.app import SurveyApp
from surveyapp.tui.screens.confirm import ConfirmScreen
from surveyapp.tui.screens.diagnosis import DiagnosisScreen
from surveyapp.tui.screens.project import ProjectScreen
from surveyapp.tui.views.diagnosis import diagnosis_blocks

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.parametrize("size", [(80, 24), (120, 40)])
async def test_diagnosis_is_shown_asked_for_and_adopted_once(
    size: tuple[int, int], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    folder = tmp_path / "johannesburg-1966"
    shutil.copytree(ROOT / "projects" / "johannesburg-1966", folder)
    before = (folder / "project.toml").read_text()
    app = SurveyApp(str(folder))
    async with app.run_test(size=size) as pilot:
        await app.workers.wait_for_complete()
        await pilot.pause()
        while not isinstance(app.screen, ProjectScreen):
            await pilot.press("escape")
            await pilot.pause()
        await pilot.press("d")
        await app.workers.wait_for_complete()
        await pilot.pause()
        screen = app.screen
        assert isinstance(screen, DiagnosisScreen)
        table = screen.query_one(DataTable)
        row = [str(cell) for cell in table.get_row_at(0)]
        expected = api.diagnose(folder, log=False)
        assert expected.diagnosis is not None
        assert row == ["run", "run-1966-05-13", expected.diagnosis.verdict.replace("_", " ")]
        told = screen.told[0]
        assert told == diagnosis_blocks(expected, api.open_project(folder).angle_unit)
        for sentence in expected.words:
            assert Paragraph(sentence) in told
        await pilot.press("a")
        await pilot.pause()
        assert isinstance(app.screen, ConfirmScreen)
        await pilot.press("escape")
        await pilot.pause()
        assert (folder / "project.toml").read_text() == before
        await pilot.press("a")
        await pilot.pause()
        await pilot.press("enter")
        await pilot.pause()
        await app.workers.wait_for_complete()
        await pilot.pause()
        assert api.open_project(folder).sessions[0].effects[0].id == "damping_break"
        await pilot.press("escape")
        await app.workers.wait_for_complete()
        await pilot.pause()
        assert isinstance(app.screen, ProjectScreen)
        assert app.screen.result is not None
        assert app.screen.result.sessions[0].estimator.endswith("damping_break")
