"""The World Magnetic Model: expiry, height in metres, and the published test values."""

import datetime as dt

import pytest

from surveyapp.core.sensors.declination import model_declination
from surveyapp.errors import SurveyError
from surveyapp.workflows.calibrating.compass import declination_of

pytest.importorskip("pygeomag")


def at(**changed: float | dt.date) -> tuple[float, float]:
    values = {"latitude_deg": 80.0, "longitude_deg": 0.0, "height_m": 0.0,
              "day": dt.date(2025, 1, 1)} | changed  # fmt: skip
    return model_declination(**values)  # type: ignore[arg-type]


def test_height_is_in_metres() -> None:
    ground, _ = at(latitude_deg=47.0, longitude_deg=9.0)
    above, _ = at(latitude_deg=47.0, longitude_deg=9.0, height_m=3000.0)
    assert 0.0 < abs(above - ground) < 0.02
    with pytest.raises(SurveyError, match="height in metres"):
        at(height_m=500_000.0)


def test_sigma_of_a_model_never_passes_ten_minutes() -> None:
    for latitude in (-40.0, 0.0, 47.0, 65.0):
        _, sigma = at(latitude_deg=latitude, longitude_deg=20.0)
        assert 0.28 < sigma < 0.6
        assert 1.96 * sigma * 60.0 > 10.0


def test_an_expired_model_is_refused() -> None:
    with pytest.raises(SurveyError, match="does not hold"):
        at(day=dt.date(2031, 6, 1))


def test_as_an_option() -> None:
    value, sigma = declination_of("wmm:47.0,9.0,500,2026-03-01")
    expected = model_declination(
        latitude_deg=47.0, longitude_deg=9.0, height_m=500.0, day=dt.date(2026, 3, 1)
    )
    assert (value, sigma) == expected
    assert 3.0 < value < 4.5
    with pytest.raises(SurveyError, match="no place and day"):
        declination_of("wmm:47.0,9.0")
