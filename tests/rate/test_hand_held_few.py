"""Few hand-held stops, and turns that no arrangement of the columns explains.

The records are made here by rotation matrices; nothing of the program's attitudes is in them.
"""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from surveyapp import api
from surveyapp.cli.main import main
from surveyapp.errors import SurveyError
from surveyapp_models.arrays import Floats

HZ = 50.0
FIELD = np.array([0.0, 22.0, -42.0])
"""Of the earth, to east, north, up [uT]."""


def turned(axis: Floats, angle: float) -> Floats:
    """Rodrigues' formula, shape (3, 3)."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + math.sin(angle) * cross + (1.0 - math.cos(angle)) * cross @ cross)


def held(
    path: Path,
    seed: int,
    stops: int,
    *,
    x_scale: float = 1.0,
    noise: float = 1e-3,
    pull: float = 0.0,
    magnetic: float = 0.0,
) -> tuple[Floats, Floats]:
    """A record of stops of 3 s and turns of 1.6 s; output matrices of gyros and accelerometers.

    ``noise`` of a sample of the gyros [rad/s], ``pull`` of gravity on them [rad/s per m/s2],
    ``magnetic`` of the field along each [rad/s per uT].
    """
    rng = np.random.default_rng(seed)
    gyros = np.eye(3) + rng.normal(0.0, 0.01, (3, 3))
    forces = np.tril(np.eye(3) + rng.normal(0.0, 0.01, (3, 3)))
    body, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    body = body * np.sign(np.linalg.det(body))
    rates, felt, fields = [], [], []
    for stop in range(stops):
        rates += [np.zeros(3)] * round(3.0 * HZ)
        felt += [body.T @ [0.0, 0.0, 9.80665]] * round(3.0 * HZ)
        fields += [body.T @ FIELD] * round(3.0 * HZ)
        if stop == stops - 1:
            break
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        count = round(1.6 * HZ)
        steps = np.sin(math.pi * (np.arange(count) + 0.5) / count) ** 2
        for step in steps / steps.sum() * math.radians(rng.uniform(60.0, 120.0)):
            rates.append(axis * step * HZ)
            half = body @ turned(axis, 0.5 * step)
            felt.append(half.T @ [0.0, 0.0, 9.80665])
            fields.append(half.T @ FIELD)
            body = body @ turned(axis, step)
    shape = (len(rates), 3)
    gyr = np.array(rates) @ gyros.T + [0.01, -0.02, 0.005] + rng.normal(0.0, noise, shape)
    gyr += pull * np.array(felt) + magnetic * np.array(fields)
    acc = np.array(felt) @ forces.T + [0.1, -0.05, 0.08] + rng.normal(0.0, 0.02, shape)
    gyr[:, 0] *= x_scale
    names = ["time_s", *(f"gyr_{a}_rad_s" for a in "xyz"), *(f"acc_{a}_m_s2" for a in "xyz")]
    table = np.column_stack([np.arange(shape[0]) / HZ, gyr, acc])
    if magnetic:
        names += [f"mag_{a}_uT" for a in "xyz"]
        table = np.column_stack([table, np.array(fields) + rng.normal(0.0, 0.3, shape)])
    np.savetxt(path, table, fmt="%.8g", delimiter=",", header=",".join(names), comments="")
    return gyros, forces


@pytest.mark.statistical
def test_the_frame_of_the_gyros_holds_what_few_stops_leave_open(tmp_path: Path) -> None:
    """Nine stops give no misalignment of the accelerometers: it is in the gyros' all the same.

    Before .88 of 146 lay within 1.96 sigma, 5.6 sigma the worst. Four records: the values of one
    hang together, and .85 of them is what is asked.
    """
    scores = []
    for seed in range(4):
        path = tmp_path / "held.csv"
        gyros, _ = held(path, 900 + seed, 9)
        found = api.calibrate("rate", path, options={"programme": "multi-position"})
        values = {p.name: p for p in found.parameters}
        for i, a in enumerate("xyz"):
            for j, b in enumerate("xyz"):
                item = values[f"misalignment_{a}{b}"] if i != j else None
                if item is not None and item.value is not None and item.sigma:
                    true = gyros[i, j] / gyros[i, i] * 206264.806
                    scores.append(abs(item.value - true) / item.sigma)
    assert len(scores) >= 8
    assert np.mean(np.array(scores) < 1.96) >= 0.85
    assert max(scores) < 3.5


def test_turns_that_no_arrangement_explains_are_refused(tmp_path: Path) -> None:
    """One column off by a factor: the others' parameters were given beside a scale of one."""
    path = tmp_path / "held.csv"
    held(path, 7, 14, x_scale=6.0)
    with pytest.raises(SurveyError) as refused:
        api.calibrate("rate", path, options={"programme": "multi-position"})
    (problem,) = refused.value.problems
    assert problem.what == "the turns of the gyros do not carry gravity along"


def test_counts_from_the_middle_of_a_range_are_calibrated_as_any(tmp_path: Path) -> None:
    """A converter's zero of 8 g is no zero of a unit: makers' tolerances do not hold it."""
    path, shifted = tmp_path / "held.csv", tmp_path / "counts.csv"
    held(path, 5, 16)
    table = np.loadtxt(path, delimiter=",", skiprows=1)
    table[:, 4:] = 400.0 * (table[:, 4:] + 79.0)
    header = path.read_text().splitlines()[0]
    np.savetxt(shifted, table, fmt="%.10g", delimiter=",", header=header, comments="")
    scale = api.LogOptions(scale={f"acc_{a}_m_s2": 1.0 / 400.0 for a in "xyz"})
    options = {"programme": "multi-position"}
    found = api.calibrate("rate", path, options=options)
    other = api.calibrate("rate", shifted, log=scale, options=options)
    before = other.before
    assert before is not None
    assert before.rms is not None
    assert before.rms < 1.0
    plain, counts = ({p.name: p for p in one.parameters} for one in (found, other))
    for name, one in plain.items():
        value, shown = one.value, counts[name].value
        zero = 79.0 if name.startswith("accelerometer_bias") else 0.0
        assert value is not None
        assert shown is not None
        assert one.sigma is not None
        assert abs(shown - value - zero) < 0.05 * one.sigma


@pytest.mark.parametrize("noise", [1e-3, 3e-5])
def test_a_quiet_gyro_whose_bias_follows_gravity_keeps_its_stops(
    tmp_path: Path, noise: float
) -> None:
    """A bias of .02 deg/s in one attitude and -.02 in another is no motion, whatever the noise.

    With samples of .002 deg/s no stop was left of 18.
    """
    path = tmp_path / "held.csv"
    held(path, 11, 18, noise=noise, pull=math.radians(0.002))
    found = api.calibrate("rate", path, options={"programme": "multi-position"})
    stops = found.to_dict()["stops"]
    assert len(stops) == 18
    assert min(one["end_s"] - one["start_s"] for one in stops) > 2.5


def test_a_record_with_a_magnetometer_is_diagnosed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The field along a gyro was asked of the angles of a turn, too: an internal fault."""
    (tmp_path / "sensors").mkdir()
    held(tmp_path / "sensors" / "held.csv", 23, 16, magnetic=math.radians(4e-4))
    (tmp_path / "project.toml").write_text(
        'format = 1\nname = "m"\n[[sensor_log]]\nid = "unit"\nkind = "rate"\n'
        'file = "sensors/held.csv"\nprogramme = "multi-position"\nlatitude_deg = 0.0\n'
    )
    assert main(["diagnose", str(tmp_path), "--sensor", "unit", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert [one["effect"] for one in found["adopted"]] == ["magnetic_sensitivity"]
