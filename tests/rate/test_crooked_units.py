"""Units whose axes are not perpendicular, and records that gravity contradicts.

The records are made here by rotation matrices; nothing of the program's attitudes is in them.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

from surveyapp.cli.main import main
from surveyapp_models.arrays import Floats

DEG_H = math.radians(1.0) / 3600.0
PPM, ARCSEC = 1e-6, math.radians(1.0) / 3600.0
LATITUDE, HEADING, PITCH, ROLL = -35.0, 214.0, 14.0, -22.0
EARTH = 7.292115e-5 * np.array(
    [0.0, math.cos(math.radians(LATITUDE)), math.sin(math.radians(LATITUDE))]
)
GRAVITY = np.array([0.0, 0.0, 9.80665])
GYROS = np.array([[1.006, 4e-3, -9e-3], [-7e-3, 0.994, 5e-3], [3e-3, -6e-3, 1.002]])
FORCES = np.array([[1.004, 0.0, 0.0], [8e-3, 0.997, 0.0], [-6e-3, 5e-3, 1.001]])
FORCE_BIAS = np.array([0.15, -0.08, 0.05])


def turn(axis: int, degrees: float) -> Floats:
    """Right-handed about a body axis, shape (3, 3)."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    found = np.eye(3)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    found[i, i], found[j, j], found[i, j], found[j, i] = c, c, -s, s
    return found


def attitude() -> Floats:
    return np.asarray(turn(2, -HEADING) @ turn(0, PITCH) @ turn(1, ROLL))


def card_of(folder: Path) -> Path:
    """The unit's own matrices under the names of rate.md."""
    lines = ['id = "own"', 'title = "unit"', 'kind = "rate"', 'source = "made"']
    for prefix, matrix in (("", GYROS), ("accelerometer_", FORCES)):
        for i, a in enumerate("xyz"):
            values = {f"scale_factor_{a}": ((matrix[i, i] - 1.0) / PPM, "ppm")}
            for j, b in enumerate("xyz"):
                if i != j:
                    angle = matrix[i, j] / matrix[i, i] / ARCSEC
                    values[f"misalignment_{a}{b}"] = (angle, "arcsec")
            for name, (value, unit) in values.items():
                lines += [f"[parameter.{prefix}{name}]", f"value = {float(value)!r}"]
                lines += ["sigma = 1.0", f'unit = "{unit}"']
    for a, value in zip("xyz", FORCE_BIAS, strict=True):
        lines += [f"[parameter.accelerometer_bias_{a}]", f"value = {float(value)!r}"]
        lines += ["sigma = 0.001", 'unit = "m/s2"']
    path = folder / "unit.toml"
    path.write_text("\n".join(lines) + "\n")
    return path


def written(path: Path, columns: Mapping[str, Floats | list[str]]) -> Path:
    rows = zip(*columns.values(), strict=True)
    text = [",".join(columns)]
    text += [",".join(v if isinstance(v, str) else f"{v:.12g}" for v in row) for row in rows]
    path.write_text("\n".join(text) + "\n")
    return path


def vectors(rates: Floats, forces: Floats) -> dict[str, Floats]:
    found = {f"gyr_{a}_rad_s": rates[:, i] for i, a in enumerate("xyz")}
    return found | {f"acc_{a}_m_s2": forces[:, i] for i, a in enumerate("xyz")}


def asked(capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, dict[str, object]]:
    code = main(["north", *words, "--json"])
    taken = capsys.readouterr()
    found: dict[str, object] = json.loads(taken.out or taken.err)
    return code, found


def indexed_log(folder: Path, *, flicker: float = 0.0) -> Path:
    """Four positions of 30 s; ``flicker`` of the encoder [deg], its readings from 0 to 360."""
    rng = np.random.default_rng(8)
    angles = np.repeat([0.0, 90.0, 180.0, 270.0], 60)
    rates, forces = [], []
    for angle in angles:
        sensor = attitude() @ turn(2, -float(angle))
        rates.append(GYROS @ sensor.T @ EARTH + np.array([12.0, -31.0, 7.0]) * DEG_H)
        forces.append(FORCES @ sensor.T @ GRAVITY + FORCE_BIAS)
    noise = rng.normal(0.0, 1.0, (2, angles.size, 3))
    columns: dict[str, Floats | list[str]] = {"time_s": np.asarray(np.arange(angles.size) * 0.5)}
    columns |= vectors(
        np.array(rates) + noise[0] * 0.02 * DEG_H, np.array(forces) + noise[1] * 1e-4
    )
    read = (angles + flicker * rng.normal(0.0, 1.0, angles.size)) % 360.0
    columns["index_angle_deg"] = np.round(read, 2)
    return written(folder / "index.csv", columns)


@pytest.mark.parametrize("flicker", [0.003, 0.02, 0.2])
def test_an_encoder_that_flickers_stands_in_four_positions(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], flicker: float
) -> None:
    """Each row had an angle of its own, and no position was at rest; about north 359.99 is 0."""
    words = ("--method", "indexing", f"--latitude={LATITUDE}", "--card", str(card_of(tmp_path)))
    _, still = asked(capsys, str(indexed_log(tmp_path)), *words)
    code, found = asked(capsys, str(indexed_log(tmp_path, flicker=flicker)), *words)
    assert code == 0
    assert found["stops"] == still["stops"] == 4
    one, other = still["heading"], found["heading"]
    assert isinstance(one, dict)
    assert isinstance(other, dict)
    # the median of sixty readings turns the body by a sixth of the flicker
    assert abs(other["deg"] - one["deg"]) < 0.01 + flicker


def test_a_card_takes_out_what_crooked_axes_turn_the_heading_by(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = str(indexed_log(tmp_path))
    words = (log, "--method", "indexing", f"--latitude={LATITUDE}")
    code, found = asked(capsys, *words, "--card", str(card_of(tmp_path)))
    assert code == 0
    heading = found["heading"]
    assert isinstance(heading, dict)
    assert heading["sigma_arcsec"] < 60.0
    assert abs(heading["deg"] - HEADING) * 3600.0 < 4.0 * heading["sigma_arcsec"]
    biases = {p["name"]: p for p in found["parameters"]}  # type: ignore[attr-defined]
    for name, true in (("bias_x", 12.0), ("bias_y", -31.0), ("bias_z", 7.0)):
        assert abs(biases[name]["value"] - true) < 4.0 * biases[name]["sigma"]
    _, nominal = asked(capsys, *words)
    assert "nominal_axes" in {w["code"] for w in nominal["warnings"]}  # type: ignore[attr-defined]
    bare = nominal["heading"]
    assert isinstance(bare, dict)
    assert bare["deg"] is None or abs(bare["deg"] - HEADING) > 0.2


def rotated_log(
    folder: Path, *, order: tuple[int, int, int] = (0, 1, 2), most: float = 9.0
) -> Path:
    """A level unit turned by 90 degrees clockwise in 20 s; gyro columns in another order."""
    dt, words = 0.1, ["filter"] * 200 + ["level"] * 200 + ["run"] * 300
    rng = np.random.default_rng(9)
    own = np.zeros(len(words))
    own[450:650] = -math.pi / 2.0 / 20.0 * (1.0 - np.cos(2.0 * math.pi * np.arange(200) / 200.0))
    angle = np.degrees(np.concatenate([[0.0], np.cumsum(own * dt)[:-1]]))
    level = [(turn(2, -HEADING) @ turn(2, float(a))).T @ EARTH for a in angle]
    rates = np.array(level) + own[:, None] * np.array([0.0, 0.0, 1.0])
    rates = np.clip(rates + rng.normal(0.0, 1e-5, rates.shape), -most, most)
    forces = np.tile(GRAVITY, (len(words), 1)) + rng.normal(0.0, 1e-3, rates.shape)
    columns: dict[str, Floats | list[str]] = {"time_s": np.asarray(np.arange(len(words)) * dt)}
    columns |= vectors(rates[:, list(order)], forces)
    columns["phase"] = words
    return written(folder / "run.csv", columns)


ROTATION = ("--method", "rotation", "--initial-heading-deg", "214", "--initial-reference", "GRID")


def test_a_level_turn_is_carried_and_gravity_agrees(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    code, found = asked(capsys, str(rotated_log(tmp_path)), *ROTATION, f"--latitude={LATITUDE}")
    assert code == 0
    heading = found["heading"]
    assert isinstance(heading, dict)
    assert heading["deg"] == pytest.approx(304.0, abs=0.01)
    assert "tilt_differs" not in {w["code"] for w in found["warnings"]}  # type: ignore[attr-defined]


def test_exchanged_gyros_are_denied_by_gravity(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    code, found = asked(capsys, str(rotated_log(tmp_path, order=(2, 1, 0))), *ROTATION)
    problem = found["problems"][0]  # type: ignore[index]
    assert code == 2
    assert problem["what"] == "gravity does not turn as the gyros say"
    assert "(z, y, x)" in problem["expected"]


def test_a_gyro_at_the_end_of_its_range_in_the_run_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    code, found = asked(capsys, str(rotated_log(tmp_path, most=0.1)), *ROTATION)
    assert code == 2
    assert found["problems"][0]["what"] == "gyr_z_rad_s is saturated"  # type: ignore[index]


def test_a_gap_in_the_turn_is_in_the_sigma(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = rotated_log(tmp_path)
    rows = log.read_text().splitlines()
    _, whole = asked(capsys, str(log), *ROTATION, f"--latitude={LATITUDE}")
    log.write_text("\n".join([*rows[:541], *rows[571:]]) + "\n")
    code, found = asked(capsys, str(log), *ROTATION, f"--latitude={LATITUDE}")
    before, heading = whole["heading"], found["heading"]
    assert isinstance(before, dict)
    assert isinstance(heading, dict)
    assert code == 0
    assert heading["sigma_arcsec"] > 10.0 * before["sigma_arcsec"]
    assert abs(heading["deg"] - 304.0) * 3600.0 < 3.0 * heading["sigma_arcsec"]


@pytest.mark.parametrize("log", [indexed_log, rotated_log])
def test_a_card_of_another_kind_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], log: object
) -> None:
    card = tmp_path / "compass.toml"
    card.write_text(
        'id = "c"\ntitle = "c"\nkind = "compass"\nsource = "s"\n'
        '[parameter.hard_iron_x]\nvalue = 1.0\nsigma = 0.1\nunit = "uT"\n'
    )
    path = str(log(tmp_path))  # type: ignore[operator]
    words = ROTATION if "run" in path else ("--method", "indexing", "--latitude=-35")
    code, found = asked(capsys, path, *words, "--card", str(card))
    assert code == 2
    assert found["problems"][0]["what"] == "the card is of another kind"  # type: ignore[index]


def test_a_declination_and_options_of_another_method_are_not_passed_over(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A heading from the earth's rotation takes no declination, whatever reference is stated."""
    card = str(card_of(tmp_path))
    words = [str(indexed_log(tmp_path)), "--method", "indexing", f"--latitude={LATITUDE}"]
    words += ["--card", card]
    magnetic = ("--initial-reference", "MAGNETIC", "--declination", "2.5")
    code, found = asked(capsys, *words, *magnetic)
    assert code == 2
    assert found["problems"][0]["where"] == "--declination"  # type: ignore[index]
    _, told = asked(capsys, *words, "--constant-deg", "171")
    warnings = told["warnings"]
    assert isinstance(warnings, list)
    warning = warnings[0]
    assert len(warnings) == 1
    assert warning["code"] == "option_not_used"
    assert "--constant-deg" in warning["text"]
