"""The earth's rate along the axis of a table that leans, against that of attitudes."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from surveyapp.core.sensors.rate.position_log import placed_stretches
from surveyapp.core.sensors.rate.six_position_log import (
    SixPositionOptions,
    calibrate_six_positions,
)
from surveyapp.core.sensors.rate.table_axis import axis_rate
from surveyapp.core.sensors.rate.table_log import motion_of
from surveyapp.core.sensors.rate.temperature_log import calibrate_temperature
from surveyapp.core.sensors.rate.temperature_nodes import TemperatureOptions
from surveyapp.core.sensors.rate.turning import TableMotion
from surveyapp.core.simulate.rate.log import SimulatedLog
from surveyapp.core.simulate.rate.recipes import LATITUDE, example_unit
from surveyapp.core.simulate.rate.table_programmes import (
    DEG_H,
    ImuOnTable,
    TableRun,
    six_position_log,
    temperature_log,
)
from surveyapp.diagnosis.engine import diagnose
from surveyapp.domain.sensor_entry import SensorLogEntry
from surveyapp.workflows.rate_case import case_of_log
from surveyapp_models.rate.attitude import attitude_matrix, earth_rate
from surveyapp_models.rate.turntable import POSITIONS, Table
from tests.rate.logs import as_read

AZIMUTH = 2.39


def unit(tilt_deg: float) -> ImuOnTable:
    """A unit without noise on a table that leans both ways."""
    made = example_unit({}, TableRun(turns=2.0, interval_s=0.25, pause_s=1.0))
    tilt = math.radians(tilt_deg)
    return replace(
        made,
        gyro=replace(made.gyro, noise=0.0),
        accelerometer=replace(made.accelerometer, noise=0.0),
        table=Table(LATITUDE, AZIMUTH, tilt_along=tilt, tilt_across=0.5 * tilt),
        warm_up_s=10.0,
        static_s=5.0,
    )


def leaning(tilt_deg: float, *, positions: tuple[str, ...] = POSITIONS) -> SimulatedLog:
    return six_position_log(unit(tilt_deg), np.random.default_rng(1), positions=positions)


@pytest.mark.parametrize("tilt_deg", [0.0, 0.3, 5.0, 20.0])
def test_the_rate_along_a_leaning_axis(tilt_deg: float) -> None:
    tilt = math.radians(tilt_deg)
    table = attitude_matrix(heading=AZIMUTH, pitch=tilt, roll=0.5 * tilt)
    expected = float(table[:, 2] @ earth_rate(LATITUDE))
    log = as_read(leaning(tilt_deg))
    motion = motion_of(log)
    assert isinstance(motion, TableMotion)
    placed, problems = placed_stretches(log, motion, [1] * log.size, ("position",))
    assert not problems
    for place in placed:
        axis = "xyz".index(place.position[0])
        rate, measured = axis_rate(log, place.turned, axis, latitude=LATITUDE)
        assert measured
        # scale errors of .1 % in what comes round, that is of the tilt's share
        assert rate == pytest.approx(expected, abs=(1e-4 + 0.005 * tilt) * 10.5 * DEG_H)


def test_one_position_of_a_pair_on_a_leaning_table() -> None:
    """At two degrees the earth rate along the axis differs by .13 deg/h from the vertical one."""
    kept = tuple(p for p in POSITIONS if p != "x-")
    found = calibrate_six_positions(
        as_read(leaning(2.0, positions=kept)), SixPositionOptions(latitude=LATITUDE)
    )
    bias = found.value("bias_x")
    assert bias == pytest.approx(5.0, abs=0.005)


def test_the_biases_of_a_chamber_on_a_leaning_table() -> None:
    """One position per direction: a third of the .13 deg/h along each axis stood in every bias."""
    made = unit(2.0)
    log = temperature_log(
        made,
        np.random.default_rng(1),
        nodes_c=(5.0, 20.0, 30.0),
        at=lambda _: (made.gyro, made.accelerometer),
    )
    found = calibrate_temperature(as_read(log), TemperatureOptions(latitude=LATITUDE))
    for node in found.extra["nodes"]:
        values = {p["name"]: p["value"] for p in node["parameters"]}
        biases = [values[f"bias_{a}"] for a in "xyz"]
        assert biases == pytest.approx([5.0, -3.0, 2.0], abs=0.005)


def test_without_a_latitude_gravity_is_not_blamed_for_the_earth_rate() -> None:
    """10.8 deg/h along every axis that points up, in a noise of .13 deg/h a stop, two rounds."""
    log = replace(as_read(leaning(0.3, positions=POSITIONS + POSITIONS)), path="log")
    rng = np.random.default_rng(3)
    first = log.texts["position"].index("z-")
    second = log.texts["position"].index("x+", first)
    gyros = {
        c: v + rng.normal(0.0, 2.0 * DEG_H, v.size)
        for c, v in log.columns.items()
        if c.startswith("gyr_")
    }
    rounds = np.where(np.arange(log.size) < second, 1.0, 2.0)
    log = replace(log, columns={**log.columns, **gyros, "round": rounds})
    made = case_of_log(log, SensorLogEntry("log", "rate", ""))
    assert [w.code for w in made.warnings] == ["latitude_unknown"]
    found = diagnose(made.case, advise=False)
    assert found.verdict == "adequate"
    gravity = next(c for c in found.candidates if c.effect == "g_sensitivity")
    assert gravity.verdict == "not_separable"
    known = case_of_log(log, SensorLogEntry("log", "rate", "", latitude_deg=45.77))
    assert not known.warnings
    told = diagnose(known.case, advise=False)
    assert told.verdict == "adequate"
    gravity = next(c for c in told.candidates if c.effect == "g_sensitivity")
    assert gravity.verdict == "not_significant"
