"""Zeros that follow the temperature or wander, in records from rotations of the test's own."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from surveyapp.diagnosis.sensors.diagnosis import diagnose_sensor
from surveyapp.diagnosis.sensors.records import compass_record
from surveyapp.domain.sensor_log import SensorLog
from surveyapp_models.arrays import Floats

FIELD = 50.0 * np.array([0.0, np.cos(np.radians(65.0)), -np.sin(np.radians(65.0))])
ROWS, RATE = 3000, 20.0


def tumbled(zeros: Floats, rng: np.random.Generator, *, attitude: bool, warm: Floats) -> SensorLog:
    """A magnetometer turned by hand through all attitudes, its zeros as given, shape (n, 3)."""
    time = np.arange(ROWS) / RATE
    knots = np.arange(0.0, time[-1] + 4.0, 3.0)
    turns = np.cumsum(rng.normal(size=(knots.size, 3)) * 0.9, axis=0)
    vectors = np.column_stack([np.interp(time, knots, turns[:, k]) for k in range(3)])
    body = Rotation.from_euler("zyx", vectors)
    mag = body.inv().apply(FIELD) + zeros + 0.3 * rng.normal(size=(ROWS, 3))
    columns = {"time_s": time, "temperature_c": warm}
    columns |= {f"mag_{a}_uT": mag[:, i] for i, a in enumerate("xyz")}
    if attitude:
        q = body.as_quat()
        columns |= {f"ref_q{a}": q[:, i] for i, a in zip((3, 0, 1, 2), "wxyz", strict=True)}
    return SensorLog("compass", columns, dict.fromkeys(columns, "1"), ROWS, rate_hz=RATE)


def names_in(log: SensorLog) -> list[dict[str, object]]:
    found = diagnose_sensor(compass_record(log), identity="log", n_log=log.size)
    return list(found.document["adopted"])


@pytest.mark.parametrize("attitude", [True, False])
def test_zeros_that_are_none_at_twenty_degrees_are_no_hard_iron(attitude: bool) -> None:
    """The mean of the record is 25 degrees: there the zeros are (2.5, -1.5, 1) uT."""
    rng = np.random.default_rng(5)
    warm = 25.0 + 4.0 * np.sin(np.arange(ROWS) / 400.0)
    slope = np.array([0.5, -0.3, 0.2])
    (item,) = names_in(tumbled(np.outer(warm - 20.0, slope), rng, attitude=attitude, warm=warm))
    assert item["effect"] == "temperature"
    assert item["grid"] == [{"name": "datum_c", "value": 20.0, "unit": "C"}]
    found = {c["name"]: (c["value"], c["sigma"]) for c in item["coefficients"]}  # type: ignore[attr-defined]
    for axis, true in zip("xyz", slope, strict=True):
        value, sigma = found[f"temperature_{axis}"]
        assert abs(value - true) < 4.0 * sigma < 0.1


def test_zeros_that_wander_are_given_no_name_without_the_attitude() -> None:
    """Three walks, 6 uT at their end: as noise of the size alone 4 of 6 were given a name."""
    named = 0
    for seed in range(6):
        rng = np.random.default_rng([seed, 6])
        walk = np.cumsum(rng.normal(size=(ROWS, 3)), axis=0) * 6.0 / np.sqrt(ROWS)
        named += bool(names_in(tumbled(walk, rng, attitude=False, warm=np.full(ROWS, 20.0))))
    assert named <= 1  # .08 are asked: two or more of six have a probability of .08
