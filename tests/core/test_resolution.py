"""The reading resolution: the coarsest usual step that divides every reading."""

import math

import numpy as np
import pytest

from surveyapp.core.book.resolution import infer_resolution
from surveyapp_models.angles import ARCSEC, AngleUnit, parse_angle

STEPS = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 6.0, 10.0, 20.0, 30.0, 60.0)


@pytest.mark.parametrize("step", STEPS)
def test_each_usual_step_is_found_again(step: float) -> None:
    rng = np.random.default_rng(int(step * 10))
    counts = rng.integers(0, int(1296000 / step), size=40)
    readings = [float(k * step) * ARCSEC for k in (*counts, 1)]
    assert infer_resolution(readings, "dms") == pytest.approx(step * ARCSEC)


def test_johannesburg_was_read_to_one_second() -> None:
    texts = ("179-01-56", "181-17-26", "179-06-05", "181-12-59")
    values = [parse_angle(text, AngleUnit.DMS) for text in texts]
    assert infer_resolution(values, "dms") == pytest.approx(ARCSEC)


def test_tape_zeros_to_a_tenth() -> None:
    assert infer_resolution([11.4, -7.4, 10.9, -7.1], "div") == pytest.approx(0.1)
    assert infer_resolution([11.5, -7.5, 10.0], "div") == pytest.approx(0.5)


def test_gon_in_steps_of_its_own() -> None:
    values = [parse_angle(text, AngleUnit.GON) for text in ("200.1234", "399.9998")]
    assert infer_resolution(values, "gon") == pytest.approx(0.0002 * math.pi / 200)


def test_without_readings_nothing_is_coarse() -> None:
    assert infer_resolution([], "dms") == pytest.approx(0.1 * ARCSEC)


def test_a_reading_that_is_nearly_a_multiple_of_a_coarse_step_is_none() -> None:
    # 220.0011 is no multiple of 20: 4 seconds of arc are not nothing
    for unit, full in (("deg", 360.0), ("gon", 400.0)):
        values = [text * 2.0 * math.pi / full for text in (40.0, 220.0011)]
        assert infer_resolution(values, unit) == pytest.approx(0.0001 * 2.0 * math.pi / full)
    assert infer_resolution([10.0, 10.01], "div") == pytest.approx(0.01)


def test_readings_that_are_round_by_chance_are_not_coarse() -> None:
    for unit, full in (("deg", 360.0), ("gon", 400.0)):
        values = [text * 2.0 * math.pi / full for text in (40.0, 220.0)]
        step = infer_resolution(values, unit)
        assert step == pytest.approx(0.02 * 2.0 * math.pi / full)
        assert step < 75.0 * ARCSEC
    assert infer_resolution([10.0, -10.0, 5.0], "div") == pytest.approx(1.0)
