"""Exchanged or reversed axes and another unit of hand-held stops are found by gravity."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from surveyapp.core.sensors.rate.multi_position_log import (
    MultiPositionOptions,
    calibrate_multi_position,
)
from surveyapp.core.simulate.rate.recipes import hand_held_log, hand_run
from surveyapp.domain.sensor_log import SensorLog
from surveyapp.errors import SurveyError
from surveyapp_models.arrays import Floats
from tests.rate.logs import as_read

Columns = dict[str, Floats]


@pytest.fixture(scope="module")
def log() -> SensorLog:
    rng = np.random.default_rng(2)
    run = replace(hand_run({"stops": 16.0}, rng), interval_s=0.04, warmth=0.0)
    return as_read(hand_held_log(run, rng))


def exchanged(columns: Columns) -> None:
    columns["acc_x_m_s2"], columns["acc_y_m_s2"] = columns["acc_y_m_s2"], columns["acc_x_m_s2"]


def reversed_gyro(columns: Columns) -> None:
    columns["gyr_z_rad_s"] = -columns["gyr_z_rad_s"]


def degrees(columns: Columns) -> None:
    for axis in "xyz":
        columns[f"gyr_{axis}_rad_s"] = np.degrees(columns[f"gyr_{axis}_rad_s"])


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (exchanged, "acc (y, x, z)"),
        (reversed_gyro, "gyr (x, y, -z)"),
        (degrees, "as deg/s"),
    ],
)
def test_gravity_after_turns_tells_the_axes(
    log: SensorLog, change: Callable[[Columns], None], told: str
) -> None:
    columns = dict(log.columns)
    change(columns)
    with pytest.raises(SurveyError) as caught:
        calibrate_multi_position(replace(log, columns=columns), MultiPositionOptions())
    (problem,) = caught.value.problems
    assert told in problem.expected
    assert calibrate_multi_position(log, MultiPositionOptions()).extra["gravity_direction"]
