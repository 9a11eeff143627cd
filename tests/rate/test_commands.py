"""The commands of rate sensors: keys, exit codes and refusals as a script sees them."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from surveyapp.core.simulate.rate.table_programmes import DEG_H, fog_station_log
from surveyapp_models.rate.fog_station import FogOnTelescope
from tests.cli.command import run as surveyapp
from tests.rate.fog_rows import fog_north_rows
from tests.rate.logs import PUBLISHED_CONSTANT, published_run


@pytest.fixture(scope="module")
def projects(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("rate")
    for kind, name, programme in (
        ("rate", "six", []),
        ("rate", "chamber", ["--programme", "temperature"]),
        ("fog-station", "fog", []),
    ):
        assert surveyapp("simulate", kind, str(root / name), *programme).code == 0
    return root


def test_six_positions_from_a_project(projects: Path) -> None:
    done = surveyapp("calibrate", "rate", str(projects / "six"), "--json")
    assert done.code == 0
    found = json.loads(done.out)
    truth = json.loads((projects / "six" / "truth.json").read_text())
    assert found["schema"] == "surveyapp.calibrate/1"
    assert len(found["parameters"]) == 12
    for item in found["parameters"]:
        assert abs(item["value"] - truth[item["name"]]) < 4.5 * item["sigma"]
    assert found["geometry"]["undetermined"] == []
    assert {s["step"] for s in found["steps"]} == {"levelling", "smoothing", "segment"}
    assert [s["turns_used"] for s in found["steps"] if s["step"] == "segment"] == [4] * 12
    assert found["traditional"]["parameters"]


def test_the_chamber_ends_with_one_without_the_room_and_is_complete_with_it(
    projects: Path,
) -> None:
    folder = str(projects / "chamber")
    done = surveyapp("calibrate", "rate", folder, "--predict-at", "0,25", "--json")
    assert done.code == 1
    found = json.loads(done.out)
    assert [p["temperature_c"] for p in found["predicted"]] == [0.0, 25.0]
    assert len(found["nodes"]) == 5
    assert {c["model"] for c in found["compensation"]} == {
        "none", "linear", "piecewise_linear", "cubic", "grey",
    }  # fmt: skip
    assert all(c["admissible"] is None for c in found["compensation"] if c["model"] != "grey")
    assert all("accelerometer_misalignment" in n for n in found["geometry"]["undetermined"])
    room = str(projects / "six" / "sensors" / "six-position.csv")
    complete = surveyapp("calibrate", "rate", folder, "--room", room, "--json")
    assert complete.code == 0


def test_a_temperature_outside_the_nodes_and_a_missing_latitude_are_refused(
    projects: Path,
) -> None:
    log = str(projects / "chamber" / "sensors" / "temperature.csv")
    base = ("calibrate", "rate", log, "--programme", "temperature", "--json")
    outside = surveyapp(*base, "--latitude", "45", "--predict-at", "55")
    assert outside.code == 2
    assert "outside the nodes" in json.loads(outside.out)["problems"][0]["what"]
    without = surveyapp(*base)
    assert without.code == 2
    assert json.loads(without.out)["problems"][0]["where"] == "--latitude"


def test_the_rule_of_the_circle_is_never_guessed(projects: Path) -> None:
    log = str(projects / "fog" / "sensors" / "fog-station.csv")
    refused = surveyapp("calibrate", "fog-station", log, "--json")
    assert refused.code == 2
    assert json.loads(refused.out)["problems"][0]["where"] == "--reading-from-elevation"
    done = surveyapp(
        "calibrate", "fog-station", log, "--reading-from-elevation", "increases", "--json"
    )
    found = json.loads(done.out)
    constant = next(p["value"] for p in found["parameters"] if p["name"] == "instrument_constant")
    assert constant == pytest.approx(171.0 + 7 / 60 + 49 / 3600, abs=1e-5)
    wrong = surveyapp(
        "calibrate", "fog-station", log, "--reading-from-elevation", "decreases", "--json"
    )
    assert wrong.code == 2
    assert "contradicts the passes" in json.loads(wrong.out)["problems"][0]["what"]


def test_repeats_that_exceed_the_model_end_with_one(tmp_path: Path) -> None:
    log = fog_station_log(published_run(rate_error=2.84e-4), np.random.default_rng(1))
    path = tmp_path / "log.csv"
    path.write_text(log.csv())
    done = surveyapp(
        "calibrate", "fog-station", str(path), "--reading-from-elevation", "increases",
        "--table-rate-relative-sigma", "1e-4", "--json",
    )  # fmt: skip
    found = json.loads(done.out)
    assert done.code == 1
    assert set(found["scatter"]) == {
        "verdict", "sd_arcsec", "model_sd_arcsec", "p", "relative_rate_error_needed",
    }  # fmt: skip
    assert found["scatter"]["verdict"] == "exceeds_model"
    assert len(found["sets"]) == 20


def north_log(tmp_path: Path, count: int) -> str:
    fog = FogOnTelescope(constant=PUBLISHED_CONSTANT, bias=3 * DEG_H, collimation=1e-3)
    north, beta = math.radians(123.0), PUBLISHED_CONSTANT
    readings = (
        (north + math.pi / 2, beta, False),
        (north + math.pi / 2, beta + math.pi, True),
        (north - math.pi / 2, beta, False),
        (north - math.pi / 2, beta + math.pi, True),
    )[:count]
    log = fog_north_rows(fog, north=north, latitude=math.radians(35), readings=readings, rng=None)
    path = tmp_path / "rows.csv"
    path.write_text(log.csv())
    return str(path)


def test_north_needs_latitude_and_approximate_north_each_its_own_problem(tmp_path: Path) -> None:
    refused = surveyapp("north", north_log(tmp_path, 4), "--method", "fog-station", "--json")
    assert refused.code == 2
    places = [p["where"] for p in json.loads(refused.out)["problems"]]
    assert places == ["--latitude", "--approximate-north-deg"]


def test_north_by_four_and_by_two_positions(tmp_path: Path) -> None:
    base = ("--method", "fog-station", "--latitude", "35", "--approximate-north-deg", "120",
            "--rate-sigma-deg-h", "0.05", "--json")  # fmt: skip
    four = surveyapp("north", north_log(tmp_path, 4), *base)
    found = json.loads(four.out)
    assert four.code == 0
    assert found["schema"] == "surveyapp.north/1"
    assert found["gyro_north"]["deg"] == pytest.approx(123.0, abs=1e-5)
    assert found["gyro_north"]["reference"] == "ASTRONOMIC"
    assert found["gyro_north"]["sigma_arcsec"] == pytest.approx(418.5, abs=1.0)
    assert {p["name"] for p in found["parameters"]} == {"bias", "elevation", "collimation"}
    two = surveyapp(
        "north", north_log(tmp_path, 2), *base,
        "--constant-deg", f"{math.degrees(PUBLISHED_CONSTANT):.9f}",
        "--constant-sigma-arcsec", "5",
    )  # fmt: skip
    found = json.loads(two.out)
    assert two.code == 1
    assert found["gyro_north"]["deg"] == pytest.approx(123.0, abs=1e-5)
    assert found["undetermined"] == ["bias", "collimation"]
    refused = surveyapp("north", north_log(tmp_path, 4), *base, "--declination", "3")
    assert refused.code == 2
    assert json.loads(refused.out)["problems"][0]["where"] == "--declination"


def test_spectrum_of_a_record_in_counts_and_its_magnetic_budget(tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    t = np.arange(6000) / 100.0
    rows = ["time_s,DX,DY"]
    wave = 5.0 * np.cos(2 * np.pi * 12.48 * np.outer([1, 2, 3], t)).sum(axis=0)
    for k, (a, b) in enumerate(rng.normal(0.0, 10.0, (t.size, 2))):
        rows.append(f"{t[k]:.2f},{round(a + wave[k])},{round(b)}")
    path = tmp_path / "on.csv"
    path.write_text("\n".join(rows) + "\n")
    done = surveyapp(
        "spectrum", str(path), "--column", "DX", "--field-uT", "50", "--sensitivity", "1e4",
        "--json",
    )  # fmt: skip
    found = json.loads(done.out)
    assert done.code == 0
    assert found["families"][0]["harmonics"] == [1, 2, 3]
    found["magnetic"]["bias_deg_h"] = round(found["magnetic"]["bias_deg_h"], 12)
    assert found["magnetic"] == {
        "field_uT": 50.0, "sensitivity_deg_h_t": 1e4, "shielding": 1.0, "bias_deg_h": 0.5,
    }  # fmt: skip
    clean = json.loads(surveyapp("spectrum", str(path), "--column", "DY", "--json").out)
    assert clean["lines"] == []
    wrong = surveyapp("spectrum", str(path), "--column", "DQ", "--json")
    assert wrong.code == 2


def test_a_single_node_keeps_its_values_and_its_json_has_no_nan(
    projects: Path, tmp_path: Path
) -> None:
    log = (projects / "chamber" / "sensors" / "temperature.csv").read_text().splitlines()
    column = log[0].split(",").index("reference_temperature_c")
    rows = [row for row in log[1:] if float(row.split(",")[column]) == 20.0]
    path = tmp_path / "one.csv"
    path.write_text("\n".join([log[0], *rows]) + "\n")
    done = surveyapp(
        "calibrate", "rate", path, "--programme", "temperature", "--latitude", "45.77", "--json"
    )
    assert done.code == 1
    bias = next(p for p in done.json["parameters"] if p["name"] == "bias_x")
    assert bias["value"] == pytest.approx(5.0, abs=0.5)
