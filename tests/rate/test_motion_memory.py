"""Motion of a record of any length: what is kept does not follow its rows, pieces say the same."""

from __future__ import annotations

import math
import tempfile
import tracemalloc
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from surveyapp.core.sensors.rate import (
    motion_doubts,
    motion_pieces,
    odometer_drive,
    odometer_path,
    snapping,
    zero_velocity,
)
from surveyapp.core.sensors.rate.motion_log import MotionOptions, judge_motion
from surveyapp.core.sensors.rate.rests import Rests
from surveyapp.core.simulate.rate.vehicle import VehicleRun, usual_drive, vehicle_log
from surveyapp.domain.motion import Motion
from surveyapp.domain.sensor_log import SensorLog
from surveyapp_models.arrays import Floats
from surveyapp_models.rate.triad import Triad
from tests.rate.logs import as_read


def mapped(size: int) -> Floats:
    """Room in a file."""
    with tempfile.TemporaryFile() as handle:
        return np.memmap(handle, dtype=np.float64, mode="w+", shape=(size,))


def resting(rows: int, *, odometer: bool) -> SensorLog:
    """A drive of 20 s in a long rest, its columns mapped."""
    rng, hz = np.random.default_rng(rows), 100.0
    time = np.arange(rows) / hz
    push = 0.5 * (((time >= 20.0) & (time < 24.0)) * 1.0 - ((time >= 36.0) & (time < 40.0)))
    shaken = 1.0 + 7.0 * ((time >= 20.0) & (time < 40.0))
    made = {"time_s": time}
    for i, axis in enumerate("xyz"):
        force = 0.02 * shaken * rng.standard_normal(rows) + (0.0, push, 9.81)[i]
        made[f"acc_{axis}_m_s2"] = force
        made[f"gyr_{axis}_rad_s"] = 1e-3 * rng.standard_normal(rows)
    if odometer:
        made["odometer_m"] = np.cumsum(np.cumsum(push)) / hz**2
    columns = {name: mapped(rows) for name in made}
    for name, values in made.items():
        columns[name][:] = values
    return SensorLog("long", columns, dict.fromkeys(columns, ""), rows, rate_hz=hz, path="l.csv")


def small_pieces(monkeypatch: pytest.MonkeyPatch, rows: int) -> None:
    """Of so many rows, wherever columns of the length of a record are walked through."""
    for module in (motion_doubts, odometer_drive, odometer_path, snapping):
        monkeypatch.setattr(module, "PIECE_ROWS", rows)


@pytest.mark.parametrize(
    "options",
    [
        (MotionOptions(path=True), False),
        (MotionOptions(path=True, snap=True, end=(0.1, 35.0)), True),
    ],
)
def test_what_is_kept_does_not_follow_the_rows(
    options: tuple[MotionOptions, bool], monkeypatch: pytest.MonkeyPatch
) -> None:
    """40,000 more rows: two bytes of each are 80 kB, and each piece leaves some numbers."""
    small_pieces(monkeypatch, 5_000)
    monkeypatch.setattr(motion_pieces, "SAMPLED", 5_000)
    monkeypatch.setattr(odometer_drive, "LOOKED_AT", 5_000)
    monkeypatch.setattr(motion_pieces, "OVERLAP_S", 10.0)
    monkeypatch.setattr(zero_velocity, "EVERY", 50)
    pieces: Callable[..., object] = motion_pieces._pieces
    monkeypatch.setattr(motion_pieces, "_pieces", lambda n, overlap, _: pieces(n, overlap, 5_000))
    kept, asked = [], options[0]
    for rows in (25_000, 65_000):
        log = resting(rows, odometer=options[1])
        tracemalloc.start()
        found = judge_motion(log, asked, room=mapped)
        kept.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
        assert len(found.segments) >= 5
    assert kept[1] - kept[0] < 80_000


def driven(*, cycles: bool, known: bool) -> SensorLog:
    """Six legs with an odometer, a power cycle, and headings found at stops."""
    run = VehicleRun(
        usual_drive(6),
        heading=0.5,
        gyro=Triad(bias=np.array([0.0, 0.0, 0.002]), noise=0.001),
        accelerometer=Triad(noise=0.02),
        shake=0.1,
    )
    made = vehicle_log(run, np.random.default_rng(20))
    size = made.columns["time_s"].size
    more: dict[str, Floats] = {}
    if cycles:
        more["power_cycle"] = (np.arange(size) > size // 2).astype(np.float64)
    if known:
        more["heading_deg"] = np.full(size, np.nan)
        for row, heading in ((500, 28.0), (8500, 31.0), (16500, -36.0), (24800, 40.0)):
            more["heading_deg"][row] = heading
    return as_read(replace(made, columns={**made.columns, **more}))


@pytest.mark.parametrize(("cycles", "known"), [(False, True), (True, True), (True, False)])
def test_a_drive_in_pieces_is_the_drive_in_one(
    cycles: bool, known: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    log = driven(cycles=cycles, known=known)
    end = None if known else (50.0, -25.0)
    options = MotionOptions(path=True, snap=True, end=end, begin=(0.0, 0.0, 0.5))

    def answer() -> tuple[Motion, Floats]:
        found = judge_motion(log, options)
        assert found.path is not None
        return found, found.path.points

    whole, points = answer()
    small_pieces(monkeypatch, 1777)
    monkeypatch.setattr(odometer_path, "POINTS_AT_ONCE", 37)
    parts, others = answer()
    assert len(whole.snapped) == (3 if known else 1)
    np.testing.assert_allclose(others, points, rtol=1e-9, atol=1e-9)
    for one, other in zip(whole.snapped, parts.snapped, strict=True):
        assert other.heading_deg == pytest.approx(one.heading_deg, abs=1e-9)
        assert (other.from_m, other.to_m, other.kind) == (one.from_m, one.to_m, one.kind)


def test_a_heading_found_anywhere_in_a_stop_is_that_of_the_stop() -> None:
    """It was used in the last row of a stop alone; elsewhere it was ignored without a word."""
    log = driven(cycles=False, known=True)
    found = judge_motion(log, MotionOptions(path=True, snap=True))
    column = log.columns["heading_deg"]
    ends = [r[1] - 1 for r in Rests.of(np.isfinite(column)).runs]
    assert [s.kind for s in found.snapped] == ["linear"] * (len(ends) - 1)


def test_an_end_that_no_drift_of_the_heading_meets_is_told() -> None:
    """Newton's method gave 8.5 million degrees."""
    log = driven(cycles=False, known=False)
    options = MotionOptions(path=True, snap=True, end=(1e4, 1e4))
    found = judge_motion(log, options)
    free = judge_motion(log, MotionOptions(path=True))
    assert not found.snapped or abs(found.snapped[0].heading_deg) <= 180.0
    assert found.path is not None
    assert free.path is not None
    if not found.snapped:
        assert "end_not_met" in {w.code for w in found.warnings}
        assert found.path.end_m == free.path.end_m


def test_rests_of_a_mask_and_back() -> None:
    rng = np.random.default_rng(3)
    mask = np.repeat(rng.uniform(size=200) < 0.5, rng.integers(1, 9, 200))
    rests = Rests.of(mask)
    np.testing.assert_array_equal(rests.mask(), mask)
    np.testing.assert_array_equal(rests.mask(100, 300), mask[100:300])
    np.testing.assert_array_equal(rests.behind(123).mask(), mask[123:])
    moving = Rests(tuple(rests.moving), mask.size)
    np.testing.assert_array_equal(moving.mask(), ~mask)
    assert rests.count == np.count_nonzero(mask)
    halves = [(a + o, b + o) for o in (0, 400) for a, b in Rests.of(mask[o : o + 400]).runs]
    assert Rests.joined(halves, 800).runs == Rests.of(mask[:800]).runs
    assert math.isclose(rests.count, sum(b - a for a, b in rests.runs))
