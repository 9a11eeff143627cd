"""The bias of the index axis through attitudes that do not tell it: gate, coast, power cycles."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from surveyapp import api
from surveyapp.core.sensors.charts.north import _headings, north_charts
from surveyapp.core.sensors.rate.bias_track import WALK, StopSet, track_bias
from surveyapp.core.sensors.rate.indexing import solve_indexing
from surveyapp.core.sensors.rate.indexing_values import Setting, Stop
from surveyapp.core.simulate.rate.table_programmes import DEG_H
from surveyapp.domain.chart import Chart
from surveyapp.errors import SurveyError
from surveyapp_models.arrays import Floats
from surveyapp_models.rate.attitude import attitude_matrix, axis_rotation, earth_rate

SIGMA = 0.05 * DEG_H
LATITUDE = math.radians(35.0)
GOOD, EAST_WEST = (0.7, 0.1, -0.1), (0.0, 0.0, math.radians(88.0))
"""Heading, pitch and roll; of the second the index axis is level and points east."""


def index_set(
    rng: np.random.Generator, number: int, attitude: tuple[float, float, float], bias: float
) -> StopSet:
    """Four positions of a set, three minutes after the one before."""
    heading, pitch, roll = attitude
    body = attitude_matrix(heading=heading, pitch=pitch, roll=roll)
    stops = []
    for k in range(4):
        sensor = body @ axis_rotation(2, -k * math.pi / 2)
        rate = sensor.T @ earth_rate(LATITUDE) + np.array([0.0, 0.0, bias])
        rate = rate + rng.normal(0.0, SIGMA, 3)
        force = sensor.T @ np.array([0.0, 0.0, 9.80665]) + rng.normal(0.0, 1e-3, 3)
        stops.append(
            Stop(k * math.pi / 2, rate, np.full(3, SIGMA), force, np.full(3, 1e-3)),
        )
    return StopSet(number, 180.0 * number, stops)


def test_through_the_bad_attitude_the_track_coasts() -> None:
    """rate.md: alone 2.26, gate and coast .037 deg/h; here 12 sets of each kind."""
    rng = np.random.default_rng(11)
    bias = 3.0 * DEG_H
    sets = [index_set(rng, k, GOOD, bias) for k in range(6)]
    sets += [index_set(rng, k, EAST_WEST, bias) for k in range(6, 18)]
    sets += [index_set(rng, k, GOOD, bias) for k in range(18, 24)]
    tracked = track_bias(sets, Setting(LATITUDE))
    bad = tracked[6:18]
    assert all(one.gated for one in bad)
    assert not any(one.gated for one in (*tracked[:6], *tracked[18:]))
    followed = [one.bias or 0.0 for one in tracked]
    assert max(abs(b - bias) for b in followed) < 4.0 * 0.05 * DEG_H
    alone = np.array([one.alone for one in bad if one.alone is not None]) - bias
    assert np.sqrt(np.mean(alone**2)) > 5.0 * np.sqrt(
        np.mean((np.array([o.bias for o in bad], dtype=np.float64) - bias) ** 2)
    )


def test_a_set_that_contradicts_the_track_is_left_out() -> None:
    rng = np.random.default_rng(12)
    sets = [index_set(rng, k, GOOD, (9.0 if k == 4 else 1.0) * DEG_H) for k in range(8)]
    tracked = track_bias(sets, Setting(LATITUDE))
    assert [one.number for one in tracked if one.gated] == [4]
    assert tracked[4].reason == "contradicts the track"
    gate, alone, foretold = tracked[4].gate, tracked[4].alone, tracked[4].foretold
    assert gate is not None
    assert alone is not None
    assert foretold is not None
    assert abs(alone - foretold) > gate


def log_of(sets: list[StopSet], cycles: list[float], *, rows: int = 40) -> str:
    """A log with the means of each position and white noise about them."""
    rng = np.random.default_rng(13)
    head = "time_s,set,power_cycle,index_angle_deg," + ",".join(
        [f"gyr_{a}_rad_s" for a in "xyz"] + [f"acc_{a}_m_s2" for a in "xyz"]
    )
    lines, clock = [head], 0.0
    for one, cycle in zip(sets, cycles, strict=True):
        for stop in one.stops:
            size = math.sqrt(rows)
            noise: Floats = np.hstack(
                [
                    rng.normal(0.0, size * SIGMA, (rows, 3)),
                    rng.normal(0.0, size * 1e-3, (rows, 3)),
                ]
            )
            noise -= noise.mean(axis=0)
            for row in np.concatenate([stop.rate, stop.force]) + noise:
                clock += 0.5
                cells = [clock, one.number, cycle, math.degrees(stop.angle), *row.tolist()]
                lines.append(",".join(f"{cell:.10g}" for cell in cells))
    return "\n".join(lines) + "\n"


def test_after_a_power_cycle_the_track_begins_anew(tmp_path: Path) -> None:
    rng = np.random.default_rng(14)
    sets = [index_set(rng, k, GOOD, (2.0 if k < 2 else -14.0) * DEG_H) for k in range(4)]
    file = tmp_path / "log.csv"
    file.write_text(log_of(sets, [0, 0, 1, 1]))
    found = api.north(file, method="indexing", options={"latitude": 35.0})
    assert found.met
    assert "power_cycles" in {w.code for w in found.warnings}
    assert found.value("bias_z") == pytest.approx(-14.0, abs=0.3)
    tracking = found.extra["tracking"]
    assert [item["gated"] for item in tracking] == [False] * 4
    assert tracking[0]["foretold"] is None
    assert tracking[2]["foretold"] is None
    bias, heading = north_charts(found)
    assert isinstance(bias, Chart)
    assert isinstance(heading, Chart)
    names = [series.name for series in bias.series]
    assert names.count("gate") == 2
    assert all(len(s.points) == 2 for s in bias.series if s.name == "gate")
    assert len(heading.series[0].points) == 4
    # without the column the second half contradicts the first, and is left out
    file.write_text(log_of(sets, [0, 0, 0, 0]))
    blind = api.north(file, method="indexing", options={"latitude": 35.0, "track": True})
    assert [item["gated"] for item in blind.extra["tracking"]] == [False, False, True, True]


def test_rows_without_a_set_are_a_problem_in_words(tmp_path: Path) -> None:
    file = tmp_path / "log.csv"
    text = log_of([index_set(np.random.default_rng(15), 1, GOOD, 0.0)], [math.nan])
    file.write_text(text)
    with pytest.raises(SurveyError, match="power_cycle"):
        api.north(file, method="indexing", options={"latitude": 35.0})


def test_a_declination_without_sigma_has_that_of_a_model(tmp_path: Path) -> None:
    """And the first heading counts as exact only where that is told."""
    rng = np.random.default_rng(16)
    names = [f"gyr_{a}_rad_s" for a in "xyz"] + [f"acc_{a}_m_s2" for a in "xyz"]
    lines = [",".join(["phase", "time_s", *names])]
    for k in range(4000):
        phase = ("warm-up", "filter", "level", "run")[k // 1000]
        row = [*rng.normal(0.0, 1e-5, 3), *rng.normal(0.0, 2e-3, 2), rng.normal(9.8, 2e-3)]
        lines.append(f"{phase},{0.1 * k:.1f}," + ",".join(f"{v:.9g}" for v in row))
    file = tmp_path / "run.csv"
    file.write_text("\n".join(lines) + "\n")
    base = {"latitude": 47.0, "initial_heading_deg": 10.0, "initial_reference": "MAGNETIC"}
    sigmas, codes = [], []
    for more in (
        {"declination": "2.6"},
        {"declination": "2.6,0", "initial_heading_sigma_deg": 0.0},
        {"declination": "2.6,0.3", "initial_heading_sigma_deg": 0.4},
    ):
        found = api.north(file, method="rotation", options={**base, **more})
        sigmas.append((found.direction.sigma_arcsec or 0.0) / 3600.0)
        codes.append({w.code for w in found.warnings})
    assert sigmas[0] == pytest.approx(math.hypot(sigmas[1], 0.5), rel=1e-6)
    assert sigmas[2] == pytest.approx(math.hypot(sigmas[1], 0.3, 0.4), rel=1e-6)
    assert {"no_declination_sigma", "initial_heading_exact"} <= codes[0]
    assert not {"no_declination_sigma", "initial_heading_exact"} & (codes[1] | codes[2])


def test_the_stops_of_a_set_count_once() -> None:
    """The first set of a track knows what the set alone knows, and no more."""
    rng = np.random.default_rng(16)
    tilted = (0.7, math.radians(20.0), math.radians(-30.0))
    sets = [index_set(rng, k, tilted, 3.0 * DEG_H) for k in range(2)]
    tracked = track_bias(sets, Setting(LATITUDE))
    alone = [solve_indexing(one.stops, Setting(LATITUDE)).roots[0] for one in sets]
    spread = [math.sqrt(root.covariance[5, 5]) for root in alone]
    first, second = (math.sqrt(one.indexed.roots[0].covariance[5, 5]) for one in tracked)
    assert first == pytest.approx(spread[0], rel=1e-9)
    # two independent values of the bias, the first older by three minutes of its walk
    older = math.hypot(spread[0], WALK * math.sqrt(180.0 / 3600.0))
    assert second == pytest.approx(1.0 / math.hypot(1.0 / older, 1.0 / spread[1]), rel=0.03)


@pytest.mark.parametrize(
    ("headings", "drawn", "style"),
    [
        ([359.0, 1.0, 3.0], [359.0, 361.0, 363.0], "line"),
        ([147.0, 118.0, 270.0, 42.0], [147.0, 118.0, 270.0, 42.0], "dots"),
    ],
)
def test_a_heading_is_drawn_through_north_but_not_around_the_circle(
    headings: list[float], drawn: list[float], style: str
) -> None:
    """A unit that was set up anew in each set was drawn to 400 degrees."""
    items = [
        {"time_s": float(k), "heading_deg": h, "heading_sigma_deg": 0.1, "axis": "y"}
        for k, h in enumerate(headings)
    ]
    (chart,) = _headings(items)
    assert isinstance(chart, Chart)
    assert [y for _, y in chart.series[0].points] == pytest.approx(drawn)
    assert chart.series[0].style == style
