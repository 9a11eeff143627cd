"""What a log says of its table and its units: encoder, nominal rate, circles; and what is refused.

Truth is rotation matrices of this file: the table about the vertical, the earth rate in east,
north, up.
"""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from surveyapp.core.sensors.rate.fog_station_log import calibrate_fog_station
from surveyapp.core.sensors.rate.six_position_log import (
    SixPositionOptions,
    calibrate_six_positions,
)
from surveyapp.domain.calibration import Calibration
from surveyapp.domain.sensor_log import SensorLog
from surveyapp.errors import SurveyError
from surveyapp_models.arrays import Floats
from tests.cli.command import run as surveyapp

DEG = math.radians(1.0)
DEG_H = DEG / 3600.0
LATITUDE = 45.77 * DEG
EARTH = 7.292115e-5
BIAS = np.array([5.0, -3.0, 2.0]) * DEG_H
MATRIX = np.eye(3) + np.array([[3e-4, 1e-3, -5e-4], [2e-4, -2e-4, 4e-4], [-1e-4, 3e-4, 5e-4]])
STEP_S = 0.1


def body(position: str, angle: Floats) -> Floats:
    """Body to east, north, up with that axis up or down, turned clockwise, shape (n, 3, 3)."""
    mount = np.zeros((3, 3))
    sign = 1.0 if position[1] == "+" else -1.0
    k = "xyz".index(position[0])
    mount[2, k], mount[0, (k + 1) % 3], mount[1, (k + 2) % 3] = sign, sign, 1.0
    cos, sin = np.cos(angle), np.sin(angle)
    zero, one = np.zeros_like(cos), np.ones_like(cos)
    turn = np.array([[cos, sin, zero], [-sin, cos, zero], [zero, zero, one]])
    return np.asarray(np.moveaxis(turn, 2, 0) @ mount)


def table_log(
    *, true_share: float = 1.0, turns: float = 1.6, hole: tuple[float, float] | None = None
) -> SensorLog:
    """Six positions at a nominal 20 deg/s that is really ``true_share`` of it.

    ``hole`` are the seconds without samples in each turning.
    """
    columns: dict[str, list[Floats]] = {}
    words: list[str] = []
    begin, angle = 0.0, 0.4
    for position in ("x+", "x-", "y+", "y-", "z+", "z-"):
        for nominal in (0.0, 20.0, 0.0, -20.0):
            seconds = turns * 18.0 if nominal else 3.0
            time = np.arange(0.0, seconds, STEP_S)
            true = nominal * true_share * DEG
            angles = angle + true * time
            earth = EARTH * np.array([0.0, math.cos(LATITUDE), math.sin(LATITUDE)])
            rates = np.tile(earth, (time.size, 1))
            rates[:, 2] -= true
            turned = body(position, angles)
            seen = np.einsum("nij,ni->nj", turned, rates) @ MATRIX.T + BIAS
            keep = np.ones(time.size, dtype=bool)
            if hole is not None and nominal:
                keep = (time < hole[0]) | (time >= hole[1])
            part = {f"gyr_{a}_rad_s": seen[keep, i] for i, a in enumerate("xyz")}
            part |= {
                "time_s": begin + time[keep],
                "table_rate_deg_s": np.full(int(keep.sum()), nominal),
                "table_angle_deg": np.rad2deg(angles[keep]) % 360.0,
            }
            for name, values in part.items():
                columns.setdefault(name, []).append(values)
            words += [position] * int(keep.sum())
            begin += time.size * STEP_S
            angle = float(angles[-1]) + true * STEP_S
    whole = {name: np.concatenate(parts) for name, parts in columns.items()}
    return SensorLog(
        id="log", columns=whole, units=dict.fromkeys(whole, "1"), size=len(words),
        texts={"position": tuple(words)}, rate_hz=1.0 / STEP_S, path="log.csv",
    )  # fmt: skip


def changed(log: SensorLog, without: str = "", /, **factors: float) -> SensorLog:
    """The log with columns times a factor, or without one."""
    columns = {n: v * factors.get(n, 1.0) for n, v in log.columns.items() if n != without}
    return replace(log, columns=columns)


def calibrated(log: SensorLog, relative: float = 0.0) -> Calibration:
    return calibrate_six_positions(log, SixPositionOptions(relative_rate_sigma=relative))


def bias_error(found: Calibration) -> float:
    """Largest error of a bias [deg/h]."""
    shown = np.array([found.value(f"bias_{a}") or math.nan for a in "xyz"])
    return float(np.abs(shown - BIAS / DEG_H).max())


def codes(found: Calibration) -> list[str]:
    return [w.code for w in found.warnings]


def test_whole_turns_are_those_of_the_encoder_and_a_rate_that_is_off_is_told() -> None:
    """The table runs 4 % fast: .98 turns by its rate are 1.019 by its angle."""
    log = table_log(true_share=1.04, turns=0.98)
    found = calibrated(log)
    assert found.met
    assert bias_error(found) < 1e-6
    told = next(w for w in found.warnings if w.code == "encoder_contradicts_rate")
    assert "+0.04" in told.text
    assert "encoder_contradicts_rate" not in codes(calibrated(log, relative=0.02))
    by_rate = calibrated(changed(log, "table_angle_deg"))
    assert by_rate.geometry.undetermined == ("bias_x", "bias_y", "bias_z")
    by_angle = calibrated(changed(log, "table_rate_deg_s"))
    assert by_angle.value("scale_factor_x") == pytest.approx(300.0, abs=0.5)
    assert "encoder_contradicts_rate" not in codes(calibrated(table_log()))


def test_a_hole_of_most_of_a_turn_is_gone_through_by_the_nominal_rate() -> None:
    """14 s without samples are 280 degrees: the shorter way round would be 80 degrees back."""
    found = calibrated(table_log(turns=3.0, hole=(20.0, 34.0)))
    assert bias_error(found) < 0.01
    assert found.value("misalignment_xy") == pytest.approx(1e-3 / 1.0003 / DEG * 3600.0, abs=0.05)
    used = [s["turns_used"] for s in found.extra["steps"] if s["step"] == "segment"]
    assert set(used) == {1}


def test_an_encoder_that_counts_the_other_way_or_stands_still_is_told() -> None:
    log = table_log()
    other = replace(
        log, columns={**log.columns, "table_angle_deg": -log.columns["table_angle_deg"]}
    )
    found = calibrated(other)
    assert found.value("scale_factor_y") == pytest.approx(-200.0, abs=0.5)
    told = [w.text for w in found.warnings if w.code == "sense_of_rotation"]
    assert len(told) == 1
    assert told[0].startswith("table_angle_deg counts anticlockwise")
    still = calibrated(changed(log, table_angle_deg=0.0))
    assert "encoder_stands_still" in codes(still)
    assert bias_error(still) < 0.01


def test_units_that_contradict_each_other_are_refused() -> None:
    log = table_log()
    gyros = dict.fromkeys((f"gyr_{a}_rad_s" for a in "xyz"), math.degrees(1.0))
    with pytest.raises(SurveyError, match="another unit") as error:
        calibrated(changed(log, **gyros))
    assert "deg/s" in error.value.problems[0].hint
    with pytest.raises(SurveyError, match="contradict each other"):
        calibrated(changed(log, table_rate_deg_s=DEG))
    fog = {"gyr_x_rad_s": log.columns["gyr_z_rad_s"]}
    tilted = replace(log, columns={**log.columns, **fog}, texts={})
    with pytest.raises(SurveyError, match="near the horizontal"):
        calibrate_fog_station(tilted, rule="increases", relative_rate_sigma=None, problems=[])


def test_a_gyro_that_counts_the_other_way_is_not_called_a_wrong_position() -> None:
    with pytest.raises(SurveyError, match="sense of rotation") as error:
        calibrated(changed(table_log(), gyr_y_rad_s=-1.0))
    assert [p.hint[:24] for p in error.value.problems] == ["does this gyro count the"]


def test_a_run_up_alone_between_two_breaks_is_no_steady_turning() -> None:
    log = table_log()
    rates = log.columns["table_rate_deg_s"].copy()
    rates[2:12] = np.linspace(1.0, 19.0, 10)
    words = ["" if k < 12 else w for k, w in enumerate(log.texts["position"])]
    ramp = replace(
        log, columns={**log.columns, "table_rate_deg_s": rates}, texts={"position": tuple(words)}
    )
    assert bias_error(calibrated(changed(ramp, "table_angle_deg"))) < 0.01


def test_smoothed_noise_holds_no_earth_rate() -> None:
    """10.5 deg/h coming round once in 18 s would be 2 deg/h from second to second."""
    found = calibrated(table_log())
    (step,) = [s for s in found.extra["steps"] if s["step"] == "smoothing"]
    assert max(step["sd_smoothed_deg_h"]) < 1e-6


def test_all_that_is_wrong_with_options_and_log_comes_together(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text("time_s,gyr_x_rad_s,gyr_y_rad_s,gyr_z_rad_s\n0,1e-3,2e-3,1e-3\n1,1e-3,0,0\n")
    refused = surveyapp(
        "calibrate", "rate", path, "--programme", "temperature", "--latitude", "95",
        "--gravity-m-s2", "-9.8", "--flip-sigma-arcsec", "-1", "--predict-at", "x",
        "--room", "no.csv", "--json",
    )  # fmt: skip
    assert refused.code == 2
    told = [p["what"] for p in refused.json["problems"]]
    assert told[:5] == [
        "this is no latitude",
        "this is no temperature",
        "the log does not exist",
        "this is no gravity on the earth",
        "a sigma is negative",
    ]
    assert "the column position is missing" in told


@pytest.mark.parametrize(
    ("row", "what"),
    [
        ("0.5,213.4,171.1,L", "the positions differ by more than the earth turns"),
        ("1e-5,413.4,171.1,L", "horizontal_circle_deg is no reading of a circle"),
        ("1e-5,213.4,-181,L", "vertical_circle_deg is no reading of a circle"),
    ],
)
def test_rates_and_circles_that_none_has_are_refused(tmp_path: Path, row: str, what: str) -> None:
    path = tmp_path / "log.csv"
    rows = ["2e-5,213.4,351.1,R", "-1e-5,33.4,171.1,L", "-2e-5,33.4,351.1,R", row]
    path.write_text(
        "gyr_x_rad_s,horizontal_circle_deg,vertical_circle_deg,face\n" + "\n".join(rows) + "\n"
    )
    refused = surveyapp(
        "north", path, "--method", "fog-station", "--latitude", "35", "--approximate-north-deg",
        "120", "--json",
    )  # fmt: skip
    assert refused.code == 2
    assert [p["what"] for p in refused.json["problems"]] == [what]
