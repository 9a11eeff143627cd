"""A second set confirms only if it is one: not the session itself, not a copy, not four points."""

from __future__ import annotations

import dataclasses
import json
import re
import shutil
from pathlib import Path

import pytest

from surveyapp import api
from surveyapp.cli.main import main
from surveyapp.diagnosis import TurningPoints, diagnose
from surveyapp.diagnosis.subjects.reversal_run import reversal_run
from surveyapp.errors import SurveyError


@pytest.fixture
def runs(tmp_path: Path) -> Path:
    folder = tmp_path / "runs"
    api.simulate("reversal-run", folder, effects=["midpoint_step=40,at=0.5"], seed=6)
    return folder


def problems_of(
    folder: Path, capsys: pytest.CaptureFixture[str], *options: str
) -> list[dict[str, str]]:
    assert main(["diagnose", str(folder), *options, "--json"]) == 2
    return list(json.loads(capsys.readouterr().out)["problems"])


def test_the_session_itself_is_no_second_set(
    runs: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (problem,) = problems_of(runs, capsys, "--session", "run-1", "--confirm", "run-1")
    assert "no second set" in problem["what"]
    assert all(problem[key] for key in ("where", "found", "expected", "hint"))


@pytest.mark.parametrize("change", ["none", "cut", "one reading"])
def test_a_copy_of_the_book_is_no_second_set(
    runs: Path, capsys: pytest.CaptureFixture[str], change: str
) -> None:
    first, second = (runs / "observations" / f"run-{k}.csv" for k in (1, 2))
    shutil.copy(first, second)
    lines = second.read_text().splitlines()
    places = [i for i, line in enumerate(lines) if ",reversal," in line]
    if change == "cut":
        del lines[places[-1]]
    elif change == "one reading":
        lines[places[3]] = re.sub(r"-(\d)(\d)(\.\d+)?,dms", r"-\g<2>\g<1>\3,dms", lines[places[3]])
    second.write_text("\n".join(lines) + "\n")
    (problem,) = problems_of(runs, capsys, "--session", "run-1", "--confirm", "run-2")
    assert "no second set" in problem["what"]
    assert "observations of run-1" in problem["found"]


def test_a_second_run_has_at_least_six_points(
    runs: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    book = runs / "observations" / "run-2.csv"
    lines = book.read_text().splitlines()
    places = [i for i, line in enumerate(lines) if ",reversal," in line]
    dropped = set(places[5:])
    book.write_text("\n".join(x for i, x in enumerate(lines) if i not in dropped) + "\n")
    (problem,) = problems_of(runs, capsys, "--session", "run-1", "--confirm", "run-2")
    assert problem["what"] == "too few observations in the second set"
    assert problem["expected"] == "at least 6"


def test_a_real_second_run_still_confirms(runs: Path) -> None:
    found = api.diagnose(runs, session="run-1", confirm="run-2").to_dict()
    assert found["after"]["confirm_rms"] < found["before"]["confirm_rms"]


@pytest.mark.parametrize("first", ["det-001", "det-040"])
def test_a_campaign_needs_two_parts(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], first: str
) -> None:
    api.simulate("campaign", tmp_path / "c", seed=3)
    (problem,) = problems_of(tmp_path / "c", capsys, "--campaign", "G1", "--confirm", first)
    assert problem["where"] == "--confirm"
    assert "no two parts" in problem["what"]


def test_scripts_are_refused_as_well() -> None:
    k = range(12)
    readings = [3.1 + 0.02 * (-1.0) ** i * 0.99**i for i in k]
    first = TurningPoints(readings, instrument="G")
    copy = dataclasses.replace(first, identity="another name")
    with pytest.raises(SurveyError, match="no second set"):
        diagnose(reversal_run(first), confirm=reversal_run(copy))
