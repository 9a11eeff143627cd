import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from surveyapp.core.geodesy import (
    Azimuth,
    Position,
    arc_to_chord,
    deflection_term,
    open_grid,
    position_of,
)
from surveyapp.domain.project import Deflection, Station
from surveyapp.errors import SurveyError
from surveyapp_models.angles import ARCSEC, RHO_ARCSEC
from surveyapp_models.constants import WGS84


def tmerc(lon0: float, *, k: float = 1.0, extra: str = "") -> str:
    return (
        f"+proj=tmerc +lat_0=0 +lon_0={lon0} +k={k} +x_0=0 +y_0=0 +ellps=WGS84 +units=m {extra}"
        "+no_defs +type=crs"
    )


def convergence_series(latitude: float, longitude_difference: float) -> float:
    # physics.md 3.3, from Grossmann's series: an independent route
    t = math.tan(latitude)
    h2 = WGS84.second_eccentricity_squared * math.cos(latitude) ** 2
    lc2 = (longitude_difference * math.cos(latitude)) ** 2
    return (
        longitude_difference
        * math.sin(latitude)
        * (1.0 + lc2 / 3.0 * (1.0 + 3.0 * h2 + 2.0 * h2 * h2) + lc2 * lc2 / 15.0 * (2.0 - t * t))
    )


@settings(max_examples=200, deadline=None, derandomize=True)
@given(st.floats(-75.0, 75.0), st.floats(-1.6, 1.6))
def test_convergence_equals_the_series(latitude: float, difference: float) -> None:
    grid = open_grid(tmerc(0.0))
    phi, lam = math.radians(latitude), math.radians(difference)
    computed = grid.convergence(latitude=phi, longitude=lam)
    assert computed * RHO_ARCSEC == pytest.approx(
        convergence_series(phi, lam) * RHO_ARCSEC, abs=1e-3
    )


@pytest.mark.parametrize(
    ("latitude", "difference", "printed"),
    [  # physics.md 3.3, check numbers on WGS 84
        (-33.0, 0.5, -980.368),
        (23.0, 3.0, 4223.223),
        (35.0, 1.5, 3097.794),
        (52.0, 3.0, 8513.487),
        (65.0, 3.0, 9789.727),
    ],
)
def test_convergence_check_numbers(latitude: float, difference: float, printed: float) -> None:
    grid = open_grid(tmerc(0.0))
    computed = grid.convergence(latitude=math.radians(latitude), longitude=math.radians(difference))
    assert computed * RHO_ARCSEC == pytest.approx(printed, abs=1e-3)


def test_true_meridian_east_of_the_central_meridian_bears_left_of_grid_north() -> None:
    # physics.md 3.3: latitude 35, 1.5 degrees east: the meridian has grid bearing 359.1395 degrees
    grid = open_grid(tmerc(0.0))
    phi, lam = math.radians(35.0), math.radians(1.5)
    e0, n0 = grid.projected(latitude=phi, longitude=lam)
    e1, n1 = grid.projected(latitude=phi + 1e-5, longitude=lam)
    bearing = math.degrees(math.atan2(e1 - e0, n1 - n0)) % 360.0
    assert bearing == pytest.approx(359.1395, abs=5e-5)
    gamma = math.degrees(grid.convergence(latitude=phi, longitude=lam))
    assert gamma == pytest.approx(360.0 - bearing, abs=1e-5)


def test_arc_to_chord_check_of_the_design() -> None:
    # y = +100 km, 1 km to the north at latitude 35: t - T = -0.254" (formula -0.255")
    grid = open_grid(tmerc(0.0))
    _, n0 = grid.projected(latitude=math.radians(35.0), longitude=0.0)
    start = position_of(Station("A", e=100_000.0, n=n0), grid)
    end = position_of(Station("B", e=100_000.0, n=n0 + 1000.0), grid)
    value = arc_to_chord(grid, start, end)
    assert value is not None
    assert value * RHO_ARCSEC == pytest.approx(0.2545, abs=1.5e-3)


def test_arc_to_chord_equals_the_classic_formula() -> None:
    grid = open_grid(tmerc(0.0))
    _, n0 = grid.projected(latitude=math.radians(-26.0), longitude=0.0)
    for y, de, dn in [(-80e3, 300.0, 900.0), (60e3, -2000.0, 1500.0), (20e3, 5000.0, -7000.0)]:
        start = position_of(Station("A", e=y, n=n0), grid)
        end = position_of(Station("B", e=y + de, n=n0 + dn), grid)
        assert start.latitude is not None
        e2 = WGS84.first_eccentricity_squared
        w = 1.0 - e2 * math.sin(start.latitude) ** 2
        radius_squared = WGS84.semi_major_m**2 * (1.0 - e2) / w**2
        t_minus_arc = (2 * y + y + de) * (n0 - (n0 + dn)) / (6.0 * radius_squared)
        value = arc_to_chord(grid, start, end)
        assert value is not None
        assert -value * RHO_ARCSEC == pytest.approx(t_minus_arc * RHO_ARCSEC, abs=2e-3)


def test_grid_with_axes_west_and_south() -> None:
    lo19 = open_grid("EPSG:2048")
    phi, lam = math.radians(-29.0), math.radians(19.5)
    e, n = lo19.projected(latitude=phi, longitude=lam)
    assert e > 0.0  # half a degree east of the central meridian: true east is positive
    assert n < 0.0
    assert lo19.directions_from_south
    assert lo19.geographic(e=e, n=n) == pytest.approx((phi, lam), abs=1e-12)
    # negative east of the central meridian in the south (design.md section 2)
    expected = math.sin(phi) * math.radians(0.5)
    gamma = lo19.convergence(latitude=phi, longitude=lam)
    assert gamma == pytest.approx(expected, rel=1e-4)


def test_grid_in_feet_is_used_in_metres() -> None:
    feet = open_grid("EPSG:2263")
    phi, lam = math.radians(40.7), math.radians(-73.9)
    e0, n0 = feet.projected(latitude=phi, longitude=lam)
    _, n1 = feet.projected(latitude=phi + 1e-6, longitude=lam)
    e1, _ = feet.projected(latitude=phi, longitude=lam + 1e-6)
    assert (n1 - n0) == pytest.approx(6.366, abs=0.01)
    assert e1 > e0


@pytest.mark.parametrize(
    "text", ["EPSG:4326", "EPSG:4978", "EPSG:999999", "", "no grid", "EPSG:5703"]
)
def test_crs_without_convergence_is_refused(text: str) -> None:
    with pytest.raises(SurveyError) as caught:
        open_grid(text)
    assert caught.value.problems[0].where == "project.toml, crs"


def test_compound_and_wkt_are_read() -> None:
    compound = open_grid("EPSG:25832+5783")
    assert "UTM zone 32N" in compound.name
    from pyproj import CRS

    wkt = open_grid(CRS.from_epsg(25832).to_wkt())
    at = {"latitude": math.radians(51.0), "longitude": math.radians(10.0)}
    assert wkt.convergence(**at) == compound.convergence(**at)


def test_deflection_of_a_steep_sight() -> None:
    # physics.md 3.5: eta = 5": 3.5" / 6.0" / 10.7" at 35 / 50 / 65 degrees, horizontal sight
    eta = Deflection(xi=0.0, eta=5.0 * ARCSEC)
    for latitude, printed in [(35.0, 3.5), (50.0, 6.0), (65.0, 10.7)]:
        term = deflection_term(
            eta, latitude=math.radians(latitude), azimuth=1.0, zenith=math.pi / 2
        )
        assert term.value * RHO_ARCSEC == pytest.approx(printed, abs=0.05)
    # z = 70 degrees: cot z = 0.364 of the deflection across the sight; due east, xi acts
    xi = Deflection(xi=5.0 * ARCSEC, eta=0.0)
    term = deflection_term(xi, latitude=0.8, azimuth=math.pi / 2, zenith=math.radians(70.0))
    assert term.value * RHO_ARCSEC == pytest.approx(5.0 * 0.36397, abs=1e-3)


def test_references_cannot_be_mixed() -> None:
    gyro = Azimuth(1.0, "GYRO")
    assert gyro.with_constant(0.5).reference == "ASTRONOMIC"
    with pytest.raises(SurveyError, match="ASTRONOMIC"):
        gyro.without_deflection(0.1)
    with pytest.raises(SurveyError):
        gyro.minus(Azimuth(1.0, "GRID"))
    grid = (
        gyro.with_constant(0.1).without_deflection(0.01).to_grid(convergence=0.2, arc_to_chord=0.0)
    )
    assert grid == Azimuth(1.0 + 0.1 - 0.01 - 0.2, "GRID")


def test_position_outside_the_projection_is_an_error_and_no_infinity() -> None:
    grid = open_grid("EPSG:4546")
    with pytest.raises(SurveyError, match="outside the area"):
        grid.geographic(e=1e12, n=1e12)
    assert arc_to_chord(grid, Position(None, None, 1.0, 2.0, None), Position(*[None] * 5)) is None
