"""Records of motion whose columns are not what they are taken for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from surveyapp.core.sensors.rate.motion_doubts import odometer_problems, record_doubts
from surveyapp.core.sensors.rate.rests import Rests
from surveyapp.domain.sensor_log import SensorLog
from surveyapp_models.arrays import Floats

ROWS = 2000


def log(**changed: Floats) -> SensorLog:
    """Ten seconds of rest and ten of driving at 100 Hz, 2 m/s."""
    moved = np.concatenate([np.zeros(ROWS // 2), 0.02 * np.arange(ROWS // 2)])
    columns: dict[str, Floats] = {"time_s": np.asarray(np.arange(ROWS) / 100.0)}
    columns |= {f"acc_{a}_m_s2": np.full(ROWS, 9.8 * (a == "z")) for a in "xyz"}
    columns |= {"odometer_m": moved, **changed}
    units = dict.fromkeys(columns, "1")
    return SensorLog(id="drive", columns=columns, units=units, size=ROWS, rate_hz=100.0)


RESTS = Rests(((0, ROWS // 2),), ROWS)


def codes(record: SensorLog, *, snapping: bool = False) -> list[str]:
    """Of what is doubted."""
    return [w.code for w in record_doubts(record, RESTS, snapping=snapping)]


def test_a_record_in_order_is_not_doubted() -> None:
    assert odometer_problems(log()) == []
    assert codes(log(), snapping=True) == []


def test_an_odometer_that_counts_back_is_refused_and_one_that_rocks_is_not() -> None:
    moved = log().columns["odometer_m"]
    (problem,) = odometer_problems(log(odometer_m=moved[::-1]))
    assert "20.0 m" in problem.found
    assert odometer_problems(log(odometer_m=moved + 0.01 * np.sin(np.arange(ROWS) / 50.0))) == []


def test_an_odometer_that_stands_while_the_sensors_move_is_told() -> None:
    assert codes(log(odometer_m=np.full(ROWS, 5.0))) == ["odometer_stands"]


@pytest.mark.parametrize("along", ["x", "y"])
def test_gravity_along_another_axis_is_told(along: str) -> None:
    swapped = {"acc_z_m_s2": np.zeros(ROWS), f"acc_{along}_m_s2": np.full(ROWS, 9.8)}
    assert codes(log(**swapped)) == ["z_not_up"]


def test_snapping_without_an_odometer_is_told() -> None:
    whole = log()
    columns = {name: v for name, v in whole.columns.items() if name != "odometer_m"}
    assert codes(replace(whole, columns=columns), snapping=True) == ["no_odometer"]
