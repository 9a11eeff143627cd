"""Grid and Earth: convergence, arc-to-chord, deflection of the vertical, references of azimuths.

The only importer of pyproj, which is imported on first use and never asks the network. Signs as in
design.md section 2: grid = true - deflection - convergence - arc_to_chord; ``e`` and ``n`` are
always true east and north in metres, whatever way the axes of the grid point.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING

from surveyapp.domain.project import Deflection, Station
from surveyapp.domain.results import Reference
from surveyapp.errors import Problem, SurveyError
from surveyapp_models.angles import wrap_pi

if TYPE_CHECKING:
    from pyproj import Geod, Proj
    from pyproj.database import CRSInfo

MAX_LATITUDE_DEG = 75.0
WARN_LATITUDE_DEG = 70.0
"""physics.md 1.5: a maker's limit, not a singularity."""
AREA_MARGIN_DEG = 1.0
"""Beside its area by less, a grid may still be in use: the neighbour's zone is often carried on."""
CONFORMAL_LIMIT_DEG = 1e-3
"""Angular distortion above which a projection is not treated as conformal (web Mercator passes)."""


@dataclass(frozen=True, slots=True)
class Grid:
    """A projected coordinate reference system, ready to compute.

    Parameters
    ----------
    text : str
        As written in the project.
    name : str
        Its official name.
    projection, geodesic : pyproj objects
    sign_e, sign_n : float
        -1 where the axis points west or south.
    area_deg : tuple of float or None
        West, south, east, north of the area for which the grid is made [degrees].
    """

    text: str
    name: str
    projection: Proj
    geodesic: Geod
    sign_e: float
    sign_n: float
    area_deg: tuple[float, float, float, float] | None = None

    @property
    def directions_from_south(self) -> bool:
        """Whether the axes ask for directions counted from south."""
        return self.sign_n < 0.0

    def geographic(self, *, e: float, n: float) -> tuple[float, float]:
        """Latitude and longitude [rad] of true grid coordinates [m]."""
        longitude, latitude = self.projection(self.sign_e * e, self.sign_n * n, inverse=True)
        self._require_finite(latitude, f"e = {e:.3f}, n = {n:.3f}")
        return math.radians(latitude), math.radians(longitude)

    def projected(self, *, latitude: float, longitude: float) -> tuple[float, float]:
        """True east and north [m] of a geographic position [rad]."""
        x, y = self.projection(math.degrees(longitude), math.degrees(latitude))
        self._require_finite(x, _degrees(latitude=latitude, longitude=longitude))
        return self.sign_e * x, self.sign_n * y

    def convergence(self, *, latitude: float, longitude: float) -> float:
        """Meridian convergence [rad], positive where grid north lies east of true north."""
        factors = self.projection.get_factors(math.degrees(longitude), math.degrees(latitude))
        value = float(factors.meridian_convergence)
        self._require_finite(value, _degrees(latitude=latitude, longitude=longitude))
        return math.radians(value)

    def is_beside(self, *, latitude: float, longitude: float) -> bool:
        """Whether a place [rad] lies beside the area of the grid by more than a margin."""
        if self.area_deg is None:
            return False
        west, south, east, north = self.area_deg
        width = (east - west) % 360.0 or 360.0
        from_west = (math.degrees(longitude) - west + AREA_MARGIN_DEG) % 360.0
        inside = south - AREA_MARGIN_DEG <= math.degrees(latitude) <= north + AREA_MARGIN_DEG
        return not (inside and from_west <= width + 2.0 * AREA_MARGIN_DEG)

    def is_conformal(self, *, latitude: float, longitude: float) -> bool:
        """Whether angles survive the projection at a place."""
        factors = self.projection.get_factors(math.degrees(longitude), math.degrees(latitude))
        return abs(float(factors.angular_distortion)) < CONFORMAL_LIMIT_DEG

    def _require_finite(self, value: float, where: str) -> None:
        if not math.isfinite(value):
            raise SurveyError(
                Problem(
                    what="the position lies outside the area where this grid is defined",
                    where=where,
                    found=self.text,
                    expected="a position that the projection can reach",
                    hint="Check the coordinates, their order and the crs.",
                )
            )


def _degrees(*, latitude: float, longitude: float) -> str:
    return f"latitude {math.degrees(latitude):.6f}, longitude {math.degrees(longitude):.6f}"


@lru_cache(maxsize=32)
def open_grid(text: str) -> Grid:
    """Open a projected CRS given as EPSG code, PROJ string or WKT.

    Raises
    ------
    SurveyError
        If pyproj cannot read it or compute with it, or if it is no projected CRS: then it has no
        convergence.
    """
    import pyproj
    from pyproj import CRS, Proj
    from pyproj.exceptions import CRSError

    pyproj.network.set_network_enabled(active=False)
    try:
        crs = CRS.from_user_input(text)
    except CRSError as error:
        raise _crs_problem("the crs cannot be read", text, str(error)[:200]) from error
    horizontal = crs.sub_crs_list[0] if crs.is_compound else crs
    geod = horizontal.get_geod()
    if not horizontal.is_projected or geod is None:
        kind = horizontal.type_name
        raise _crs_problem(
            f"a {kind} has no meridian convergence", f"{text} ({horizontal.name})", ""
        )
    try:
        projection = Proj(horizontal, preserve_units=False)
    except CRSError as error:  # some old grids stand in the register without usable parameters
        named = f"{text} ({horizontal.name})"
        raise _crs_problem("this crs cannot be computed with", named, "") from error
    directions = {axis.direction.lower() for axis in horizontal.axis_info}
    return Grid(
        text=text,
        name=horizontal.name,
        projection=projection,
        geodesic=geod,
        sign_e=-1.0 if "west" in directions else 1.0,
        sign_n=-1.0 if "south" in directions and "north" not in directions else 1.0,
        area_deg=None if (area := crs.area_of_use) is None else area.bounds,
    )


def find_projected(
    text: str,
    place: tuple[float, float] | None = None,
    *,
    coordinates: tuple[float, float] | None = None,
    limit: int = 30,
) -> tuple[tuple[str, str], ...]:
    """EPSG codes and names of projected grids.

    Parameters
    ----------
    text : str
        Part of a name, or of a code; every word must be found.
    place : tuple of float or None
        Latitude and longitude [degrees] that the grid must be made for.
    coordinates : tuple of float or None
        East and north [m] that must lie where the grid is made for.
    limit : int
        Largest number returned; of more, those for the smallest area where the place is known,
        else those with the shortest names.

    Returns
    -------
    tuple of (str, str)
        Code such as ``EPSG:4546`` and official name.
    """
    from pyproj.aoi import AreaOfInterest
    from pyproj.database import query_crs_info
    from pyproj.enums import PJType

    area = None
    if place is not None:
        latitude, longitude = place
        area = AreaOfInterest(longitude, latitude, longitude, latitude)
    words = text.lower().replace("epsg:", "").split()
    named = [
        item
        for item in query_crs_info(
            auth_name="EPSG", pj_types=PJType.PROJECTED_CRS, area_of_interest=area
        )
        if all(word in item.name.lower() or word in item.code for word in words)
    ]
    local = place is not None or coordinates is not None
    named.sort(
        key=lambda item: (item.code not in words, _extent(item) if local else 0.0, len(item.name))
    )
    found = (
        (f"EPSG:{item.code}", item.name)
        for item in named
        if coordinates is None or _holds(f"EPSG:{item.code}", coordinates)
    )
    return tuple(itertools.islice(found, limit))


def _extent(item: CRSInfo) -> float:
    """Size of the area that a grid is made for [square degrees]: the local ones come first."""
    area = item.area_of_use
    if area is None:
        return math.inf
    return ((area.east - area.west) % 360.0 or 360.0) * (area.north - area.south)


def _holds(code: str, coordinates: tuple[float, float]) -> bool:
    """Whether true east and north [m] lie in the area that a grid is made for."""
    try:
        grid = open_grid(code)
        latitude, longitude = grid.geographic(e=coordinates[0], n=coordinates[1])
    except SurveyError:
        return False
    return not grid.is_beside(latitude=latitude, longitude=longitude)


def _crs_problem(what: str, found: str, detail: str) -> SurveyError:
    return SurveyError(
        Problem(
            what=what,
            where="project.toml, crs",
            found=found,
            expected='a projected CRS as EPSG code ("EPSG:4546"), PROJ string or WKT',
            hint=detail or "Name the grid in which the station coordinates are given.",
        )
    )


@dataclass(frozen=True, slots=True)
class Position:
    """Where a station lies, as far as it is known. Angles [rad], lengths [m]."""

    latitude: float | None
    longitude: float | None
    e: float | None
    n: float | None
    h: float | None


def position_of(station: Station, grid: Grid | None) -> Position:
    """Complete the position of a station through the grid, where there is one."""
    at = Position(station.latitude, station.longitude, station.e, station.n, station.h)
    if grid is None:
        return at
    if at.latitude is None or at.longitude is None:
        if at.e is None or at.n is None:
            return at
        latitude, longitude = grid.geographic(e=at.e, n=at.n)
        return replace(at, latitude=latitude, longitude=longitude)
    if at.e is None or at.n is None:
        e, n = grid.projected(latitude=at.latitude, longitude=at.longitude)
        return replace(at, e=e, n=n)
    return at


def arc_to_chord(grid: Grid, start: Position, end: Position) -> float | None:
    """Arc-to-chord T - t at ``start`` [rad], None where a position is missing.

    T is the grid azimuth of the projected geodesic at the start, t that of the chord: T - t =
    geodesic azimuth - convergence - chord. Computed with the exact geodesic, so that it holds for
    every projection; for one that is not conformal it contains the distortion of the azimuth too.
    """
    if start.latitude is None or start.longitude is None or start.e is None or start.n is None:
        return None
    if end.latitude is None or end.longitude is None or end.e is None or end.n is None:
        return None
    if (start.e, start.n) == (end.e, end.n):
        return None
    azimuth, _, _ = grid.geodesic.inv(
        math.degrees(start.longitude),
        math.degrees(start.latitude),
        math.degrees(end.longitude),
        math.degrees(end.latitude),
    )
    chord = math.atan2(end.e - start.e, end.n - start.n)
    gamma = grid.convergence(latitude=start.latitude, longitude=start.longitude)
    return wrap_pi(math.radians(azimuth) - gamma - chord)


@dataclass(frozen=True, slots=True)
class DeflectionTerm:
    """Deflection correction of one azimuth: A_geodetic = A_astronomic - value.

    Parameters
    ----------
    value : float
        [rad].
    by_xi, by_eta : float
        Its derivatives with respect to the two components [-].
    """

    value: float
    by_xi: float
    by_eta: float


def deflection_term(
    deflection: Deflection, *, latitude: float, azimuth: float, zenith: float
) -> DeflectionTerm:
    """Deflection term eta tan(phi) + (xi sin A - eta cos A) cot z.

    Source: physics.md 3.5; Torge & Mueller (2012), Geodesy, 4th ed., eq. 6.18.
    """
    cot_z = math.cos(zenith) / math.sin(zenith)
    by_xi = math.sin(azimuth) * cot_z
    by_eta = math.tan(latitude) - math.cos(azimuth) * cot_z
    return DeflectionTerm(by_xi * deflection.xi + by_eta * deflection.eta, by_xi, by_eta)


@dataclass(frozen=True, slots=True)
class Azimuth:
    """An azimuth that knows what it refers to.

    Parameters
    ----------
    value : float
        [rad], clockwise.
    reference : str
        GYRO, ASTRONOMIC, GEODETIC, GRID or MAGNETIC.
    """

    value: float
    reference: Reference

    def with_constant(self, constant: float) -> Azimuth:
        """GYRO to ASTRONOMIC: add the instrument constant [rad]."""
        return self._moved("GYRO", "ASTRONOMIC", constant)

    def without_deflection(self, deflection: float) -> Azimuth:
        """ASTRONOMIC to GEODETIC: subtract the deflection term [rad]."""
        return self._moved("ASTRONOMIC", "GEODETIC", -deflection)

    def to_grid(self, *, convergence: float, arc_to_chord: float) -> Azimuth:
        """GEODETIC to GRID: subtract convergence and arc-to-chord [rad]."""
        return self._moved("GEODETIC", "GRID", -convergence - arc_to_chord)

    def with_declination(self, declination: float) -> Azimuth:
        """MAGNETIC to GEODETIC: add the declination, positive east [rad]."""
        return self._moved("MAGNETIC", "GEODETIC", declination)

    def minus(self, other: Azimuth) -> float:
        """Difference [rad] in (-pi, pi] of two azimuths of one reference."""
        if other.reference != self.reference:
            raise SurveyError(_mixed(self.reference, other.reference))
        return wrap_pi(self.value - other.value)

    def _moved(self, needed: Reference, result: Reference, change: float) -> Azimuth:
        if self.reference != needed:
            raise SurveyError(_mixed(self.reference, needed))
        return Azimuth(self.value + change, result)


def _mixed(found: Reference, expected: Reference) -> Problem:
    return Problem(
        what="azimuths of different reference cannot be mixed",
        found=found,
        expected=expected,
        hint="Declination belongs to MAGNETIC, the instrument constant to GYRO, "
        "the deflection to ASTRONOMIC, the convergence to GEODETIC.",
    )


def latitude_problem(latitude: float, where: str) -> Problem | None:
    """Refuse a latitude at which a suspended gyro does not work; None where it does."""
    if abs(math.degrees(latitude)) <= MAX_LATITUDE_DEG:
        return None
    return Problem(
        what="a suspended gyro is not used beyond latitude 75 degrees",
        where=where,
        found=f"latitude {math.degrees(latitude):.4f} degrees",
        expected="at most 75 degrees north or south",
        hint="The meridian-seeking moment is below 26 % of that at the equator there; "
        "check the coordinates, or set latitude_max_deg in the instrument's [range].",
    )
