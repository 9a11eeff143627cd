"""Numbers typed on the command line: what is none, or means nothing, is told in words, exit 2."""

from pathlib import Path

import numpy as np
import pytest

from surveyapp.errors import nearest_names
from tests.cli.command import Outcome, run

SENSOR_COMMANDS = (
    ("allan",),
    ("spectrum",),
    ("filter",),
    ("motion",),
    ("calibrate", "tilt"),
    ("north", "--method", "indexing"),
)


def noise(folder: Path) -> Path:
    """A record of two rates and an acceleration."""
    draws = np.random.default_rng(7).normal(size=(400, 7)) * 1e-3
    names = [
        f"{kind}_{axis}_{unit}"
        for kind, unit in (("gyr", "rad_s"), ("acc", "m_s2"))
        for axis in "xyz"
    ]
    rows = [",".join(["time_s", *names])]
    for i, row in enumerate(draws):
        rows.append(",".join(f"{v:.9f}" for v in (0.01 * i, *row[:5], 9.80665 + row[5])))
    path = folder / "noise.csv"
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")
    return path


def told_about(outcome: Outcome, where: str) -> None:
    """Exit 2, and a problem in words under the name of the option."""
    assert outcome.code == 2, outcome.out
    assert outcome.json["schema"] == "surveyapp.error/1"
    named = [p for p in outcome.json["problems"] if p["where"].startswith(where)]
    assert named, outcome.out
    for problem in named:
        assert problem["what"].startswith(("this is no", "no averaging"))
        assert problem["expected"]


@pytest.mark.parametrize("value", ["nan", "inf", "-inf", "1e308", "x", "", "45-30-00", "1,2"])
@pytest.mark.parametrize("command", SENSOR_COMMANDS, ids=lambda c: c[0])
def test_what_is_no_finite_number_is_told_under_its_option(
    tmp_path: Path, command: tuple[str, ...], value: str
) -> None:
    told_about(run(*command, noise(tmp_path), f"--rate-hz={value}", "--json"), "--rate-hz")


@pytest.mark.parametrize("value", ["nan", "2.5", "x", "1e400"])
def test_what_is_no_whole_number_is_told(tmp_path: Path, value: str) -> None:
    told_about(run("allan", noise(tmp_path), f"--header-rows={value}", "--json"), "--header-rows")


@pytest.mark.parametrize("value", ["nan", "inf"])
def test_temperature_that_is_none_is_told(tmp_path: Path, value: str) -> None:
    option = "--reference-temperature-c"
    told_about(run("calibrate", "tilt", noise(tmp_path), f"{option}={value}", "--json"), option)


@pytest.mark.parametrize("value", ["nan", "inf", "-inf"])
def test_scale_that_is_no_finite_number_is_told(tmp_path: Path, value: str) -> None:
    scale = f"gyr_x_rad_s={value}"
    told_about(run("allan", noise(tmp_path), "--scale", scale, "--json"), "--scale")


def test_numbers_out_of_all_proportion_are_told(tmp_path: Path) -> None:
    log = noise(tmp_path)
    told_about(run("allan", log, "--rate-hz=1e-320", "--json"), "--rate-hz")
    told_about(run("allan", log, "--taus=1e308", "--json"), "--taus")
    told_about(run("motion", log, "--false-alarm=1e-320", "--json"), "--false-alarm")


def test_smallest_false_alarm_is_computed(tmp_path: Path) -> None:
    outcome = run("motion", noise(tmp_path), "--false-alarm=1e-9", "--json")
    assert outcome.code in (0, 1), outcome.out
    assert outcome.json["schema"] == "surveyapp.motion/1"


def test_hint_names_each_name_once() -> None:
    assert nearest_names("q", ["time_s", "gyr_x", "time_s"]) == "Known: gyr_x, time_s"


@pytest.mark.parametrize(
    "typed",
    [
        ("motion", "--from", "-5,3,20", "--to", "-3,-2.5"),
        ("north", "--bias-prior-deg-h", "-3,2,-5", "--declination", "-2.6,0.4"),
        ("calibrate", "rate", "--predict-at", "-10,-.5,20", "--latitude", "-3.5e1"),
    ],
)
def test_a_list_may_begin_with_a_minus(typed: tuple[str, ...], tmp_path: Path) -> None:
    """The only complaint is about the log that is not there."""
    outcome = run(*typed, str(tmp_path / "none.csv"), "--json")
    assert outcome.code == 2
    assert [p["what"] for p in outcome.json["problems"]] == ["the log does not exist"]
