"""Cells of a log that no sensor gives: told in words, exit 2, in every command that reads logs."""

from pathlib import Path

import pytest

from tests.cli.command import run
from tests.cli.test_hunt_numbers import noise

COMMANDS = (
    ("allan",),
    ("spectrum", "--column", "gyr_x_rad_s"),
    ("motion",),
    ("filter", "--column", "gyr_x_rad_s"),
)


@pytest.mark.parametrize("cell", ["1e308", "-1e21", "inf", "nan", "", "x"])
@pytest.mark.parametrize("command", COMMANDS, ids=lambda c: c[0])
def test_cell_that_no_sensor_gives(tmp_path: Path, command: tuple[str, ...], cell: str) -> None:
    log = noise(tmp_path)
    lines = log.read_text(encoding="utf-8").splitlines()
    cells = lines[20].split(",")
    lines[20] = ",".join([cells[0], cell, *cells[2:]])
    log.write_text("\n".join(lines) + "\n", encoding="utf-8")
    outcome = run(command[0], log, *command[1:], "--json")
    assert outcome.code == 2, outcome.out
    assert "gyr_x_rad_s" in outcome.out or "number" in outcome.out


@pytest.mark.parametrize("rows", [1, 2, 3])
def test_record_of_some_rows_has_no_spectrum(tmp_path: Path, rows: int) -> None:
    log = noise(tmp_path)
    lines = log.read_text(encoding="utf-8").splitlines()[: rows + 1]
    log.write_text("\n".join(lines) + "\n", encoding="utf-8")
    outcome = run("spectrum", log, "--column", "gyr_x_rad_s", "--json")
    assert outcome.code == 2, outcome.out


@pytest.mark.parametrize("cell", ["nan", "", "inf", "1e15"])
def test_odometer_that_cannot_be_followed(tmp_path: Path, cell: str) -> None:
    assert run("simulate", "vehicle", tmp_path / "s", "--json").code == 0
    log = next((tmp_path / "s" / "sensors").glob("*.csv"))
    lines = log.read_text(encoding="utf-8").splitlines()
    place = lines[0].split(",").index("odometer_m")
    cells = lines[50].split(",")
    lines[50] = ",".join([*cells[:place], cell, *cells[place + 1 :]])
    log.write_text("\n".join(lines) + "\n", encoding="utf-8")
    outcome = run("motion", log, "--path", "--snap", "--json")
    assert outcome.code == 2, outcome.out
    assert "odometer_m" in outcome.out or "drives" in outcome.out


@pytest.mark.parametrize("cell", ["0.1\r0.2", '"' + "1" * 200_000 + '"', '"0.1'])
@pytest.mark.parametrize("command", COMMANDS, ids=lambda c: c[0])
def test_row_that_is_no_csv(tmp_path: Path, command: tuple[str, ...], cell: str) -> None:
    """A bare carriage return, an endless cell and an open quote are told with their line."""
    log = noise(tmp_path)
    lines = log.read_text(encoding="utf-8").splitlines()
    cells = lines[20].split(",")
    lines[20] = ",".join([cells[0], cell, *cells[2:]])
    log.write_bytes(("\n".join(lines) + "\n").encode())
    outcome = run(command[0], log, *command[1:], "--json")
    assert outcome.code == 2, outcome.out
    assert "line 21" in outcome.out
