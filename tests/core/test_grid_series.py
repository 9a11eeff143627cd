"""Convergence, coordinates and arc-to-chord against series that know nothing of PROJ."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import pytest

from surveyapp.core.geodesy import arc_to_chord, open_grid, position_of
from surveyapp.domain.project import Station
from surveyapp_models.angles import RHO_ARCSEC

GRS80 = (6378137.0, 298.257222101)
BESSEL = (6377397.155, 299.1528128)
WGS84 = (6378137.0, 298.257223563)
CLARKE66 = (6378206.4, 294.978698213898)

Point = tuple[float, float]


@dataclass(frozen=True)
class Series:
    """East, north [m] and convergence [rad] of latitude and longitude [rad]."""

    ellipsoid: tuple[float, float]
    map: Callable[[float, float], tuple[float, float, float]]


def kruger(
    ellipsoid: tuple[float, float], *, lon0: float, k: float, fe: float = 0.0, fn: float = 0.0
) -> Series:
    """Krueger's series to n^6. Source: Karney (2011), J. Geod. 85, eqs. 7-9, 11, 24, 26, 35."""
    a, inverse = ellipsoid
    n = 1.0 / (2.0 * inverse - 1.0)
    e = math.sqrt((2.0 - 1.0 / inverse) / inverse)
    alpha = [
        n / 2 - 2 * n**2 / 3 + 5 * n**3 / 16 + 41 * n**4 / 180 - 127 * n**5 / 288
        + 7891 * n**6 / 37800,
        13 * n**2 / 48 - 3 * n**3 / 5 + 557 * n**4 / 1440 + 281 * n**5 / 630
        - 1983433 * n**6 / 1935360,
        61 * n**3 / 240 - 103 * n**4 / 140 + 15061 * n**5 / 26880 + 167603 * n**6 / 181440,
        49561 * n**4 / 161280 - 179 * n**5 / 168 + 6601661 * n**6 / 7257600,
        34729 * n**5 / 80640 - 3418889 * n**6 / 1995840,
        212378941 * n**6 / 319334400,
    ]  # fmt: skip
    radius = a / (1 + n) * (1 + n**2 / 4 + n**4 / 64 + n**6 / 256)

    def mapped(latitude: float, longitude: float) -> tuple[float, float, float]:
        lam = longitude - math.radians(lon0)
        tau = math.tan(latitude)
        sigma = math.sinh(e * math.atanh(e * tau / math.hypot(1.0, tau)))
        t = tau * math.hypot(1.0, sigma) - sigma * math.hypot(1.0, tau)
        xi = math.atan2(t, math.cos(lam))
        eta = math.asinh(math.sin(lam) / math.hypot(t, math.cos(lam)))
        north, east, p, q = xi, eta, 1.0, 0.0
        for j, value in enumerate(alpha, start=1):
            north += value * math.sin(2 * j * xi) * math.cosh(2 * j * eta)
            east += value * math.cos(2 * j * xi) * math.sinh(2 * j * eta)
            p += 2 * j * value * math.cos(2 * j * xi) * math.cosh(2 * j * eta)
            q += 2 * j * value * math.sin(2 * j * xi) * math.sinh(2 * j * eta)
        gamma = math.atan2(t * math.tan(lam), math.hypot(1.0, t)) + math.atan2(q, p)
        return fe + k * radius * east, fn + k * radius * north, gamma

    return Series(ellipsoid, mapped)


def lambert(
    ellipsoid: tuple[float, float], *, lat0: float, lon0: float, parallels: Point, shift: Point
) -> Series:
    """Lambert's conformal conic with two parallels. Source: Snyder (1987), 15-1 to 15-11."""
    a, inverse = ellipsoid
    e = math.sqrt((2.0 - 1.0 / inverse) / inverse)

    def t_of(phi: float) -> float:
        s = e * math.sin(phi)
        return math.tan(math.pi / 4 - phi / 2) / math.pow((1 - s) / (1 + s), e / 2)

    def m_of(phi: float) -> float:
        return math.cos(phi) / math.sqrt(1 - (e * math.sin(phi)) ** 2)

    phi1, phi2 = (math.radians(value) for value in parallels)
    cone = (math.log(m_of(phi1)) - math.log(m_of(phi2))) / (
        math.log(t_of(phi1)) - math.log(t_of(phi2))
    )
    f = m_of(phi1) / (cone * math.pow(t_of(phi1), cone))
    rho0 = a * f * t_of(math.radians(lat0)) ** cone

    def mapped(latitude: float, longitude: float) -> tuple[float, float, float]:
        theta = cone * (longitude - math.radians(lon0))
        rho = a * f * t_of(latitude) ** cone
        return shift[0] + rho * math.sin(theta), shift[1] + rho0 - rho * math.cos(theta), theta

    return Series(ellipsoid, mapped)


NORTH_CALIFORNIA = {"lat0": 39 + 20 / 60, "lon0": -122.0}
FOOT = 1200.0 / 3937.0

GRIDS: dict[str, Series] = {
    "EPSG:25832": kruger(GRS80, lon0=9, k=0.9996, fe=5e5),
    "EPSG:32733": kruger(WGS84, lon0=15, k=0.9996, fe=5e5, fn=1e7),
    "EPSG:4546": kruger(GRS80, lon0=111, k=1.0, fe=5e5),
    "EPSG:31467": kruger(BESSEL, lon0=9, k=1.0, fe=3.5e6),
    "EPSG:4508": kruger(GRS80, lon0=111, k=1.0, fe=5e5),
    "EPSG:2052": kruger(WGS84, lon0=27, k=1.0),
    "EPSG:2154": lambert(GRS80, lat0=46.5, lon0=3, parallels=(44, 49), shift=(7e5, 6.6e6)),
    "EPSG:2225": lambert(
        GRS80,
        **NORTH_CALIFORNIA,
        parallels=(41 + 40 / 60, 40.0),
        shift=(6561666.667 * FOOT, 1640416.667 * FOOT),
    ),
    "EPSG:26741": lambert(
        CLARKE66, **NORTH_CALIFORNIA, parallels=(41 + 40 / 60, 40.0), shift=(2e6 * FOOT, 0.0)
    ),
}

CASES: list[tuple[str, Point]] = [
    ("EPSG:25832", (48.1, 11.6)),
    ("EPSG:25832", (54.0, 6.5)),
    ("EPSG:32733", (-26.2, 17.9)),
    ("EPSG:32733", (-55.0, 12.5)),
    ("EPSG:4546", (34.4, 110.2)),
    ("EPSG:31467", (51.5, 10.4)),
    ("EPSG:31467", (47.6, 7.6)),
    ("EPSG:4508", (40.0, 113.9)),
    ("EPSG:4508", (23.0, 108.2)),
    ("EPSG:2052", (-26.2, 27.9)),
    ("EPSG:2052", (-33.0, 26.1)),
    ("EPSG:2154", (48.9, 7.8)),
    ("EPSG:2154", (43.1, -1.5)),
    ("EPSG:2225", (41.2, -120.4)),
    ("EPSG:2225", (40.1, -124.0)),
    ("EPSG:26741", (41.2, -120.4)),
]


@pytest.mark.parametrize(("code", "place"), CASES)
def test_coordinates_and_convergence_equal_the_series(code: str, place: Point) -> None:
    grid, series = open_grid(code), GRIDS[code]
    latitude, longitude = (math.radians(value) for value in place)
    e, n, gamma = series.map(latitude, longitude)
    # latitude and longitude are on the ellipsoid of the grid: no datum enters
    assert grid.projected(latitude=latitude, longitude=longitude) == pytest.approx((e, n), abs=2e-6)
    computed = grid.convergence(latitude=latitude, longitude=longitude)
    assert (computed - gamma) * RHO_ARCSEC == pytest.approx(0.0, abs=1e-5)


def geodesic_azimuth(ellipsoid: tuple[float, float], start: Point, end: Point) -> float:
    """Azimuth at the start [rad]. Source: Vincenty (1975), Survey Review 23, eqs. 13-20."""
    f = 1.0 / ellipsoid[1]
    u1 = math.atan((1 - f) * math.tan(start[0]))
    u2 = math.atan((1 - f) * math.tan(end[0]))
    difference = lam = end[1] - start[1]
    for _ in range(60):
        cross = math.cos(u2) * math.sin(lam)
        along = math.cos(u1) * math.sin(u2) - math.sin(u1) * math.cos(u2) * math.cos(lam)
        sin_s = math.hypot(cross, along)
        cos_s = math.sin(u1) * math.sin(u2) + math.cos(u1) * math.cos(u2) * math.cos(lam)
        s = math.atan2(sin_s, cos_s)
        sin_a = math.cos(u1) * cross / sin_s
        cos2_a = 1 - sin_a**2
        middle = cos_s - 2 * math.sin(u1) * math.sin(u2) / cos2_a
        c = f / 16 * cos2_a * (4 + f * (4 - 3 * cos2_a))
        lam = difference + (1 - c) * f * sin_a * (
            s + c * sin_s * (middle + c * cos_s * (2 * middle**2 - 1))
        )
    return math.atan2(
        math.cos(u2) * math.sin(lam),
        math.cos(u1) * math.sin(u2) - math.sin(u1) * math.cos(u2) * math.cos(lam),
    )


@pytest.mark.parametrize(("code", "place"), CASES)
@pytest.mark.parametrize("step", [(0.03, 0.02), (-0.02, 0.05)])
def test_arc_to_chord_equals_the_series(code: str, place: Point, step: Point) -> None:
    grid, series = open_grid(code), GRIDS[code]
    start = (math.radians(place[0]), math.radians(place[1]))
    end = (math.radians(place[0] + step[0]), math.radians(place[1] + step[1]))
    (e1, n1, gamma), (e2, n2, _) = series.map(*start), series.map(*end)
    azimuth = geodesic_azimuth(series.ellipsoid, start, end)
    expected = azimuth - gamma - math.atan2(e2 - e1, n2 - n1)
    value = arc_to_chord(
        grid,
        position_of(Station("A", e=e1, n=n1), grid),
        position_of(Station("B", e=e2, n=n2), grid),
    )
    assert value is not None
    apart = math.remainder(value - expected, 2.0 * math.pi)
    assert apart * RHO_ARCSEC == pytest.approx(0.0, abs=1e-5)
