"""The loop on the other logs of rate sensors: a total station's gyro, and lines in the samples."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from surveyapp import api
from surveyapp.diagnosis.rate_lines import LINE_ALARM, Stretch, judge_lines
from surveyapp.io.sensor_logs.reading import open_log
from surveyapp.io.sensor_logs.tables import request_of
from surveyapp.workflows.rate_case import case
from tests.cli.command import run as surveyapp


def simulated(folder: Path, *arguments: str) -> Path:
    assert surveyapp("simulate", *arguments[:1], folder, *arguments[1:]).code == 0
    return folder


def test_a_wrong_set_of_a_total_stations_gyro_is_a_gross_error(tmp_path: Path) -> None:
    """3 deg/h in the clockwise turns of set 3, in both passes: two rows of 0.00083 deg/s."""
    folder = simulated(tmp_path / "fog", "fog-station", "--effect", "gross_error=3", "--seed", "5")
    found = surveyapp("diagnose", folder, "--sensor", "fog-station", "--json").json
    assert [item["effect"] for item in found["adopted"]] == ["gross_error"]
    sizes = [c["value"] for c in found["adopted"][0]["coefficients"]]
    assert sizes == pytest.approx([3.0 / 3600.0] * 2, rel=0.1)
    assert found["after"]["loo_rms"] < 0.5 * found["before"]["loo_rms"]
    clean = simulated(tmp_path / "clean", "fog-station", "--seed", "3")
    assert surveyapp("diagnose", clean, "--sensor", "fog-station", "--json").json["adopted"] == []


def test_a_line_in_the_samples_is_named_and_helps_on_the_blocks_left_out(tmp_path: Path) -> None:
    """1.5 deg/h at 2.48 Hz on gyro x: frequency within three of its sigmas."""
    folder = simulated(
        tmp_path / "line", "rate", "--effect", "interference_line=1.5", "--seed", "5"
    )
    found = surveyapp("diagnose", folder, "--sensor", "six-position", "--json").json
    assert [item["effect"] for item in found["adopted"]] == ["interference_line"]
    line = found["lines"][0]
    assert abs(line["frequency"] - 2.48) < 4.0 * line["sigma_frequency"]
    proof = found["interference"][0]
    assert proof["gyro"] == "x"
    assert proof["held_out"]["after"] < proof["held_out"]["before"]


def test_lines_of_noise_are_false_alarms_at_the_stated_rate() -> None:
    """60 records of two parts whose sampling begins anew: 8 and more at 5 % have p = .01.

    The earth rate comes round once a turn and is no line.
    """
    rng = np.random.default_rng(2)
    time = np.concatenate([np.arange(1500) * 0.1, 150.05 + np.arange(1500) * 0.1])
    stretches = [Stretch(0, 1500, math.radians(20.0)), Stretch(1500, 3000, math.radians(20.0))]
    earth = 5.0 * np.cos(math.radians(20.0) * time)
    alarms = sum(
        bool(judge_lines(time, [earth + rng.normal(size=3000)], stretches, ("x",)).lines)
        for _ in range(60)
    )
    assert alarms <= 7


def test_a_line_in_a_record_with_pauses_is_one_line() -> None:
    """Turning 9 of 15 s: images of the line stand 1/15 Hz beside it until it is out."""
    rng = np.random.default_rng(4)
    time = np.arange(9000.0) * 0.05
    values = rng.normal(size=time.size) + np.cos(2.0 * math.pi * 2.48 * time + 1.0)
    stretches = [Stretch(k * 300, k * 300 + 180) for k in range(30)]
    found = judge_lines(time, [values], stretches, ("x",)).lines
    assert len(found) == 1
    assert found[0].line.frequency == pytest.approx(2.48, abs=1e-3)
    assert math.hypot(found[0].cosine, found[0].sine) == pytest.approx(1.0, abs=0.1)
    assert found[0].after < found[0].before


def test_a_line_is_found_where_the_pauses_are_longer_than_the_turns() -> None:
    """Two turns of 30 s, 30 s apart, then 120 s without any: under half of the record turns."""
    rng = np.random.default_rng(4)
    time = np.arange(0.0, 1260.0, 0.05)
    stretches = [Stretch(k * 4200 + a, k * 4200 + a + 600) for k in range(6) for a in (0, 1200)]
    noise = rng.normal(size=time.size)
    assert judge_lines(time, [noise], stretches, ("x",)).lines == ()
    values = noise + 0.5 * np.cos(2.0 * math.pi * 2.48 * time + 1.0)
    found = judge_lines(time, [values], stretches, ("x",)).lines
    assert len(found) == 1
    assert found[0].line.frequency == pytest.approx(2.48, abs=3e-3)
    assert found[0].after < found[0].before


def test_without_a_choice_the_sensor_logs_are_listed(tmp_path: Path) -> None:
    folder = simulated(tmp_path / "unit", "rate", "--programme", "multi-position")
    found = surveyapp("diagnose", folder, "--json").json
    assert found["subjects"] == [
        {"option": "--sensor", "id": "multi-position", "observations": None}
    ]
    assert "--sensor" in surveyapp("diagnose", folder).out


def test_a_log_of_no_stated_kind_is_refused_by_that(tmp_path: Path) -> None:
    folder = simulated(tmp_path / "unit", "rate", "--programme", "multi-position")
    toml = folder / "project.toml"
    toml.write_text(toml.read_text().replace('kind = "rate"\n', ""))
    refused = surveyapp("diagnose", folder, "--sensor", "multi-position", "--json")
    assert refused.code == 2
    assert [p["found"] for p in refused.json["problems"]] == ["no kind"]


def test_means_of_stops_leave_no_line_where_the_noise_walks() -> None:
    """24 records of a total station's gyro: 20 stops of 12 s, white noise and a walk.

    At .05 seven and more have p = .0002; without the notch left out 14 of 24 show a line.
    """
    time = np.arange(20 * 340) / 20.0
    stretches = [Stretch(k * 340, k * 340 + 240, math.radians(60.0)) for k in range(20)]
    alarms = 0
    for seed in range(24):
        rng = np.random.default_rng(seed)
        walk = np.cumsum(rng.standard_normal(time.size)) / math.sqrt(1000.0)
        found = judge_lines(time, [rng.standard_normal(time.size) + walk], stretches, ("x",))
        alarms += found.p is not None and found.p <= 0.05
    assert alarms <= 6


def test_logs_whose_samples_are_searched_have_gates_of_their_own(tmp_path: Path) -> None:
    """One false alarm in twenty for stops and lines together, on a table or held by hand."""
    for programme in ("six-position", "multi-position"):
        folder = simulated(tmp_path / programme, "rate", "--programme", programme, "--seed", "5")
        entry = api.open_project(folder).sensor_logs[0]
        levels = case(open_log(request_of(entry, folder)), entry, ()).case.levels
        assert levels.first + LINE_ALARM == pytest.approx(0.05)
        assert levels.further < levels.first
