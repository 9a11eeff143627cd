"""Every projected CRS of the registers: computed rightly, or refused."""

from __future__ import annotations

import math
import warnings

import numpy as np
import pytest
from pyproj import CRS

from bench.grids import codes, places, tried
from surveyapp.core.geodesy import open_grid
from surveyapp.errors import SurveyError
from surveyapp_models.angles import RHO_ARCSEC


def test_every_grid_agrees_with_the_factors_of_proj_or_is_refused() -> None:
    every = codes()
    assert len(every) > 7000
    chosen = np.random.default_rng(20261128).choice(every, 600, replace=False)
    assert [text for code in chosen for text in tried(str(code))[1]] == []


def test_grids_that_proj_cannot_compute_are_refused_and_no_fault() -> None:
    # ESRI's South African Lo has a scale factor of -1
    for code in [f"ESRI:{number}" for number in range(102470, 102490)]:
        with pytest.raises(SurveyError) as caught:
            open_grid(code)
        assert caught.value.problems[0].where == "project.toml, crs"


def test_paris_counts_from_its_own_meridian() -> None:
    # 2 deg 20 min 14.025 sec east of Greenwich: x = 600000 (IGN, Lambert zone II)
    grid = open_grid("EPSG:27572")
    _, longitude = grid.geographic(e=600000.0, n=2200000.0)
    assert math.degrees(longitude) == pytest.approx(2.0 + 20.0 / 60.0 + 14.025 / 3600.0, abs=1e-8)
    latitude, _ = grid.geographic(e=600000.0, n=2200000.0)
    assert math.degrees(latitude) == pytest.approx(46.8, abs=1e-9)  # 52 gon
    assert grid.convergence(latitude=latitude, longitude=longitude) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("code", ["EPSG:5513", "EPSG:2065", "EPSG:5224", "EPSG:8352", "EPSG:8353"])
def test_krovak_with_axes_south_and_west_is_the_one_with_axes_east_and_north(code: str) -> None:
    grid, other = open_grid(code), open_grid("EPSG:5514")
    place = {"latitude": math.radians(50.0), "longitude": math.radians(15.0)}
    e, n = grid.projected(**place)
    if code in ("EPSG:5513", "EPSG:2065"):
        assert (e, n) == pytest.approx(other.projected(**place), abs=0.01)
    assert e < 0.0
    assert n < 0.0
    difference = grid.convergence(**place) - other.convergence(**place)
    assert abs(difference) * RHO_ARCSEC < 0.2  # JTSK/05 has coefficients of its own


def test_krovak_published() -> None:
    # EPSG guidance note 373-7-2, 3.3.1: 50-12-32.442 N, 16-50-59.179 E: X 1050538.63, Y 568991.00
    grid = open_grid("EPSG:5513")
    latitude = math.radians(50.0 + 12.0 / 60.0 + 32.442 / 3600.0)
    longitude = math.radians(16.0 + 50.0 / 60.0 + 59.179 / 3600.0)
    e, n = grid.projected(latitude=latitude, longitude=longitude)
    assert (-n, -e) == pytest.approx((1050538.63, 568991.00), abs=0.02)
    assert grid.directions_from_south


def test_yards_links_chains_and_german_legal_metres_are_stated_in_metres() -> None:
    north = open_grid("EPSG:27291")  # false easting 300000 yards
    latitude, longitude = north.geographic(e=300000 * 0.9143984, n=400000 * 0.9143984)
    assert math.degrees(latitude) == pytest.approx(-39.0, abs=1e-6)
    assert math.degrees(longitude) == pytest.approx(175.5, abs=1e-6)
    for code, factor in (
        ("EPSG:2066", 0.201166195164),
        ("EPSG:3140", 0.201168),
        ("EPSG:29871", 20.116765121552632),
        ("EPSG:29371", 1.0000135965),
        ("EPSG:24370", 0.9143985307444408),
    ):
        grid, crs = open_grid(code), CRS.from_user_input(code)
        assert crs.axis_info[0].unit_conversion_factor == pytest.approx(factor, rel=1e-9)
        place = next(places(grid))
        e0, n0 = grid.projected(latitude=place[0], longitude=place[1])
        e1, n1 = grid.projected(latitude=place[0] + 1e-5, longitude=place[1])
        assert math.hypot(e1 - e0, n1 - n0) == pytest.approx(63.5, rel=0.01)  # metres


def test_axes_of_a_polar_grid_are_told_by_their_names() -> None:
    ups, same = open_grid("EPSG:32661"), open_grid("EPSG:5041")
    place = {"latitude": math.radians(85.0), "longitude": math.radians(30.0)}
    assert ups.projected(**place) == pytest.approx(same.projected(**place), abs=1e-6)
    # grid north of UPS is that of the meridian 0 at the pole: convergence = longitude
    assert ups.convergence(**place) == pytest.approx(math.radians(30.0), abs=1e-10)
    assert not ups.directions_from_south


@pytest.mark.parametrize("units", ["m", "us-ft"])
@pytest.mark.parametrize("axis", ["enu", "wsu", "neu"])
def test_axes_units_and_prime_meridian_of_a_proj_string_count(axis: str, units: str) -> None:
    proj = "+proj=tmerc +lat_0=0 +lon_0={lon} +k=1 +x_0=500000 +y_0=0 +ellps=GRS80 {more} +type=crs"
    plain = open_grid(proj.format(lon=9.0, more="+units=m"))
    # 9 degrees east of Greenwich is 9 + 17-40 east of Ferro
    other = open_grid(
        proj.format(lon=9.0 + 17.0 + 40.0 / 60.0, more=f"+pm=ferro +units={units} +axis={axis}")
    )
    place = {"latitude": math.radians(47.0), "longitude": math.radians(9.7)}
    e, n = other.projected(**place)
    # an axis of a PROJ string is turned last: west is minus east, false easting included
    assert e == pytest.approx(plain.projected(**place)[0], abs=1e-4)
    assert n == pytest.approx(plain.projected(**place)[1], abs=1e-4)
    assert other.convergence(**place) == pytest.approx(plain.convergence(**place), abs=1e-12)
    assert other.directions_from_south == (axis == "wsu")


@pytest.mark.parametrize(
    "text",
    [
        "+proj=tmerc +lon_0=9 +ellps=bessel +nadgrids=/etc/passwd +type=crs",
        "+proj=tmerc +lon_0=9 +ellps=bessel +nadgrids=@BETA2007.gsb +type=crs",
        "+proj=tmerc +lon_0=9 +ellps=bessel +geoidgrids=egm96.gtx +type=crs",
        "+init=/etc/passwd:x",
        "https://example.org/crs.wkt",
    ],
)
def test_a_crs_that_names_a_file_is_refused(text: str) -> None:
    with pytest.raises(SurveyError, match="file"):
        open_grid(text)


def test_a_shift_of_datum_changes_nothing() -> None:
    proj = "+proj=tmerc +lat_0=0 +lon_0=9 +k=1 +x_0=3500000 +y_0=0 +ellps=bessel {} +type=crs"
    plain, shifted = open_grid(proj.format("")), open_grid(proj.format("+towgs84=598.1,73.7,418.2"))
    place = {"latitude": math.radians(50.0), "longitude": math.radians(9.5)}
    assert shifted.projected(**place) == pytest.approx(plain.projected(**place), abs=1e-9)
    # between its own geographic CRS and this one pyproj would choose a change of datum
    slovenia = open_grid("ESRI:102060")
    e, n = slovenia.projected(latitude=math.radians(46.15), longitude=math.radians(15.0))
    assert e == pytest.approx(500000.0, abs=1e-6)
    assert slovenia.convergence(
        latitude=math.radians(46.15), longitude=math.radians(15.0)
    ) == pytest.approx(0.0, abs=1e-12)
    assert n == pytest.approx(0.9999 * _bessel_meridian(46.15) - 5_000_000.0, abs=1e-3)


def _bessel_meridian(latitude_deg: float) -> float:
    """Length of the meridian from the equator [m] by quadrature."""
    a, b = 6377397.155, 6356078.962818189
    e2 = 1.0 - (b / a) ** 2
    x, w = np.polynomial.legendre.leggauss(40)
    end = math.radians(latitude_deg)
    phi = 0.5 * end * (x + 1.0)
    return float(0.5 * end * np.sum(w * a * (1 - e2) / (1 - e2 * np.sin(phi) ** 2) ** 1.5))


def test_no_warning_of_pyproj_reaches_the_surveyor() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        open_grid.cache_clear()
        open_grid("+proj=utm +zone=33 +ellps=GRS80 +towgs84=0,0,0 +type=crs")
        open_grid("EPSG:25832+5783")
