"""Every projected CRS of the EPSG and ESRI registers: computed rightly, or refused.

The convergence is compared with PROJ's own factors, the prime meridian taken off by hand: another
route than the derivative of the position. A grid is compared where surveys may use it: scale
factor within 10 %, angles within 1'.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from pyproj import CRS, Proj
from pyproj.database import query_crs_info
from pyproj.enums import PJType

from surveyapp.core.checks.grid_checks import MOST_DISTORTION_ARCMIN, SCALE_MARGIN
from surveyapp.core.geodesy import Grid, open_grid
from surveyapp.errors import SurveyError
from surveyapp_models.angles import RHO_ARCSEC

PLACES = ((0.52, 0.45), (0.3, 0.6))
"""Where in its area a grid is tried: not in its very middle, where maps of the world have kinks."""
LIMIT_ARCSEC = 1e-5
LIMIT_BACK = 1e-9
"""Of the way back to latitude and longitude [rad]: 6 mm."""

Place = tuple[float, float]


def codes() -> list[str]:
    """Every projected CRS of both registers."""
    return [
        f"{register}:{item.code}"
        for register in ("EPSG", "ESRI")
        for item in query_crs_info(
            auth_name=register, pj_types=PJType.PROJECTED_CRS, allow_deprecated=True
        )
    ]


def places(grid: Grid) -> Iterator[Place]:
    """Latitudes and longitudes [rad] in the area of a grid."""
    west, south, east, north = grid.area_deg or (-10.0, -10.0, 10.0, 10.0)
    width = (east - west) % 360.0 or 360.0
    for fx, fy in PLACES:
        latitude = min(max(south + (north - south) * fy, -88.0), 88.0)
        longitude = (west + width * fx + 180.0) % 360.0 - 180.0
        yield math.radians(latitude), math.radians(longitude)


def is_usable(grid: Grid, place: Place) -> bool:
    """Whether the checks of the grid are met at a place."""
    local = grid.differential(latitude=place[0], longitude=place[1])
    bent = math.degrees(local.distortion) * 60.0 > MOST_DISTORTION_ARCMIN
    return not bent and max(abs(scale - 1.0) for scale in local.scales) <= SCALE_MARGIN


def factors_convergence(code: str, place: Place) -> float:
    """Convergence [rad] from PROJ's own factors."""
    crs = CRS.from_user_input(code)
    meridian = crs.prime_meridian
    zero = 0.0
    if meridian is not None:
        zero = math.degrees(float(meridian.longitude) * float(meridian.unit_conversion_factor))
    factors = Proj(crs).get_factors(math.degrees(place[1]) - zero, math.degrees(place[0]))
    return math.radians(factors.meridian_convergence)


def tried(code: str) -> tuple[str, list[str]]:
    """What became of one grid (refused, unfit or compared), and what is wrong with it."""
    try:
        grid = open_grid(code)
    except SurveyError:
        return "refused", []
    outcome, found = "unfit", []
    for place in places(grid):
        try:
            e, n = grid.projected(latitude=place[0], longitude=place[1])
            if not is_usable(grid, place):
                continue
            gamma = grid.convergence(latitude=place[0], longitude=place[1])
            back = grid.geographic(e=e, n=n)
        except SurveyError:
            continue
        outcome = "compared"
        apart = math.remainder(gamma - factors_convergence(code, place), 2.0 * math.pi)
        if abs(apart) * RHO_ARCSEC > LIMIT_ARCSEC:
            found.append(f'{code}: convergence {apart * RHO_ARCSEC:+.6f}"')
        east = math.remainder(back[1] - place[1], 2.0 * math.pi) * math.cos(place[0])
        if math.hypot(back[0] - place[0], east) > LIMIT_BACK:
            found.append(f"{code}: not the way back")
    return outcome, found


def run() -> list[str]:
    """The whole sweep."""
    counts = {"compared": 0, "unfit": 0, "refused": 0, "fault": 0}
    wrong: list[str] = []
    every = codes()
    for code in every:
        try:
            outcome, found = tried(code)
        except Exception as error:
            outcome, found = "fault", [f"{code}: {error!r}"]
        counts[outcome] += 1
        wrong += found
    told = ", ".join(f"{count} {name}" for name, count in counts.items())
    return [f"{len(every)} projected CRS: {told}; wrong: {len(wrong)}", *wrong]
