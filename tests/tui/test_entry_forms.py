"""Every accepted way of typing a reading means what a surveyor means by it."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from surveyapp.core.observing.typed_rows import EntryError, complete_angle, complete_number
from surveyapp_models.angles import ARCSEC, AngleUnit, parse_angle, wrap_pi

NEAR = parse_angle("179-02-10", AngleUnit.DMS)


@pytest.mark.parametrize(
    ("typed", "text"),
    [
        ("179-01-56", "179-01-56"),
        ("179 01 56", "179-01-56"),
        ("179:1:56.5", "179-01-56.5"),
        ("179°01'56\"", "179-01-56"),
        ("01-56", "179-01-56"),
        ("01 56.0", "179-01-56.0"),
        ("56", "179-01-56"),
        ("40", "179-01-40"),
        ("39.5", "179-02-39.5"),
        ("58 30", "178-58-30"),
    ],
)
def test_dms_in_full_and_in_part(typed: str, text: str) -> None:
    entry = complete_angle(typed, unit=AngleUnit.DMS, near=NEAR)
    assert entry.text == text
    assert entry.value == pytest.approx(parse_angle(text, AngleUnit.DMS), abs=1e-12)
    assert entry.unit == "dms"


def test_packed_means_minutes_and_seconds_only_where_chosen() -> None:
    packed = complete_angle("179.0156", unit=AngleUnit.DMS, packed=True)
    assert packed.text == "179-01-56"
    assert complete_angle("179.01567", unit=AngleUnit.DMS, packed=True).text == "179-01-56.7"
    with pytest.raises(EntryError, match="packed degrees or decimal"):
        complete_angle("179.0156", unit=AngleUnit.DMS)
    with pytest.raises(EntryError):
        complete_angle("179.0176", unit=AngleUnit.DMS, packed=True)


def test_other_units_by_suffix_and_by_project() -> None:
    assert complete_angle("198.9247", unit=AngleUnit.GON).value == pytest.approx(
        math.radians(198.9247 * 0.9)
    )
    gon = complete_angle("198.9247g", unit=AngleUnit.DMS)
    assert (gon.text, gon.unit) == ("198.9247", "gon")
    assert complete_angle("179.0322d", unit=AngleUnit.DMS).value == pytest.approx(
        math.radians(179.0322)
    )
    near = math.radians(198.99 * 0.9)
    assert complete_angle(".0247", unit=AngleUnit.GON, near=near).text == "199.0247"


def test_a_part_needs_something_to_complete_it_from() -> None:
    with pytest.raises(EntryError, match="not known yet"):
        complete_angle("56", unit=AngleUnit.DMS)


@pytest.mark.parametrize(
    "typed", ["365-00-00", "179-61-00", "-1-00-00", "179,5", "abc", "", "401g", "1-2-3-4", "75"]
)
def test_the_impossible_is_refused(typed: str) -> None:
    with pytest.raises(EntryError):
        complete_angle(typed, unit=AngleUnit.DMS, near=NEAR)


def test_completion_crosses_the_zero_of_the_circle() -> None:
    assert complete_angle("59-50", unit=AngleUnit.DMS, near=0.001 * ARCSEC).text == "359-59-50"
    near = parse_angle("359-59-58", AngleUnit.DMS)
    assert complete_angle("03", unit=AngleUnit.DMS, near=near).text == "0-00-03"


@settings(max_examples=200, deadline=None, derandomize=True)
@given(
    near=st.floats(0.0, 2.0 * math.pi - 1e-9),
    minutes=st.integers(0, 59),
    seconds=st.integers(0, 59),
)
def test_a_completed_reading_is_the_nearest_with_these_digits(
    near: float, minutes: int, seconds: int
) -> None:
    full = complete_angle(f"{minutes:02d} {seconds:02d}", unit=AngleUnit.DMS, near=near)
    assert abs(wrap_pi(full.value - near)) <= 1800.0 * ARCSEC * (1.0 + 1e-9)
    short = complete_angle(f"{seconds:02d}", unit=AngleUnit.DMS, near=near)
    assert abs(wrap_pi(short.value - near)) <= 30.0 * ARCSEC * (1.0 + 1e-9)
    again = complete_angle(full.text, unit=AngleUnit.DMS)
    assert again.value == full.value


def test_scale_readings_keep_their_sign_and_decimals() -> None:
    assert complete_number("+11.40", unit="div", largest=1000.0).text == "+11.40"
    assert complete_number("−7.4", unit="div", largest=1000.0).value == -7.4
    with pytest.raises(EntryError, match="impossible"):
        complete_number("99999", unit="div", largest=1000.0)
    with pytest.raises(EntryError):
        complete_number("11,4", unit="div", largest=1000.0)
