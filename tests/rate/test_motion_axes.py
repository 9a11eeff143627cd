"""Columns of a drive that contradict what they are taken for; bench rate_axes has whole tables."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from bench.rate_axes import FAULTS, ROADS, drive, spoilt, told
from surveyapp.core.sensors.rate.motion_axes import WITH_ODOMETER, contradicted
from surveyapp.core.sensors.rate.motion_log import MotionOptions, judge_motion


def named(fault: str) -> str:
    """The code that tells a fault."""
    return "forward_is_x" if fault.startswith("axes") else fault


@pytest.mark.parametrize("road", ["level", "hills of 3 degrees"])
def test_each_fault_is_told_by_its_name_and_the_drive_in_order_by_none(road: str) -> None:
    for seed in range(2):
        log = drive(ROADS[road], np.random.default_rng([seed, 7]))
        for odometer in (True, False):
            assert told(log, odometer=odometer) == ""
            for fault in FAULTS:
                known = odometer or fault != "looks_back"
                code = told(spoilt(log, fault), odometer=odometer)
                assert code == (named(fault) if known else ""), (seed, odometer, fault)


def test_nothing_is_said_of_what_a_straight_level_drive_does_not_show() -> None:
    """No turn: neither the sense of the vertical rate nor its unit leaves a trace."""
    for seed in range(3):
        log = drive(ROADS["level, no turn"], np.random.default_rng([seed, 8]))
        assert told(log, odometer=True) == ""
        for fault in ("turning_reversed", "rates_too_small"):
            assert told(spoilt(log, fault), odometer=True) == ""
        assert told(spoilt(log, "axes_exchanged"), odometer=False) == "forward_is_x"


@pytest.mark.statistical
def test_drives_in_order_are_not_doubted() -> None:
    """Stated .001 a record: 2 of 21 would come by chance once in 4800 times."""
    alarms = sum(
        told(drive(road, np.random.default_rng([number, k, 9])), odometer=k % 2 == 0) != ""
        for number, road in enumerate(ROADS.values())
        for k in range(3)
    )
    assert alarms <= 1


def test_a_gyro_that_is_noisy_is_not_in_degrees() -> None:
    """In a larger unit the same gyro would be quieter: that alone says nothing."""
    road = replace(ROADS["noisy gyro, smooth, no turn"], gyro=0.1)
    for seed in range(3):
        log = drive(road, np.random.default_rng([seed, 10]))
        assert told(log, odometer=False) == ""


def test_a_contradicted_drive_ends_with_exit_one_and_says_what_to_do() -> None:
    log = spoilt(drive(ROADS["level"], np.random.default_rng(4)), "rates_in_degrees")
    found = judge_motion(log, MotionOptions())
    (warning,) = [w for w in found.warnings if w.code == "rates_in_degrees"]
    assert "state that unit" in warning.text
    assert not found.met


def test_without_a_way_from_stop_to_stop_nothing_is_known() -> None:
    assert contradicted(iter(()), WITH_ODOMETER) is None


def test_hypotheses_are_proper_changes_of_axes() -> None:
    """Turned and reversed units are rotations; exchanged columns are a mirror."""
    values = np.array([[1.0, 2.0, 3.0]])
    for name, columns in WITH_ODOMETER.items():
        sign = float(np.linalg.det(np.array(columns.axes)))
        assert sign == pytest.approx(-1.0 if name == "axes_exchanged" else 1.0)
        size = float(np.linalg.norm(columns.forces_of(values)))
        assert size == pytest.approx(math.sqrt(14.0))
    turned = WITH_ODOMETER["axes_turned"].forces_of(values)
    np.testing.assert_array_equal(turned, [[-2.0, 1.0, 3.0]])
