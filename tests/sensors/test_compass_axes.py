"""Exchanged axes are found by gravity, counts and other units are refused, and a turn is found."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from surveyapp import api
from surveyapp.cli.main import main
from surveyapp.core.sensors.compass_axes import check_axes, refuse_mirrored
from surveyapp.domain.sensor_log import SensorLog
from surveyapp.errors import SurveyError
from surveyapp_models.arrays import Floats
from surveyapp_models.compass.heading import level_field, tilted
from tests.cli.command import run


def turned_log(
    seed: int, *, span: float, soft: float, order: tuple[int, ...] = (0, 1, 2)
) -> SensorLog:
    """A compass turned under tilts of up to ``span`` [rad]; acc in another order."""
    rng = np.random.default_rng([seed, 6])
    n = 300
    psi, pitch, roll = rng.uniform(0, 6.3, n), *rng.uniform(-span, span, (2, n))
    field = tilted(level_field(psi, size=50.0, dip=math.radians(65)), pitch=pitch, roll=roll)
    force = tilted(np.tile([0.0, 0.0, 9.81], (n, 1)), pitch=pitch, roll=roll)
    iron = rng.normal(0.0, soft, (3, 3))
    mag = field @ (np.eye(3) + (iron + iron.T) / 2) + rng.normal(0, 12, 3)
    mag += rng.normal(0, 0.3, mag.shape)
    force = (force + rng.normal(0, 0.02, force.shape))[:, list(order)]
    columns = {f"mag_{a}_uT": mag[:, i] for i, a in enumerate("xyz")}
    columns |= {f"acc_{a}_m_s2": force[:, i] for i, a in enumerate("xyz")}
    return SensorLog("c", columns, {}, n, rate_hz=20.0)


@pytest.mark.parametrize("span", [0.035, 0.17, 1.5])
def test_axes_that_agree_are_never_refused(span: float) -> None:
    for seed in range(12):
        for soft in (0.0, 0.06, 0.15):
            check_axes(turned_log(seed, span=span, soft=soft))


@pytest.mark.parametrize("order", [(2, 1, 0), (1, 0, 2), (1, 2, 0)])
def test_exchanged_axes_are_refused_and_the_arrangement_that_fits_is_told(
    order: tuple[int, ...],
) -> None:
    for seed in range(6):
        with pytest.raises(SurveyError) as caught:
            check_axes(turned_log(seed, span=1.0, soft=0.06, order=order))
        back = ", ".join("xyz"[order.index(i)] for i in range(3))
        assert f"acc ({back}) for (x, y, z)" in caught.value.problems[0].expected


def test_forces_of_something_else_are_a_warning() -> None:
    log = turned_log(1, span=1.0, soft=0.0)
    rng = np.random.default_rng(3)
    columns = {**log.columns, **{f"acc_{a}_m_s2": rng.normal(0, 6, log.size) for a in "xyz"}}
    (told,) = check_axes(SensorLog("c", columns, {}, log.size))
    assert told.code == "acc_does_not_fit"


def test_a_heading_that_runs_backwards_is_refused() -> None:
    known: Floats = np.radians(np.arange(0.0, 360.0, 5.0))
    refuse_mirrored(known, known + 0.3 + 0.4 * np.sin(known), "swing")
    with pytest.raises(SurveyError, match="runs against"):
        refuse_mirrored(known, 1.0 - known, "swing")


def written(path: Path, names: str, table: Floats) -> Path:
    np.savetxt(path, table, delimiter=",", header=names, comments="", fmt="%.9g")
    return path


def test_whole_numbers_need_a_unit_unless_their_name_states_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = turned_log(4, span=1.5, soft=0.0)
    counts = np.round(7.0 * np.column_stack([log.columns[f"mag_{a}_uT"] for a in "xyz"]))
    table = np.column_stack([np.arange(log.size) / 20.0, counts])
    path = written(tmp_path / "c.csv", "time_s,mx,my,mz", table)
    mapped = ["--map", "mag_x_uT=mx", "mag_y_uT=my", "mag_z_uT=mz"]
    assert main(["calibrate", "compass", str(path), *mapped, "--json"]) == 2
    problems = json.loads(capsys.readouterr().out)["problems"]
    assert [p["what"] for p in problems] == [f"mag_{a}_uT is counts without a unit" for a in "xyz"]
    scaled = [f"m{a}=0.142857" for a in "xyz"]
    assert main(["calibrate", "compass", str(path), *mapped, "--scale", *scaled]) == 0
    names = "time_s,mag_x_uT,mag_y_uT,mag_z_uT"
    assert main(["calibrate", "compass", str(written(tmp_path / "c.csv", names, table))]) == 2
    table[:, 1:] = np.round(table[:, 1:] / 7.0)
    assert main(["calibrate", "compass", str(written(tmp_path / "n.csv", names, table))]) == 0


def test_one_axis_in_milligauss_is_refused(tmp_path: Path) -> None:
    log = turned_log(5, span=1.5, soft=0.02)
    mag = np.column_stack([log.columns[f"mag_{a}_uT"] for a in "xyz"]) * [10.0, 1.0, 1.0]
    table = np.column_stack([np.arange(log.size) / 20.0, mag])
    path = written(tmp_path / "m.csv", "time_s,mag_x_uT,mag_y_uT,mag_z_uT", table)
    with pytest.raises(SurveyError, match="different units"):
        api.calibrate("compass", path)


def test_a_tilt_axis_in_minutes_and_a_gap_in_the_temperature_are_refused(tmp_path: Path) -> None:
    rng = np.random.default_rng(7)
    own = rng.uniform(-600, 600, (60, 2))
    theta = 20.0 + np.sin(np.arange(60) / 5.0)
    names = "time_s,tilt_along_arcsec,tilt_across_arcsec,ref_along_arcsec,ref_across_arcsec"
    time = 20.0 * np.arange(60.0)
    for factor, gap, text in ((1 / 60, False, "another unit"), (1.0, True, "temperature_c is not")):
        reading = own * [factor, 1.0] + rng.normal(0, 1, own.shape) * [factor, 1.0]
        shown = np.where((np.arange(60) == 7) & gap, np.nan, theta)
        table = np.column_stack([time, reading, own, shown])
        path = written(tmp_path / "t.csv", f"{names},temperature_c", table)
        with pytest.raises(SurveyError, match=text):
            api.calibrate("tilt", path)


def test_a_turned_sensor_is_calibrated_diagnosed_and_undone(tmp_path: Path) -> None:
    made = api.simulate("compass", tmp_path / "c", seed=3, effects=["misalignment=12"])
    found = api.calibrate("compass", made.folder, sensor="compass", card=tmp_path / "card.toml")
    assert [m.id for m in found.models if m.chosen] == ["misalignment"]
    # drawn as a turn of +12 degrees of the axes: the field in them turns by -12 about z
    for name, truth in (
        ("misalignment_x", 0.0),
        ("misalignment_y", 0.0),
        ("misalignment_z", -12.0),
    ):
        item = found.parameter(name)
        assert item.value is not None
        assert item.sigma is not None
        assert abs(item.value - truth) < 4.0 * item.sigma
    held = found.to_dict()["attitude"]
    assert held["held_out_after"] < 0.6 < 8.0 < held["held_out_before"]
    document = api.diagnose_log(made.folder).to_dict()
    (named,) = document["adopted"]
    assert named["effect"] == "misalignment"
    assert named["grid"] == []
    assert abs(named["coefficients"][2]["value"] + 12.0) < 0.1
    # three axes of 0.3 uT, row by row and not as means of blocks
    assert document["after"]["rms"] == pytest.approx(0.3 * math.sqrt(3.0), rel=0.05)
    out = tmp_path / "out.csv"
    log = Path(made.folder) / "sensors" / "compass.csv"
    assert main(["compensate", "compass", str(log), "--card", str(tmp_path / "card.toml"),
                 "-o", str(out)]) == 0  # fmt: skip
    level = [
        matrix @ row
        for matrix, row in zip(
            _attitudes(log),
            np.genfromtxt(out, delimiter=",", names=True)[_MAG].tolist(),
            strict=True,
        )
    ]
    assert np.allclose(np.mean(level, axis=0), [21.131, 0.0, -45.315], atol=0.05)


_MAG = ["mag_x_uT", "mag_y_uT", "mag_z_uT"]


def _attitudes(log: Path) -> Floats:
    """Rotation matrices of the reference attitude, written out once more."""
    table = np.genfromtxt(log, delimiter=",", names=True)
    w, x, y, z = (table[f"ref_q{a}"] for a in "wxyz")
    rows = [
        [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
    ]
    return np.moveaxis(np.array(rows), 2, 0)


def test_without_a_turn_the_model_is_not_chosen(tmp_path: Path) -> None:
    made = api.simulate("compass", tmp_path / "c", seed=5, effects=["hard_iron=12"])
    found = api.calibrate("compass", made.folder, sensor="compass")
    assert [m.id for m in found.models if m.chosen] == ["centre"]
    assert [m.id for m in found.models] == ["none", "centre", "scales", "full", "misalignment"]
    assert [m.of for m in found.models[:-1]] == ["distance from the ellipsoid"] * 4
    assert found.models[-1].of.startswith("vector of the field in the level frame; ")
    assert {m.unit for m in found.models} == {"uT"}
    shown = run("calibrate", "compass", made.folder, "--sensor", "compass").out
    assert "held out  unit  of" in shown
    turn = [found.parameter(f"misalignment_{a}") for a in "xyz"]
    assert [(t.value, t.sigma) for t in turn] == [(0.0, None)] * 3


def test_five_rows_for_four_parameters_are_told(tmp_path: Path) -> None:
    rng = np.random.default_rng(2)
    own = rng.uniform(-600, 600, (30, 2))
    table = np.column_stack(
        [np.arange(30), own + rng.normal(0, 1, (30, 2)), own, rng.uniform(10, 30, 30)]
    )
    names = "time_s,tilt_along_arcsec,tilt_across_arcsec,ref_along_arcsec,ref_across_arcsec"
    names += ",temperature_c"
    few = api.calibrate("tilt", written(tmp_path / "few.csv", names, table[:5]))
    text = next(w.text for w in few.warnings if w.code == "few_rows")
    assert "few degrees of freedom, 1" in text
    assert "13 sigma" in text
    whole = api.calibrate("tilt", written(tmp_path / "whole.csv", names, table))
    assert "few_rows" not in [w.code for w in whole.warnings]
