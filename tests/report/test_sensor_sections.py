"""Sensor logs in the record: the numbers of the API, a plot on whole decades, reasons in words."""

from __future__ import annotations

import math
import shutil
from itertools import pairwise
from pathlib import Path

import pytest

from surveyapp import api
from surveyapp.domain.noise import AllanChannel
from surveyapp.report.blocks import Marker, Table
from surveyapp.report.numbers import four_digits
from surveyapp.report.sections import sensors

PROJECTS = Path(__file__).resolve().parents[2] / "projects"


def test_the_record_holds_every_parameter_with_its_sigma(tmp_path: Path) -> None:
    folder = PROJECTS / "xsens-multi-position"
    found = api.calibrate("rate", folder)
    text = api.report_text(folder)
    for item in found.parameters:
        name = item.name.replace("_", " ")
        line = next(row for row in text.splitlines() if row.startswith(f"  {name} "))
        assert four_digits(item.value) in line
        assert four_digits(item.sigma) in line
    assert found.sha256[:16] in text
    written = api.report(folder, tmp_path / "record.pdf")
    assert "sensor log multi-position" in written.sections
    again = api.report(folder, tmp_path / "again.pdf")
    assert again.sha256 == written.sha256


def test_a_refused_calibration_says_so() -> None:
    text = " ".join(api.report_text(PROJECTS / "broad-attached-magnet").split())
    assert "no sensor card comes of this log" in text
    assert "the record does not determine the result: hard_iron_x" in text


def test_the_noise_of_a_log_without_a_kind_has_a_table_and_a_plot() -> None:
    found = api.allan(PROJECTS / "mpu6050-static")
    blocks = sensors.allan_blocks("static", found)
    table = next(block for block in blocks if isinstance(block, Table))
    assert len(table.rows) == len(found.channels[0].taus_s)
    assert "Allan deviation of gyr_y_rad_s" in api.report_text(PROJECTS / "mpu6050-static")


def test_a_slope_of_minus_one_half_is_one_in_the_plot() -> None:
    """White noise: the same number of decades on paper, whatever the numbers."""
    taus = (0.1, 1.0, 10.0, 100.0)
    values = tuple(2e-3 / math.sqrt(tau) for tau in taus)
    low, high = (tuple(factor * value for value in values) for factor in (0.9, 1.1))
    channel = AllanChannel("x", "1", 10.0, 1000, taus, values, low, high, ())
    (figure,) = sensors.allan_figures(channel)
    at = [part.at for part in figure.primitives if isinstance(part, Marker)]
    across = [b[0] - a[0] for a, b in pairwise(at)]
    down = [a[1] - b[1] for a, b in pairwise(at)]
    assert across == pytest.approx([across[0]] * 3)
    assert down == pytest.approx([down[0]] * 3)
    assert across[0] > 0.0
    assert down[0] > 0.0


def test_a_log_that_is_not_there_says_why_and_the_record_is_written(tmp_path: Path) -> None:
    folder = Path(shutil.copytree(PROJECTS / "mpu6050-static", tmp_path / "copy"))
    (folder / "sensors" / "static.csv").unlink()
    text = api.report_text(folder)
    assert "Sensor log static" in text
    assert "static.csv" in text


def test_a_log_outside_of_the_folder_is_not_read_into_the_record(tmp_path: Path) -> None:
    folder = Path(shutil.copytree(PROJECTS / "mpu6050-static", tmp_path / "copy"))
    (folder / "sensors" / "static.csv").rename(tmp_path / "static.csv")
    toml = folder / "project.toml"
    toml.write_text(toml.read_text().replace("sensors/static.csv", "../static.csv"))
    text = " ".join(api.report_text(folder).split())
    assert "outside of the project folder" in text
    assert "Allan deviation" not in text


def test_a_project_of_sensors_alone_claims_no_check_on_its_first_page() -> None:
    from pathlib import Path

    from surveyapp import api

    projects = Path(__file__).resolve().parents[2] / "projects"
    for name, told in (
        ("broad-attached-magnet", "NOT MET: the calibration is refused"),
        ("mpu6050-static", "its noise is told, nothing is judged"),
    ):
        text = " ".join(api.report_text(projects / name).split())
        assert "every confirmed check" not in text
        assert "no azimuth is observed here" in text
        assert told in text
