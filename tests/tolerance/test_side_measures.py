"""Lengths and sigmas of oriented sides against a rule book, and the stated place on the circle."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import pytest

from surveyapp import api
from surveyapp.core.tolerance.measures import circle_spacing
from surveyapp.core.tolerance.side_measures import gyro_side_length, gyro_side_sigma

TONGJIN = Path(__file__).parents[2] / "projects" / "tongjin-2015"


def test_length_of_an_oriented_side_is_that_of_its_coordinates() -> None:
    computed = api.compute(TONGJIN)
    stations = {item.name: item for item in computed.project.stations}
    found = {item.subject: item.value for item in gyro_side_length(computed.orientation)}
    assert found
    for side, value in found.items():
        a, b = stations[side.station], stations[side.target]
        assert None not in (a.e, a.n, b.e, b.n)
        gap = (float(b.e or 0.0) - float(a.e or 0.0), float(b.n or 0.0) - float(a.n or 0.0))
        assert value == pytest.approx(math.hypot(*gap))


def test_sigma_of_an_oriented_side_is_the_one_that_is_printed() -> None:
    computed = api.compute(TONGJIN)
    printed = {
        (line["station"], line["target"]): line["grid_azimuth"]["sigma_arcsec"]
        for line in computed.result.to_dict()["lines"]
    }
    found = gyro_side_sigma(computed.orientation)
    assert {(m.subject.station, m.subject.target): m.value for m in found} == pytest.approx(printed)


def test_a_stated_circle_shift_stands_for_the_place_on_the_circle() -> None:
    orientation = api.compute(TONGJIN).orientation
    shifted = tuple(
        replace(
            item,
            session=replace(item.session, station="A", circle_shift=math.radians(30.0 * k)),
            reduction=replace(item.reduction, north=None),
        )
        for k, item in enumerate(orientation.sessions)
    )
    (found,) = circle_spacing(replace(orientation, sessions=shifted))
    assert found.value == pytest.approx(30.0 * 3600.0)
