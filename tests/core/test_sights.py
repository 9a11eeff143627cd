import math

import numpy as np
import pytest

from surveyapp.core.swing.sights import (
    drift_probability,
    eccentric_correction,
    reduce_sights,
    zenith_angle,
)
from surveyapp.domain.readings import FieldBook
from surveyapp.io.fieldbook import parse_field_book
from surveyapp_models.angles import ARCSEC, RHO_ARCSEC, AngleUnit, parse_angle, wrap_pi

HEAD = "seq,elapsed_s,kind,value,unit,face,side,target\n"


def book(*lines: str) -> FieldBook:
    return parse_field_book(
        HEAD + "".join(f"{i},{line}\n" for i, line in enumerate(lines, 1)),
        angle_unit=AngleUnit.DMS,
        where="test",
    )


def dms(text: str) -> float:
    return parse_angle(text, AngleUnit.DMS)


def test_both_faces_before_and_after_by_hand() -> None:
    sights = reduce_sights(
        book(
            ",backsight,10-00-10,,L,,",
            ",backsight,190-00-30,,R,,",
            ",reversal,99-00-00,,,L,",
            ",reversal,101-00-00,,,R,",
            ",reversal,99-00-10,,,L,",
            ",backsight,10-00-14,,L,,",
            ",backsight,190-00-34,,R,,",
        ),
        "T",
        default_target="T",
    )
    assert sights is not None
    assert sights.line_reading == pytest.approx(dms("10-00-22"), abs=1e-12)
    assert sights.collimation == pytest.approx(-10 * ARCSEC)  # half of left minus right
    assert sights.drift == pytest.approx(4 * ARCSEC)
    assert sights.dof == 1
    assert sights.cofactor == pytest.approx(0.25)


def test_drift_is_taken_out_at_the_middle_of_the_observation() -> None:
    # the tripod turns by 1" per 100 s: sights at 0 s and 1000 s, the swing from 100 to 500 s
    sights = reduce_sights(
        book(
            "0,backsight,10-00-00,,L,,",
            "0,backsight,190-00-00,,R,,",
            "100,reversal,99-00-00,,,L,",
            "300,reversal,101-00-00,,,R,",
            "500,reversal,99-00-10,,,L,",
            "1000,backsight,10-00-10,,L,,",
            "1000,backsight,190-00-10,,R,,",
        ),
        "T",
        default_target="T",
    )
    assert sights is not None
    assert sights.line_reading == pytest.approx(dms("10-00-03"), abs=1e-12)


def test_sights_across_the_zero_of_the_circle() -> None:
    sights = reduce_sights(
        book(",backsight,359-59-50,,L,,", ",backsight,180-00-30,,R,,"), "T", default_target="T"
    )
    assert sights is not None
    assert wrap_pi(sights.line_reading - dms("0-00-10")) == pytest.approx(0.0, abs=1e-12)


def test_several_targets_are_kept_apart() -> None:
    rows = book(",backsight,10-00-00,,L,,", ",backsight,50-00-00,,L,,B")
    own = reduce_sights(rows, "A", default_target="A")
    other = reduce_sights(rows, "B", default_target="A")
    assert own is not None
    assert other is not None
    assert math.degrees(other.line_reading - own.line_reading) == pytest.approx(40.0)
    assert own.collimation is None
    assert reduce_sights(rows, "C", default_target="A") is None


def test_left_before_and_right_after_cannot_tell_drift_from_collimation() -> None:
    sights = reduce_sights(
        book(
            ",backsight,10-00-10,,L,,",
            ",reversal,99-00-00,,,L,",
            ",reversal,101-00-00,,,R,",
            ",backsight,190-00-30,,R,,",
        ),
        "T",
        default_target="T",
    )
    assert sights is not None
    assert sights.drift is None
    assert sights.line_reading == pytest.approx(dms("10-00-20"), abs=1e-12)


def test_line_reading_sigma_equals_monte_carlo() -> None:
    rng = np.random.default_rng(3)
    values = []
    for _ in range(400):
        noise = rng.normal(0.0, 2.0, 4)
        rows = []
        for place in (0, 2):
            left = 36000.0 + noise[place]
            right = 36000.0 + 648000.0 + noise[place + 1]
            rows.append([left, right])

        def line(seconds: float, face: str) -> str:
            d, rest = divmod(seconds, 3600.0)
            m, s = divmod(rest, 60.0)
            return f",backsight,{d:.0f}-{m:02.0f}-{s:06.3f},,{face},,"

        sights = reduce_sights(
            book(
                line(rows[0][0], "L"),
                line(rows[0][1], "R"),
                ",reversal,99-00-00,,,L,",
                ",reversal,101-00-00,,,R,",
                line(rows[1][0], "L"),
                line(rows[1][1], "R"),
            ),
            "T",
            default_target="T",
        )
        assert sights is not None
        values.append((sights.line_reading * RHO_ARCSEC - 36000.0, sights.sum_of_squares))
    errors = np.array(values)[:, 0]
    # chi-square bounds of the variance of 400 draws, 99.9 %
    assert 0.77 < np.var(errors) / (0.25 * 4.0) < 1.26
    assert 0.77 < np.mean(np.array(values)[:, 1]) * RHO_ARCSEC**2 / 4.0 < 1.30


def test_drift_probability_is_small_for_a_large_drift_only() -> None:
    still = reduce_sights(
        book(
            ",backsight,10-00-00,,L,,",
            ",backsight,190-00-00,,R,,",
            ",reversal,99-00-00,,,L,",
            ",reversal,101-00-00,,,R,",
            ",backsight,10-00-20,,L,,",
            ",backsight,190-00-20,,R,,",
        ),
        "T",
        default_target="T",
    )
    assert still is not None
    small = drift_probability(still, sigma=20 * ARCSEC, dof=10)
    large = drift_probability(still, sigma=2 * ARCSEC, dof=10)
    assert small is not None
    assert large is not None
    assert small > 0.2
    assert large < 1e-4


def test_eccentric_station_by_coordinates() -> None:
    # instrument 0.5 m east of its mark; mark to target 100 m due north; circle zero = north
    mark, target = np.array([0.0, 0.0]), np.array([0.0, 100.0])
    stood = np.array([0.5, 0.0])
    seen = target - stood
    reading = math.atan2(seen[0], seen[1])
    to_mark = math.atan2(*(mark - stood))
    corrected = reading + eccentric_correction(
        line_reading=reading, direction=to_mark, ratio=0.5 / 100.0, at="station"
    )
    assert wrap_pi(corrected) == pytest.approx(0.0, abs=1e-12)


def test_eccentric_target_by_coordinates() -> None:
    # the target stood 0.3 m east and 0.4 m north of its mark
    stood = np.array([0.3, 100.4])
    reading = math.atan2(stood[0], stood[1])
    to_mark = math.atan2(-0.3, -0.4)
    corrected = reading + eccentric_correction(
        line_reading=reading, direction=to_mark, ratio=0.5 / 100.0, at="target"
    )
    assert wrap_pi(corrected) == pytest.approx(0.0, abs=1e-12)


def test_zenith_angle_of_both_faces() -> None:
    rows = book(",zenith,80-00-10,,L,,", ",zenith,280-00-00,,R,,")
    assert zenith_angle(rows, "T", default_target="T") == pytest.approx(dms("80-00-05"))
