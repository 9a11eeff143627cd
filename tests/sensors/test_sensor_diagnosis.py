"""The loop on sensor logs: simulated truth, correlated noise as a rival, measured records."""

import json
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.signal import lfilter

from bench.sensor_loop import found_in
from bench.sensor_rooms import beside_a_dipole
from surveyapp import api
from surveyapp.api.sensors import LogOptions
from surveyapp.cli.main import main
from surveyapp.diagnosis.sensors.records import gross_rows
from surveyapp.diagnosis.sensors.room import harmonic_fields
from surveyapp.errors import SurveyError

SHARED = Path(os.environ.get("SURVEYAPP_DATA", Path(__file__).parents[2] / "../shared/data"))
BROAD = SHARED / "broad_magnetometer"


def diagnosed(tmp_path: Path, kind: str, *effects: str, seed: int = 1) -> tuple[Any, Any]:
    made = api.simulate(kind, tmp_path / f"{kind}{seed}", effects=effects, seed=seed)
    truth = json.loads(Path(made.truth).read_text())
    return api.diagnose_log(made.folder).to_dict(), truth


def named(document: Any) -> set[str]:
    return {item["effect"] for item in document["adopted"]}


def coefficients(document: Any, effect: str) -> dict[str, Any]:
    item = next(a for a in document["adopted"] if a["effect"] == effect)
    return {c["name"]: c["value"] for c in item["coefficients"]}


@pytest.mark.statistical
def test_a_clean_log_names_nothing(tmp_path: Path) -> None:
    for seed in range(3):
        for kind in ("compass", "tilt"):
            document, _ = diagnosed(tmp_path, kind, seed=seed)
            assert document["verdict"] == "adequate"
            assert document["adopted"] == []


@pytest.mark.parametrize(
    ("kind", "effects"),
    [
        ("compass", ("hard_iron=12",)),
        ("compass", ("hard_iron=12", "soft_iron=6")),
        ("compass", ("temperature=.5",)),
        ("compass", ("gross_error=10",)),
        ("tilt", ("cross_axis=2",)),
        ("tilt", ("temperature=1", "cross_axis=2")),
        ("tilt", ("scale_nonlinearity=4",)),
        ("tilt", ("warm_up=6",)),
        ("tilt", ("gross_error=20",)),
    ],
    ids=lambda v: "+".join(v) if isinstance(v, tuple) else v,
)
def test_each_effect_is_named(tmp_path: Path, kind: str, effects: tuple[str, ...]) -> None:
    document, _ = diagnosed(tmp_path, kind, *effects, seed=2)
    assert named(document) == {effect.split("=")[0] for effect in effects}
    assert document["verdict"] == "explained"
    held = document["held_out"]
    assert held["after"] <= held["before"]
    if kind == "tilt":
        assert 0.8 < held["after"] < 1.25


@pytest.mark.parametrize("seed", [3, 4])
def test_a_switch_is_found_with_its_times_beside_a_constant_iron(tmp_path: Path, seed: int) -> None:
    """Both times lie within a block: a temperature was named beside it for what that block left."""
    switch = "interference_step=15,on=40.1,off=78.35"
    document, truth = diagnosed(tmp_path, "compass", switch, "hard_iron=10", seed=seed)
    assert named(document) == {"interference_step", "hard_iron"}
    step = next(e for e in truth["effects"] if e["effect"] == "interference_step")
    found = coefficients(document, "interference_step")
    assert abs(found["on_s"] - step["on_s"]) < 0.2
    assert abs(found["off_s"] - step["off_s"]) < 0.2
    assert [found[f"step_{a}"] for a in "xyz"] == pytest.approx(step["uT"], abs=0.3)


def test_a_switch_that_stays_on_has_no_time_of_switching_off(tmp_path: Path) -> None:
    document, _ = diagnosed(tmp_path, "compass", "interference_step=6,on=40,off=999")
    found = coefficients(document, "interference_step")
    assert abs(found["on_s"] - 40.0) < 0.2
    assert found["off_s"] is None


@pytest.mark.statistical
@pytest.mark.parametrize("walk", [False, True], ids=["ar1", "random_walk"])
def test_correlated_noise_is_not_named(tmp_path: Path, walk: bool) -> None:
    """At most .08 of 200 records in ``python -m bench sensor_loop``; of 4, two have p = .03."""
    wrong = 0
    for seed in range(4):
        made = api.simulate("compass", tmp_path / f"n{seed}", seed=seed)
        path = Path(made.folder) / "sensors/compass.csv"
        head, rest = path.read_text().split("\n", 1)
        table = np.loadtxt(rest.splitlines(), delimiter=",")
        rng = np.random.default_rng(seed + 50)
        for axis in (1, 2, 3):
            if walk:
                noise = np.cumsum(rng.normal(size=len(table)))
                noise *= 6.0 / np.ptp(noise)
            else:
                noise = lfilter([0.1], [1.0, -0.95], rng.normal(size=len(table)))
            table[:, axis] += noise
        np.savetxt(path, table, delimiter=",", header=head, comments="", fmt="%.9g")
        wrong += bool(api.diagnose_log(made.folder).to_dict()["adopted"])
    assert wrong <= 1


def near_level(n: int = 1600) -> tuple[np.ndarray, np.ndarray]:
    """A carrier under slow tilts: its quaternions, w first, and its vertical in its own axes."""
    t = np.arange(n) / 20.0
    c, s = np.cos(0.15 * np.sin(0.3 * t)), np.sin(0.15 * np.sin(0.3 * t))
    d, e = np.cos(0.15 * np.sin(0.21 * t)), np.sin(0.15 * np.sin(0.21 * t))
    q = np.column_stack([c * d, c * e, s * d, -s * e])  # about y, then about x
    w, x, y, z = q.T
    up = np.column_stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)])
    return q, up


@pytest.mark.parametrize(("size", "told"), [(2.8, set()), (9.0, {"interference_step"})])
def test_a_small_switch_is_not_told_from_a_change_of_place(
    tmp_path: Path, size: float, told: set[str]
) -> None:
    """Lifted in the gradient of a room, the field of a level carrier changes as by a switch."""
    q, up = near_level()
    n = len(q)
    level = np.array([20.0, 0.0, -45.0])
    w, x, y, z = q.T
    north = np.column_stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)])
    mag = level[0] * north + level[2] * up + np.random.default_rng(3).normal(0.0, 0.3, (n, 3))
    time = np.arange(n) / 20.0
    mag += size * ((time > 24.0) & (time < 56.0))[:, None] * up
    path = tmp_path / "c.csv"
    np.savetxt(
        path, np.column_stack([time, mag, q]), delimiter=",", comments="", fmt="%.9g",
        header="time_s,mag_x_uT,mag_y_uT,mag_z_uT,ref_qw,ref_qx,ref_qy,ref_qz",
    )  # fmt: skip
    document = api.diagnose_log(path).to_dict()
    assert named(document) == told
    if not told:
        assert document["verdict"] == "not_separable"
        assert "field_gradient" in str(document["ambiguous"])


def test_the_command_and_what_it_refuses(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = api.simulate("tilt", tmp_path / "t", effects=["cross_axis=2"]).folder
    assert main(["diagnose", folder, "--sensor", "tilt", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["schema"] == "surveyapp.diagnose/1"
    for key in ("verdict", "adopted", "ambiguous", "candidates", "before", "after", "after_best",
                "averaged", "remedy", "held_out", "warnings", "words", "written"):  # fmt: skip
        assert key in document
    assert main(["diagnose", folder, "--sensor", "tilt"]) == 0
    assert "cross axis" in capsys.readouterr().out
    assert main(["diagnose", folder, "--sensor", "tilt", "--session", "A"]) == 2
    assert main(["diagnose", folder, "--sensor", "other"]) == 2
    assert "other" in capsys.readouterr().err


@pytest.mark.shared_data
@pytest.mark.skipif(not BROAD.exists(), reason="measured records are not there")
def test_the_magnet_of_broad_33_is_found_with_its_times() -> None:
    path = BROAD / "33_disturbed_attached_magnet_2cm_20Hz.csv"
    document = api.diagnose_log(path, log=LogOptions(columns={"time_s": "t_s"})).to_dict()
    assert "interference_step" in named(document)
    assert "hard_iron" not in named(document)
    found = coefficients(document, "interference_step")
    assert abs(found["on_s"] - 42.4) < 1.0
    assert abs(found["off_s"] - 98.6) < 1.0
    assert document["before"]["rms"] == pytest.approx(15.4, abs=0.1)
    assert document["held_out"]["after"] < 3.1
    assert document["size_rms_uT"]["before"] == pytest.approx(8.50, abs=0.01)
    assert document["size_rms_uT"]["after"] < 1.3
    assert document["heading_rms_deg"]["after"] < 9.0


@pytest.mark.shared_data
@pytest.mark.skipif(not BROAD.exists(), reason="measured records are not there")
def test_the_room_of_broad_01_needs_the_place(tmp_path: Path) -> None:
    path = BROAD / "01_undisturbed_slow_rotation_A_20Hz.csv"
    options = LogOptions(columns={"time_s": "t_s"})
    whole = api.diagnose_log(path, log=options).to_dict()
    assert "field_gradient" in named(whole)
    assert "interference_step" not in named(whole)
    assert whole["size_rms_uT"]["before"] == pytest.approx(1.53, abs=0.01)
    assert whole["size_rms_uT"]["after"] == pytest.approx(0.76, abs=0.01)
    lines = path.read_text().splitlines()
    bare = tmp_path / "bare.csv"
    bare.write_text("\n".join(",".join(line.split(",")[:10]) for line in lines) + "\n")
    document = api.diagnose_log(bare, log=options).to_dict()
    assert document["verdict"] == "not_separable"
    assert document["adopted"] == []


@pytest.mark.shared_data
@pytest.mark.skipif(not SHARED.exists(), reason="measured records are not there")
def test_a_calibrated_magnetometer_adopts_nothing(tmp_path: Path) -> None:
    data = np.load(SHARED / "vqf_imu/imu_data.npz")
    time = np.arange(len(data["mag"])) / float(data["sampling_rate"])
    path = tmp_path / "vqf.csv"
    np.savetxt(
        path, np.column_stack([time, data["mag"]]), delimiter=",", comments="", fmt="%.7g",
        header="time_s,mag_x_uT,mag_y_uT,mag_z_uT",
    )  # fmt: skip
    assert api.diagnose_log(path).to_dict()["adopted"] == []


@pytest.mark.statistical
@pytest.mark.parametrize(
    ("motion", "seed", "distance"), [("lifted", 1, 0.6), ("lifted", 2, 1.5), ("walked", 1, 0.6)]
)
def test_a_bent_room_is_not_named_a_switch(motion: str, seed: int, distance: float) -> None:
    """Of a dipole's field the gradient leaves what looks switched: .31 to .81 of the records."""
    document = found_in(beside_a_dipole(motion, seed, 4.0, distance), "compass").document
    assert {item["effect"] for item in document["adopted"]} <= {"field_gradient"}


def test_harmonic_fields_have_no_sources_and_no_currents() -> None:
    """2 l + 1 solid harmonics of each degree (Maxwell: zero divergence, symmetric gradient)."""
    place = np.random.default_rng(1).normal(size=(4, 3))
    step = 1e-5
    for degree in range(1, 5):
        slopes = [
            (harmonic_fields(place + step * e, degree) - harmonic_fields(place - step * e, degree))
            / (2.0 * step)
            for e in np.eye(3)
        ]
        gradient = np.stack(slopes, axis=-1)  # place, component, shape, direction
        assert gradient.shape[2] == 2 * degree + 3
        assert np.abs(np.einsum("pidi->pd", gradient)).max() < 1e-8
        assert np.abs(gradient - gradient.transpose(0, 3, 2, 1)).max() < 1e-8


def test_wrong_readings_beside_each_other_are_gross_and_a_switch_is_none() -> None:
    """Two in a row, and two about a good one, passed for a switch of two seconds."""
    rng = np.random.default_rng(3)
    residual = rng.normal(0.0, 0.5, (1000, 3))
    residual[600:] += [8.0, -6.0, 5.0]
    residual[[100, 300, 301, 500, 502]] += [[20.0, -18.0, 22.0]] * 5
    residual[301] *= -1.0
    assert [row for row, _ in gross_rows(residual)] == [100, 300, 301, 500, 502]

    assert gross_rows(residual[550:]) == []


def test_a_log_of_another_kind_confirms_nothing(tmp_path: Path) -> None:
    made = api.simulate("compass", tmp_path / "p", effects=("hard_iron=12",), seed=1)
    toml = Path(made.folder) / "project.toml"
    kind = '\n[[sensor_log]]\nid = "other"\nkind = "tilt"\nfile = "sensors/compass.csv"\n'
    toml.write_text(toml.read_text() + kind)
    with pytest.raises(SurveyError, match="another kind"):
        api.diagnose_log(made.folder, sensor="compass", confirm="other")
