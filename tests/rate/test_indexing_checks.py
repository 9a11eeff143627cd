"""An index log that contradicts itself is refused and told, from logs made with plain matrices."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from surveyapp_models.arrays import Floats
from tests.cli.command import run

POLE = 7.292115e-5
DEG_H = math.radians(1.0) / 3600.0
Columns = dict[str, Floats]


def about(axis: int, angle: float) -> Floats:
    """Right-handed rotation."""
    i, j = (axis + 1) % 3, (axis + 2) % 3
    found = np.eye(3)
    found[i, i] = found[j, j] = math.cos(angle)
    found[j, i], found[i, j] = math.sin(angle), -math.sin(angle)
    return found


def indexed(axis: int = 2, heading: float = 40.0) -> Columns:
    """Heading 40, pitch 5, roll 3 degrees at latitude 35; four positions of 30 s at 10 Hz."""
    rng = np.random.default_rng(5)
    h, p, r, lat = (math.radians(v) for v in (heading, 5.0, 3.0, 35.0))
    body = about(2, -h) @ about(0, p) @ about(1, r)
    earth = POLE * np.array([0.0, math.cos(lat), math.sin(lat)])
    blocks = []
    for k, angle in enumerate((0.0, 90.0, 180.0, 270.0)):
        back = (body @ about(axis, -math.radians(angle))).T
        rate = back @ earth + DEG_H * (np.array([3.0, -2.0, 5.0]) + 0.5 * rng.normal(size=(300, 3)))
        force = back @ np.array([0.0, 0.0, 9.80665]) + 0.01 * rng.normal(size=(300, 3))
        time = 35.0 * k + np.arange(300) / 10.0
        blocks.append(np.column_stack([time, rate, force, np.full(300, angle)]))
    names = ["time_s", *(f"gyr_{a}_rad_s" for a in "xyz"), *(f"acc_{a}_m_s2" for a in "xyz")]
    return dict(zip([*names, "index_angle_deg"], np.concatenate(blocks).T, strict=True))


def exchanged(first: str, second: str) -> Callable[[Columns], Columns]:
    """Two columns in each other's place."""
    return lambda c: {**c, first: c[second], second: c[first]}


def scaled(prefix: str, factor: float) -> Callable[[Columns], Columns]:
    """Columns times a number."""
    return lambda c: {k: v * factor if k.startswith(prefix) else v for k, v in c.items()}


def clipped(c: Columns) -> Columns:
    """A gyro at the end of its range in half of the rows."""
    x = c["gyr_x_rad_s"]
    return {**c, "gyr_x_rad_s": np.minimum(x, np.median(x))}


def turning(c: Columns) -> Columns:
    """No two rows of one index angle."""
    return {**c, "index_angle_deg": np.linspace(0.0, 360.0, c["time_s"].size)}


def found(folder: Path, columns: Columns, *more: str) -> tuple[int, Any]:
    """Exit code and JSON of the command."""
    path = folder / "log.csv"
    rows = np.column_stack(list(columns.values()))
    np.savetxt(path, rows, delimiter=",", header=",".join(columns), comments="", fmt="%.12g")
    words = ("north", str(path), "--method", "indexing", "--json", *more)
    outcome = run(*words, *([] if "--latitude" in more else ["--latitude", "35"]))
    return outcome.code, outcome.json


@pytest.mark.parametrize(
    ("change", "what", "expected"),
    [
        (exchanged("acc_x_m_s2", "acc_z_m_s2"), "accelerometers are exchanged", "acc (z, y, x)"),
        (exchanged("acc_x_m_s2", "acc_y_m_s2"), "accelerometers are exchanged", "acc (y, x, z)"),
        (exchanged("gyr_x_rad_s", "gyr_y_rad_s"), "gyros are exchanged", "gyr (y, x, z)"),
        (scaled("acc_y", -1.0), "accelerometers are exchanged", "(x, -y, z)"),
        (scaled("index", -1.0), "not turned as the log says", "clockwise about z"),
        (scaled("gyr", 57.3), "larger than the earth's", "15.04 deg/h"),
        (clipped, "gyr_x_rad_s is saturated", "range of the gyro"),
        (turning, "no index position at rest", "constant index_angle_deg"),
    ],
)
def test_what_gravity_and_the_earth_deny_is_refused(
    tmp_path: Path, change: Callable[[Columns], Columns], what: str, expected: str
) -> None:
    code, told = found(tmp_path, change(indexed()))
    assert code == 2
    problem = told["problems"][0]
    assert len(told["problems"]) == 1
    assert what in problem["what"]
    assert expected in problem["expected"]


@pytest.mark.parametrize("stated", ["x", "y"])
def test_another_index_axis_is_told(tmp_path: Path, stated: str) -> None:
    code, told = found(tmp_path, indexed(), "--index-axis", stated)
    assert code == 2
    assert "clockwise about z" in told["problems"][0]["found"]
    assert found(tmp_path, indexed("xyz".index(stated)), "--index-axis", stated)[0] == 0


def test_a_wrong_latitude_gives_no_heading(tmp_path: Path) -> None:
    """12.3 deg/h across a level index are not the 7.5 of latitude 60."""
    code, told = found(tmp_path, indexed(), "--latitude", "60")
    assert code == 1
    assert told["heading"]["deg"] is None
    assert any(w["code"] == "inconsistent" for w in told["warnings"])


def test_a_position_in_which_the_unit_shook_is_left_out(tmp_path: Path) -> None:
    """Its mean may be right and its noise says that it was not at rest."""
    c = indexed()
    c["acc_x_m_s2"][300:600] += 0.5 * np.sin(np.arange(300) / 5.0)
    code, told = found(tmp_path, c)
    assert (code, told["stops"]) == (0, 3)
    assert any(w["code"] == "motion_in_stop" for w in told["warnings"])
    assert told["heading"]["deg"] == pytest.approx(40.0, abs=0.3)


def test_coarse_digits_and_a_constant_gyro_along_the_index_are_at_rest(tmp_path: Path) -> None:
    """Digits of 4 deg/h over a noise of .5: in most rows of a position there is one value only."""
    c = indexed()
    for a in "xyz":
        c[f"gyr_{a}_rad_s"] = np.round(c[f"gyr_{a}_rad_s"] / (4.0 * DEG_H)) * (4.0 * DEG_H)
    c["gyr_z_rad_s"][:] = np.median(c["gyr_z_rad_s"])
    code, told = found(tmp_path, c)
    assert (code, told["stops"]) == (0, 4)
    assert told["heading"]["deg"] == pytest.approx(40.0, abs=12.0)


def test_the_biases_of_a_second_unit_hold_the_doubt_of_the_attitude(tmp_path: Path) -> None:
    """Without noise of its own what is left is the earth's rate times the sigma of the attitude."""
    columns = indexed()
    h, p, r, lat = (math.radians(v) for v in (40.0, 5.0, 3.0, 35.0))
    body = about(2, -h) @ about(0, p) @ about(1, r)
    rate = body.T @ (POLE * np.array([0.0, math.cos(lat), math.sin(lat)]))
    rest = np.column_stack([np.arange(50) / 10.0, *(np.outer(rate, np.ones(50)))])
    rest[::2, 1:] += 1e-12
    names = ",".join(["time_s", *(f"gyr_{a}_rad_s" for a in "xyz")])
    np.savetxt(tmp_path / "second.csv", rest, delimiter=",", header=names, comments="", fmt="%.15g")
    _, told = found(tmp_path, columns, "--second", str(tmp_path / "second.csv"))
    sigma = math.hypot(*(q["sigma"] for q in told["fixed_gyro"]["parameters"][:2]))
    heading = told["heading"]["sigma_arcsec"] / 3600.0
    assert sigma == pytest.approx(15.041 * math.cos(lat) * math.radians(heading), rel=0.2)
    for q in told["fixed_gyro"]["parameters"]:
        assert abs(q["value"]) < 4.0 * q["sigma"]


def test_sets_in_which_the_unit_stood_differently_are_followed(tmp_path: Path) -> None:
    """Two stops of a vehicle, turned by 110 degrees between: not one attitude for both."""
    first, second = indexed(), indexed(heading=150.0)
    both = {k: np.concatenate([v, second[k]]) for k, v in first.items()}
    both["time_s"] = np.concatenate([first["time_s"], first["time_s"] + 200.0])
    both["set"] = np.repeat([1.0, 2.0], first["time_s"].size)
    code, told = found(tmp_path, both)
    assert code == 0
    assert any(w["code"] == "sets_differ" for w in told["warnings"])
    assert told["heading"]["deg"] == pytest.approx(150.0, abs=0.3)
    assert [t["heading_deg"] for t in told["tracking"]] == pytest.approx([40.0, 150.0], abs=0.3)
    same = {**both, **{k: np.concatenate([v, v]) for k, v in first.items() if k != "time_s"}}
    assert found(tmp_path, same)[1]["tracking"] == []


@pytest.mark.parametrize(("rows", "quantile"), [(1, 2.3646), (300, 1.95996)])
def test_few_means_have_the_interval_of_their_degrees_of_freedom(
    tmp_path: Path, rows: int, quantile: float
) -> None:
    """Four positions of one row: 12 readings, 5 unknowns, t(.975, 7); samples tell their own."""
    whole = indexed()
    starts = [300 * k for k in range(4)]
    few = {
        name: np.array([np.mean(column[i : i + 300]) for i in starts]) if rows == 1 else column
        for name, column in whole.items()
    }
    path = tmp_path / "few.csv"
    np.savetxt(
        path, np.column_stack(list(few.values())), delimiter=",", header=",".join(few), comments=""
    )
    answer = run(
        "north", path, "--method", "indexing", "--latitude", "35", "--allow-outside", "--json"
    )
    heading = answer.json["heading"]
    assert heading["interval95_arcsec"] / heading["sigma_arcsec"] == pytest.approx(
        quantile, abs=1e-4
    )
