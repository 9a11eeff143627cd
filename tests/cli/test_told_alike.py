"""What the orientation warns of is told by every command that a surveyor works by."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from tests.cli.command import run

SAMPLE = Path(__file__).resolve().parents[2] / "projects" / "synthetic-breakthrough"


@pytest.fixture(scope="module")
def far(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The sample with every determination on one day, months before the gyro sides."""
    folder = Path(shutil.copytree(SAMPLE, tmp_path_factory.mktemp("far") / "p"))
    path = folder / "project.toml"
    text = path.read_text("utf-8").replace("date = 2026-04-29", "date = 2026-02-12")
    path.write_text(text, encoding="utf-8")
    return folder


def codes(command: str, folder: Path) -> list[str]:
    outcome = run(command, folder, "--json")
    assert outcome.code in (0, 1), outcome.err
    return [item["code"] for item in outcome.json["warnings"]]


def test_check_tells_what_orient_tells(far: Path) -> None:
    told = codes("orient", far)
    assert told.count("if_it_drifts") == 3  # the three gyro sides, 36 to 75 days later
    assert codes("check", far) == told
    assert run("check", far).out.count("if_it_drifts:") == 3


def test_a_traverse_tells_what_concerns_its_gyro_sides(far: Path) -> None:
    assert codes("adjust", far).count("if_it_drifts") == 3
    outcome = run("adjust", far, "--traverse", "B", "--json")
    lines = [x["subject"]["id"] for x in outcome.json["warnings"] if x["code"] == "if_it_drifts"]
    assert lines == ["B12-B13"]
