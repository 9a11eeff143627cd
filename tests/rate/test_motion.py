"""State of motion, the gate and its own test, the path and snapping."""

from __future__ import annotations

import math
import os
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from bench.rate_motion import exceeding, split
from surveyapp.core.sensors.rate.motion_log import MotionOptions, judge_motion
from surveyapp.core.sensors.rate.motion_pieces import states_of
from surveyapp.core.sensors.rate.odometer_path import Driven, reckon
from surveyapp.core.sensors.rate.rests import Rests
from surveyapp.core.sensors.rate.snapping import snap
from surveyapp.core.sensors.rate.zero_velocity import TOLERATED
from surveyapp.core.simulate.rate.log import SimulatedLog
from surveyapp.core.simulate.rate.recipes import simulate_rate
from surveyapp.core.simulate.rate.vehicle import VehicleRun, usual_drive, vehicle_log
from surveyapp.domain.motion import Motion, MotionSegment
from surveyapp.domain.sensor_log import SensorLog
from surveyapp_models.arrays import Floats
from surveyapp_models.rate.triad import Triad
from tests.rate.logs import as_read

SHARED = Path(os.environ.get("SURVEYAPP_DATA", Path(__file__).parents[2] / "../shared/data"))


def drive(seed: int, *, noise: float = 1.0) -> SimulatedLog:
    run = VehicleRun(
        usual_drive(),
        heading=math.radians(30.0),
        gyro=Triad(bias=np.array([0.002, -0.001, 0.0015]), noise=0.001 * noise),
        accelerometer=Triad(noise=0.02 * noise),
        shake=0.15 * noise,
    )
    return vehicle_log(run, np.random.default_rng(seed))


def agreement(log: SimulatedLog, found: Motion, state: str) -> float:
    """Share of the true time of a state that was given it."""
    time = log.columns["time_s"]
    given = np.array([""] * time.size, dtype=object)
    for segment in found.segments:
        given[(time >= segment.start_s) & (time < segment.end_s)] = segment.state
    truth = log.truth["segments"]
    assert isinstance(truth, list)
    rows = np.zeros(time.size, dtype=bool)
    for segment in truth:
        if segment["state"] == state:
            rows |= (time >= segment["start_s"] + 0.6) & (time < segment["end_s"] - 0.6)
    return float(np.mean(given[rows] == state))


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_the_five_states_of_a_drive(seed: int) -> None:
    log = drive(seed)
    found = judge_motion(as_read(log), MotionOptions())
    assert agreement(log, found, "stationary") == 1.0
    assert agreement(log, found, "turning") > 0.95
    assert agreement(log, found, "accelerating") > 0.9
    assert agreement(log, found, "braking") > 0.9
    assert agreement(log, found, "steady") > 0.7


def test_pieces_say_what_the_whole_record_says() -> None:
    """Cut every 82 s, wherever the vehicle is: the same rests, and nearly the same states."""
    run = VehicleRun(usual_drive(8), gyro=Triad(noise=0.001), accelerometer=Triad(noise=0.02))
    log = as_read(vehicle_log(run, np.random.default_rng(2)))
    whole = states_of(log, false_alarm=0.01)
    parts = states_of(log, false_alarm=0.01, rows=8300)
    assert (whole.pieces, parts.pieces) == (1, 4)
    assert np.mean(whole.rests.mask() == parts.rests.mask()) >= 0.99
    time = log.columns["time_s"]

    def named(segments: tuple[MotionSegment, ...]) -> np.ndarray:
        given = np.array([""] * time.size, dtype=object)
        for segment in segments:
            given[(time >= segment.start_s) & (time < segment.end_s)] = segment.state
        return given

    assert np.mean(named(whole.segments) == named(parts.segments)) >= 0.95
    ends = [(one.end_s, other.start_s) for one, other in pairwise(parts.segments)]
    assert all(end == start for end, start in ends)


def test_white_noise_is_no_motion() -> None:
    rng = np.random.default_rng(1)
    columns: dict[str, Floats] = {"time_s": np.asarray(np.arange(20000) * 0.01)}
    for i, a in enumerate("xyz"):
        columns[f"acc_{a}_m_s2"] = (9.8 if i == 2 else 0.0) + rng.normal(0.0, 0.05, 20000)
        columns[f"gyr_{a}_rad_s"] = rng.normal(0.0, 0.002, 20000)
    found = judge_motion(as_read(SimulatedLog(columns)), MotionOptions())
    assert [s.state for s in found.segments] == ["stationary"]


def test_an_odometer_path_ends_where_the_vehicle_stands() -> None:
    log = drive(4)
    begin = (100.0, 200.0, math.radians(30.0))
    found = judge_motion(as_read(log), MotionOptions(path=True, begin=begin))
    assert found.path is not None
    assert found.path.mode == "odometer"
    end = log.truth["end_m"]
    assert isinstance(end, list)
    off = np.array(found.path.end_m[:2]) - np.array([100.0, 200.0]) - np.array(end)
    assert float(np.linalg.norm(off)) < 1.5
    steps = np.diff([p[0] for p in found.path.points])
    assert np.all(steps[:-1] == pytest.approx(0.5))


def straight(*, heading: Floats, cycle: Floats | None = None) -> Driven:
    n = heading.size
    distance = np.linspace(0.0, 200.0, n)
    still = np.zeros(n, dtype=bool)
    still[0] = True
    return Driven(distance, heading, {}, cycle, Rests.of(still))


def test_a_linear_drift_is_laid_back_and_a_constant_offset_after_a_power_cycle_too() -> None:
    """Sensors.md 2d: 2 degrees of drift end 3.49 m off, 1.5 degrees of offset 5.24 m."""
    n = 4001
    drift = straight(heading=np.linspace(0.0, math.radians(2.0), n))
    free = reckon(drift, start=(0.0, 0.0), heading_walk=0.0, heading_sigma=0.0)
    assert abs(free.place[-1, 0]) == pytest.approx(3.49, abs=0.01)
    mended, told = snap(drift, power_cycle="current", end=(0.0, 200.0), start=(0.0, 0.0))
    snapped = reckon(mended, start=(0.0, 0.0), heading_walk=0.0, heading_sigma=0.0)
    assert abs(snapped.place[-1, 0]) < 1e-3
    assert [t.kind for t in told] == ["linear"]
    assert told[0].heading_deg == pytest.approx(-2.0, abs=0.01)
    cycle = np.ones(n)
    cycle[0] = 0.0
    offset = straight(heading=np.full(n, math.radians(1.5)), cycle=cycle)
    free = reckon(offset, start=(0.0, 0.0), heading_walk=0.0, heading_sigma=0.0)
    assert abs(free.place[-1, 0]) == pytest.approx(5.24, abs=0.01)
    mended, told = snap(offset, power_cycle="current", end=(0.0, 200.0), start=(0.0, 0.0))
    snapped = reckon(mended, start=(0.0, 0.0), heading_walk=0.0, heading_sigma=0.0)
    assert abs(snapped.place[-1, 0]) < 0.01
    assert [t.kind for t in told] == ["constant"]


@pytest.mark.parametrize(("which", "span"), [("current", (60.0, 120.0)), ("previous", (0.0, 60.0))])
def test_power_switched_within_a_stop_shifts_what_lies_behind_or_before_it(
    which: str, span: tuple[float, float]
) -> None:
    """Two legs of 60 m and a stop of 101 rows between, in the middle of which the power came back.

    The unit turned by 1.5 degrees while it was off, so that the known end lies there.
    """
    distance = np.concatenate(
        [np.arange(0.0, 60.0, 0.1), np.full(101, 60.0), np.arange(60.1, 120.05, 0.1)]
    )
    still = distance == 60.0
    still[0] = True
    cycle = (np.arange(distance.size) >= 650).astype(np.float64)
    drive = Driven(distance, np.zeros(distance.size), {}, cycle, Rests.of(still))
    turned = math.radians(1.5)
    end = (60.0 * math.sin(turned), 60.0 + 60.0 * math.cos(turned))
    mended, told = snap(drive, power_cycle=which, end=end, start=(0.0, 0.0))
    assert [(t.kind, t.from_m, t.to_m) for t in told] == [("constant", *map(pytest.approx, span))]
    assert told[0].heading_deg == pytest.approx(1.5, abs=1e-3)
    found = reckon(mended, start=(0.0, 0.0), heading_walk=0.0, heading_sigma=0.0)
    np.testing.assert_allclose(found.place[-1], end, atol=2e-3)


def test_the_covariance_of_a_straight_path_is_that_of_its_simulation() -> None:
    rng = np.random.default_rng(2)
    walk = math.radians(0.1)
    ends = []
    for _ in range(300):
        kicks = np.cumsum(rng.normal(0.0, walk * math.sqrt(0.05), 4001))
        free = reckon(
            straight(heading=kicks), start=(0.0, 0.0), heading_walk=0.0, heading_sigma=0.0
        )
        ends.append(free.place[-1])
    told = reckon(
        straight(heading=np.zeros(4001)), start=(0.0, 0.0), heading_walk=walk, heading_sigma=0.0
    )
    stated = math.sqrt(float(told.covariance[-1, 0, 0]))
    assert float(np.std([e[0] for e in ends])) == pytest.approx(stated, rel=0.15)


def test_a_vehicle_can_be_simulated_with_a_power_cycle() -> None:
    files, truth = simulate_rate("vehicle", None, effects=(), rng=np.random.default_rng(1))
    assert "sensors/vehicle.csv" in files
    assert truth["simulated"] is True


@pytest.mark.shared_data
@pytest.mark.skipif(not SHARED.exists(), reason="the measured records are not there")
def test_the_measured_square_closes_and_a_wrong_gate_is_told_although_it_closes_too() -> None:
    from scipy.io import loadmat

    u = loadmat(SHARED / "openshoe_square2" / "square2.mat")["u"]
    columns: dict[str, Floats] = {"time_s": np.asarray(np.arange(u.shape[1]) / 100.0)}
    columns |= {f"acc_{a}_m_s2": u[i] for i, a in enumerate("xyz")}
    columns |= {f"gyr_{a}_rad_s": u[3 + i] for i, a in enumerate("xyz")}
    log = as_read(SimulatedLog(columns))
    right = judge_motion(log, MotionOptions(path=True))
    assert right.path is not None
    assert right.zero_velocity is not None
    assert right.path.closure_m is not None
    assert right.path.closure_m < 0.05  # rate.md .031 m
    assert len(right.path.sides_m) == 8
    assert all(abs(side - 0.30) <= 0.02 for side in right.path.sides_m)
    assert right.zero_velocity["verdict"] == "consistent"
    wrong = judge_motion(log, MotionOptions(path=True, still_gate_factor=500.0))
    assert wrong.zero_velocity is not None
    assert wrong.zero_velocity["verdict"] == "inconsistent"
    assert not wrong.met


def measured(path: Path, *, skip: int, columns: slice, scale: tuple[float, float]) -> SensorLog:
    table = np.genfromtxt(path, delimiter=",", skip_header=skip)[:, columns]
    swap = 3 if "walk" in path.name else 0
    forces = table[:, swap : swap + 3] * scale[0]
    rates = np.deg2rad(table[:, 3 - swap : 6 - swap] * scale[1])
    found: dict[str, Floats] = {"time_s": np.asarray(np.arange(table.shape[0]) / 100.0)}
    found |= {f"acc_{a}_m_s2": forces[:, i] for i, a in enumerate("xyz")}
    found |= {f"gyr_{a}_rad_s": rates[:, i] for i, a in enumerate("xyz")}
    return as_read(SimulatedLog(found))


@pytest.mark.shared_data
@pytest.mark.skipif(not SHARED.exists(), reason="the measured records are not there")
def test_two_detectors_agree_on_a_measured_walk_and_a_static_record_has_no_motion() -> None:
    walk = measured(
        SHARED / "xio_ngimu" / "long_walk_100Hz.csv", skip=1, columns=slice(1, 7),
        scale=(9.80665, 1.0),
    )  # fmt: skip
    kappa = judge_motion(walk, MotionOptions()).detectors["kappa"]
    assert kappa >= 0.75
    static = measured(
        SHARED / "mpu6050_static" / "example_data_static_449s.csv", skip=5, columns=slice(0, 6),
        scale=(9.80665 / 16384.0, 1.0 / 131.0),
    )  # fmt: skip
    assert {s.state for s in judge_motion(static, MotionOptions()).segments} == {"stationary"}


@pytest.mark.statistical
def test_a_gate_that_calls_driving_rest_is_told_at_every_grade_of_sensor() -> None:
    """Bench rate_motion: a gate is wrong by what it calls rest, not by its factor.

    A fine sensor on a vehicle that shakes fifty times more than it reads is at rest by no gate
    500 times too wide; one 2000 times too wide is wrong there, too.
    """
    for grade, shake, wide in ((0.3, 0.15, 2000.0), (1.0, 0.6, 2000.0), (4.0, 0.15, 500.0)):
        share, off = exceeding(0, grade=grade, factor=1.0, shake=shake)
        assert off == 0.0
        assert share <= TOLERATED
        share, off = exceeding(0, grade=grade, factor=wide, shake=shake)
        assert off > 0.05
        assert share > 3.0 * TOLERATED
    share, off = exceeding(0, grade=0.3, factor=500.0, shake=0.15)
    assert off <= 0.05


def test_one_state_is_seldom_taken_for_two() -> None:
    """Bench rate_motion: none of 60; three of 20 would have p = .001 at a rate of .02."""
    for name in ("gamma 1", "half normal", "correlated"):
        assert split(name, 400, 20) <= 0.10, name


def test_a_path_over_a_gap_while_moving_is_not_to_be_used() -> None:
    run = VehicleRun(legs=usual_drive(), gyro=Triad(noise=0.001), accelerometer=Triad(noise=0.02))
    log = vehicle_log(run, np.random.default_rng(2))
    time = log.columns["time_s"]
    for (low, high), usable in (((25.0, 27.0), False), ((3.0, 5.0), True)):
        rows = (time < low) | (time >= high)
        cut = SimulatedLog({k: v[rows] for k, v in log.columns.items()}, {}, log.truth)
        found = judge_motion(as_read(cut), MotionOptions(path=True))
        assert found.met == usable
        assert ("path_over_gap" in {w.code for w in found.warnings}) != usable


def smooth_drive(rng: np.random.Generator, *, odometer: bool) -> tuple[SensorLog, Floats]:
    """20 s of rest, .5 m/s2 for 4 s, 11 s at 2 m/s, braking, rest; white noise and no shaking."""
    hz, truth = 50.0, np.repeat([0, 2, 1, 3, 0], [1000, 200, 550, 200, 1000])
    push = np.choose(truth, [0.0, 0.0, 0.5, -0.5])
    speed = np.cumsum(push) / hz
    force = np.column_stack([np.full(truth.size, 0.03), push - 0.02, np.full(truth.size, 9.81)])
    force += 0.02 * rng.normal(size=force.shape)
    rate = np.array([1e-4, -2e-4, 1.5e-4]) + 1e-3 * rng.normal(size=force.shape)
    columns = {"time_s": np.arange(truth.size) / hz}
    columns |= {f"acc_{a}_m_s2": force[:, i] for i, a in enumerate("xyz")}
    columns |= {f"gyr_{a}_rad_s": rate[:, i] for i, a in enumerate("xyz")}
    if odometer:
        columns["odometer_m"] = np.cumsum(speed) / hz
    units = dict.fromkeys(columns, "")
    return SensorLog("smooth", columns, units, truth.size, rate_hz=hz, path="smooth.csv"), truth


@pytest.mark.parametrize("odometer", [True, False])
def test_a_drive_without_shaking_is_no_rest(odometer: bool) -> None:
    """A window's mean was taken out: constant force and constant speed looked like rest (71 %)."""
    log, truth = smooth_drive(np.random.default_rng(5), odometer=odometer)
    found = judge_motion(log, MotionOptions(path=True))
    names = np.array(["stationary", "steady", "accelerating", "braking"])
    given = np.array([""] * truth.size, dtype=object)
    for segment in found.segments:
        inside = (log.columns["time_s"] >= segment.start_s) & (
            log.columns["time_s"] <= segment.end_s
        )
        given[inside] = segment.state
    for code, name in enumerate(names):
        assert np.mean(given[truth == code] == name) > 0.88, name
    assert found.path is not None
    assert max(found.path.sides_m) == pytest.approx(30.0, abs=0.5)
    assert found.met
