"""A guided programme on the command line, from its start to the card."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from surveyapp import api
from surveyapp.cli.main import main
from surveyapp_models.compass.heading import level_field


def told(capsys: pytest.CaptureFixture[str], *arguments: str, code: int = 0) -> Any:
    assert main(["programme", *arguments, "--json"]) == code
    return json.loads(capsys.readouterr().out)


def test_a_swing_from_the_first_step_to_its_card(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = str(tmp_path / "mine")
    api.new_project(folder)
    state = told(capsys, "start", folder, "compass-swing", "--id", "sw")
    assert state["next"] == "mount"
    for _ in range(3):
        state = told(capsys, "enter", folder, "sw", "next")
    # the warm-up was passed over at once: that stands in the record
    assert state["warnings"] == ["Warm up 10 min: 0.0 of 10 min"]
    rng = np.random.default_rng(2)
    for degrees in range(0, 360, 30):
        # known minus shown: A = 2 degrees and nothing else
        psi = np.radians([degrees - 2.0])
        field = level_field(psi, size=50.0, dip=math.radians(65.0))[0] + rng.normal(0.0, 0.05, 3)
        state = told(capsys, "enter", folder, "sw", "next", *(f"{v:.3f}" for v in field))
    assert state["complete"]
    assert state["undetermined"] == []
    card = tmp_path / "sw.toml"
    ended = told(capsys, "finish", folder, "sw", "--card", str(card))
    assert ended["schema"] == "surveyapp.programme_result/1"
    found = {p["name"]: p for p in ended["calibration"]["parameters"]}
    assert abs(found["deviation_A"]["value"] - 2.0) < 4.0 * found["deviation_A"]["sigma"]
    assert all(p["reason"] is None for p in found.values())
    assert "0.0 of 10 min" in card.read_text()
    (run,) = told(capsys, "runs", folder)["runs"]
    assert (run["programme"], run["done"], run["of"]) == ("compass-swing", 15, 15)


def test_what_is_typed_wrongly_writes_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = str(tmp_path / "mine")
    api.new_project(folder)
    told(capsys, "start", folder, "tilt-static", "--id", "t")
    file = tmp_path / "mine/sensors/t.programme.csv"
    assert "JJF 1427-2013" in file.read_text()
    before = file.read_bytes()
    for words in (
        ["enter", folder, "t", "static-1-01", "a", "b"],
        ["enter", folder, "t", "nowhere"],
        ["enter", folder, "t", "mount", "abc"],
        ["finish", folder, "t"],
        ["start", folder, "tilt-static", "--id", "t"],
        ["start", folder, "tilt"],
        ["show", folder],
        ["show", folder, "other"],
        ["undo", folder, "t"],
    ):
        problem = told(capsys, *words, code=2)
        assert problem["schema"] == "surveyapp.error/1"
    assert file.read_bytes() == before


def test_the_list_and_its_steps(capsys: pytest.CaptureFixture[str]) -> None:
    every = told(capsys)["programmes"]
    assert {p["id"] for p in every} >= {"tilt-static", "tilt-transverse", "tilt-zero"}
    assert main(["programme", "list", "tilt-static"]) == 0
    shown = capsys.readouterr().out
    assert "JJF 1427-2013" in shown
    assert shown.count("of +-90 degrees") == 13
