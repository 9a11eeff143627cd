"""States of a vehicle whose unit is mounted with a tilt: gravity must not look like a push."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from surveyapp import api
from surveyapp.errors import SurveyError

PROFILE = (
    ("stationary", 10.0, 0.0),
    ("accelerating", 5.0, 0.8),
    ("steady", 10.0, 0.0),
    ("turning", 10.0, 9.0),
    ("steady", 15.0, 0.0),
    ("braking", 4.0, 1.0),
    ("stationary", 10.0, 0.0),
)
RATE_HZ = 50.0


def drive(
    path: Path, *, pitch: float, roll: float, noise: float = 5e-4, earth: float = 0.0
) -> list[str]:
    """A level drive with one curve of 90 degrees to the right; the state of each row.

    ``noise`` of a sample of the gyros, level part of the earth's rate [rad/s].
    """
    rng = np.random.default_rng(31)
    c, s, d, t = math.cos(pitch), math.sin(pitch), math.cos(roll), math.sin(roll)
    mounted = np.array([[1, 0, 0], [0, c, -s], [0, s, c]]) @ np.array(
        [[d, 0, t], [0, 1, 0], [-t, 0, d]]
    )
    states, forces, rates, speed, heading = [], [], [], 0.0, 0.4
    for state, seconds, size in PROFILE:
        push = {"accelerating": size, "braking": -size}.get(state, 0.0)
        turn = math.radians(size) if state == "turning" else 0.0
        for _ in range(round(seconds * RATE_HZ)):
            states.append(state)
            forces.append([speed * turn, push, 9.80665])
            rates.append([-earth * math.sin(heading), earth * math.cos(heading), -turn])
            heading += turn / RATE_HZ
            speed += push / RATE_HZ
    moving = np.array([state != "stationary" for state in states])[:, None]
    shape = (len(states), 3)
    # what shakes a vehicle turns it to and fro: its rate is the change of a small angle
    shaking = np.diff(
        rng.normal(0.0, 5e-4, (shape[0] + 1, 3)) * np.vstack([moving[:1], moving]), axis=0
    )
    force = np.array(forces) + moving * rng.normal(0.0, 0.2, shape)
    rate = np.array(rates) + shaking * RATE_HZ
    table = np.column_stack(
        [
            np.arange(shape[0]) / RATE_HZ,
            rate @ mounted + rng.normal(0.0, noise, shape) + [1e-3, -2e-3, 5e-4],
            force @ mounted + rng.normal(0.0, 0.01, shape) + [0.03, -0.02, 0.01],
        ]
    )
    names = [f"{n}" for n in ("time_s", *(f"gyr_{a}_rad_s" for a in "xyz"))]
    names += [f"acc_{a}_m_s2" for a in "xyz"]
    np.savetxt(path, table, fmt="%.9g", delimiter=",", header=",".join(names), comments="")
    return states


@pytest.mark.parametrize(("pitch", "roll"), [(0.0, 0.0), (3.0, -2.0), (8.0, 5.0), (-4.0, -12.0)])
def test_a_tilted_unit_keeps_its_level_in_a_curve(
    tmp_path: Path, pitch: float, roll: float
) -> None:
    """Rolled by b, a curve of 90 degrees moved the level by 90 sin(b) as by the x gyro alone."""
    path = tmp_path / "drive.csv"
    states = np.array(drive(path, pitch=math.radians(pitch), roll=math.radians(roll)))
    time = np.arange(states.size) / RATE_HZ
    found = np.full(states.size, "", dtype=object)
    for segment in api.motion(path).segments:
        found[(time >= segment.start_s) & (time <= segment.end_s)] = segment.state
    for state, share in (("stationary", 0.95), ("steady", 0.85), ("turning", 0.95)):
        assert np.mean(found[states == state] == state) >= share
    for state in ("accelerating", "braking"):
        assert np.mean(found[states == state] == state) >= 0.95


def test_a_gyro_that_sees_the_earth_turn_rests_at_every_heading(tmp_path: Path) -> None:
    """Turned by 90 degrees a unit of .0006 deg/s a sample sees the earth by seven sigmas elsewhere.

    The bias of the first stop then called the second one motion.
    """
    path = tmp_path / "drive.csv"
    states = np.array(drive(path, pitch=0.02, roll=0.01, noise=1e-5, earth=7.3e-5))
    time = np.arange(states.size) / RATE_HZ
    last = [s for s in api.motion(path).segments if s.state == "stationary"][-1]
    assert last.end_s == pytest.approx(float(time[-1]), abs=0.1)
    assert last.end_s - last.start_s > 9.0


def test_a_gyro_at_the_end_of_its_range_is_no_rest_and_makes_no_path(tmp_path: Path) -> None:
    """It has no noise there: the curve was taken for the quietest part of the record."""
    path = tmp_path / "drive.csv"
    states = np.array(drive(path, pitch=0.0, roll=0.0))
    table = np.loadtxt(path, delimiter=",", skiprows=1)
    table[:, 3] = np.clip(table[:, 3], -0.1, 0.1)
    header = path.read_text().splitlines()[0]
    np.savetxt(path, table, fmt="%.9g", delimiter=",", header=header, comments="")
    time = np.arange(states.size) / RATE_HZ
    found = [s for s in api.motion(path).segments if s.state == "stationary"]
    turning = time[states == "turning"]
    assert all(s.end_s <= turning[0] or s.start_s >= turning[-1] for s in found)
    with pytest.raises(SurveyError) as refused:
        api.motion(path, options={"path": True})
    assert refused.value.problems[0].what == "gyr_z_rad_s is saturated"


def test_a_place_without_a_path_is_told(tmp_path: Path) -> None:
    """It says where a path begins, and nobody asked for one."""
    path = tmp_path / "drive.csv"
    drive(path, pitch=0.0, roll=0.0)

    def told(**options: object) -> set[str]:
        return {w.code for w in api.motion(path, options=options).warnings}

    assert "option_not_used" in told(begin="0,0,0")
    assert "option_not_used" not in told(begin="0,0,0", path=True) | told()


@pytest.mark.parametrize(("pitch", "roll"), [(0.0, 0.0), (8.0, 5.0), (-4.0, -12.0)])
def test_a_tilted_unit_turns_about_up(tmp_path: Path, pitch: float, roll: float) -> None:
    """By the gyro along z alone a curve of 90 degrees is 90 cos(tilt), and the end 1.8 m off.

    The path is that of the profile, summed here.
    """
    path = tmp_path / "drive.csv"
    drive(path, pitch=math.radians(pitch), roll=math.radians(roll))
    speed = heading = east = north = driven = 0.0
    odometer = []
    for state, seconds, size in PROFILE:
        for _ in range(round(seconds * RATE_HZ)):
            odometer.append(driven)
            step = speed / RATE_HZ
            driven += step
            east, north = east + step * math.sin(heading), north + step * math.cos(heading)
            speed += {"accelerating": size, "braking": -size}.get(state, 0.0) / RATE_HZ
            heading += math.radians(size) / RATE_HZ if state == "turning" else 0.0
    lines = path.read_text().splitlines()
    whole = [f"{line},{d:.4f}" for line, d in zip(lines[1:], odometer, strict=True)]
    path.write_text("\n".join([lines[0] + ",odometer_m", *whole]) + "\n")
    found = api.motion(path, options={"path": True, "begin": "0,0,0"}).path
    assert found is not None
    assert found.end_m[:2] == pytest.approx((east, north), abs=0.3)
