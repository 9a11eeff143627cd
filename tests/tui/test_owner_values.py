"""What only the owner of a gyro knows is asked for and told where it is missing."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest
from textual.widgets import Input, Select, Static, TextArea

from surveyapp import api
from surveyapp.core.observing.owner_values import OwnerValue, missing_at, missing_values
from surveyapp.core.observing.steps import Step
from surveyapp.errors import SurveyError
from surveyapp.observation.owner_entries import OwnerEntries
from surveyapp.tui.app import SurveyApp
from surveyapp.tui.screens.new_project import NewProjectScreen
from surveyapp.tui.widgets.run import RunPane
from tests.tui.helpers_tui import (
    SMALL,
    settle,
)

PERIOD, SCALE, TORSION = OwnerValue.PERIOD, OwnerValue.SCALE, OwnerValue.TORSION


def test_what_a_card_lacks() -> None:
    assert missing_values(api.model("wild-gak1")) == (PERIOD, SCALE, TORSION)
    assert missing_values(api.model("gyromat-3000")) == ()


@pytest.mark.parametrize(
    ("method", "step", "wanted"),
    [
        ("tracking", Step.ZERO_BEFORE, (SCALE, TORSION)),
        ("tracking", Step.SWING, (PERIOD,)),
        ("tracking", Step.SIGHTS_BEFORE, ()),
        ("amplitude", Step.SWING, (SCALE, TORSION)),
        ("transit", Step.SWING, (SCALE, TORSION)),
    ],
)
def test_each_step_asks_for_what_it_needs(
    method: str, step: Step, wanted: tuple[OwnerValue, ...]
) -> None:
    assert missing_at(api.model("wild-gak1"), method, step) == wanted  # type: ignore[arg-type]


def test_entries_are_numbers_or_all_problems_are_told() -> None:
    found = OwnerEntries("600", "425.4 388.3 47.0", "0.2").overrides()
    assert found["period"] == {"latitude_deg": 47.0, "tracking_s": 425.4, "clamped_s": 388.3}
    assert OwnerEntries(periods="425.4 47").overrides() == {
        "period": {"latitude_deg": 47.0, "tracking_s": 425.4}
    }
    with pytest.raises(SurveyError) as caught:
        OwnerEntries("ten", "425.4", "").overrides()
    assert len(caught.value.problems) == 2


def test_new_tells_what_the_owner_must_enter(tmp_path: Path) -> None:
    made = api.new_project(tmp_path / "p", card="wild-gak1")
    assert made.to_dict()["to_enter"] == ["period", "scale value", "torsion ratio"]
    assert api.open_project(made).instrument("G1").card.id == "wild-gak1"
    with pytest.raises(SurveyError, match="no such instrument card"):
        api.new_project(tmp_path / "q", card="wild-gak")
    assert not (tmp_path / "q").exists()


async def test_the_form_asks_and_the_step_tells(tmp_path: Path) -> None:
    folder = tmp_path / "ramp"
    app = SurveyApp(None)
    async with app.run_test(size=SMALL) as pilot:
        await settle(pilot)
        await pilot.press("n")
        await settle(pilot)
        form = app.screen
        assert isinstance(form, NewProjectScreen)
        scale = form.query_one("#scale", Input)
        assert not scale.region  # no instrument yet: nothing is asked
        form.query_one("#name", Input).value = "Ramp"
        form.query_one("#folder", Input).value = str(folder)
        form.query_one("#stations", TextArea).text = "A 0 0\nB 300 0"
        form.query_one("#card", Select).value = "wild-gak1"
        await settle(pilot)
        assert "period, scale value, torsion ratio" in str(
            form.query_one("#card-told", Static).content
        )
        form.query_one("#scale", Input).value = "600"
        await pilot.press("f8")
        await settle(pilot)
        data = tomllib.loads((folder / "project.toml").read_text(encoding="utf-8"))
        assert data["instrument"][0]["scale_value_arcsec"] == 600.0
        await pilot.press("n")
        await settle(pilot)
        app.screen.query_one("#id", Input).value = "r1"
        await pilot.press("f8")
        await settle(pilot)
        await pilot.press(*["f8"] * 2)
        await settle(pilot)
        told = app.screen.query_one(RunPane).missing_told()
        assert "torsion ratio" in told
        assert "scale value" not in told
