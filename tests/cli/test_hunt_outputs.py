"""No result replaces what it was computed from; a card that is written can be read."""

from pathlib import Path

import numpy as np
import pytest

from surveyapp.io.tomltext import toml_value
from tests.cli.command import good_project, run


def copy_of(folder: Path) -> dict[str, bytes]:
    """Every file with its bytes."""
    files = (item for item in folder.rglob("*") if item.is_file())
    return {item.relative_to(folder).as_posix(): item.read_bytes() for item in files}


@pytest.mark.parametrize("name", ["project.toml", "observations/run.csv"])
def test_no_result_replaces_the_record_of_a_project(tmp_path: Path, name: str) -> None:
    folder = good_project(tmp_path / "p")
    before = copy_of(folder)
    for command in (
        ("export", "csv", folder, folder / name),
        ("export", "json", folder, folder / name),
        ("export", "zip", folder, folder / name),
        ("export", "geojson", folder, folder / name),
        ("batch", folder, "-o", folder / name),
        ("report", folder, "-o", folder / name),
    ):
        outcome = run(*command, "--json")
        assert outcome.code == 2, command
        assert outcome.json["schema"] == "surveyapp.error/1"
        assert copy_of(folder) == before, command


def test_an_earlier_result_is_replaced(tmp_path: Path) -> None:
    folder = good_project(tmp_path / "p")
    for _ in range(2):
        outcome = run("export", "csv", folder, folder / "lines.csv", "--json")
        assert outcome.code == 0, outcome.out


@pytest.mark.parametrize("kind", ["compass", "tilt", "rate"])
def test_card_is_read_again_and_its_log_never_replaced(tmp_path: Path, kind: str) -> None:
    assert run("simulate", kind, tmp_path / "s", "--json").code == 0
    log = next((tmp_path / "s" / "sensors").glob("*.csv"))
    card, out = tmp_path / "card.toml", tmp_path / "out.csv"
    options = ("--programme", "six-position", "--latitude", "45.77") if kind == "rate" else ()
    assert run("calibrate", kind, log, *options, "--card", card, "--json").code in (0, 1)
    if not card.exists():
        pytest.skip("nothing was determined")
    outcome = run("compensate", kind, log, "--card", card, "-o", out, "--json")
    assert outcome.code == 0, outcome.out
    before = log.read_bytes()
    for target in (log, card):
        outcome = run("compensate", kind, log, "--card", card, "-o", target, "--json")
        assert outcome.code == 2, outcome.out
    assert log.read_bytes() == before


def test_numbers_of_numpy_are_written_as_numbers() -> None:
    assert toml_value(np.float64(0.5)) == "0.5"
    assert toml_value([np.float64(1e-9)]) == "[1e-09]"
