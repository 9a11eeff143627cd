"""Grids of the registers: a projected CRS opened by code, PROJ string or WKT; the search for one.

pyproj is imported on first use and never asks the network; no file that a project names is opened.
"""

from __future__ import annotations

import itertools
import math
import re
from functools import lru_cache
from typing import TYPE_CHECKING, Final

from surveyapp.core.geodesy.grid import Grid
from surveyapp.core.geodesy.library import load_pyproj
from surveyapp.core.geodesy.plane import Plane, axes_of
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said

if TYPE_CHECKING:
    from pyproj import CRS
    from pyproj.database import CRSInfo

_FILES: Final = re.compile(
    r"\+?\b(nadgrids|geoidgrids|grids|file|catalog|init)\s*=|parameterfile|parameter file|\.gsb\b|"
    r"\.gtx\b|file:|[a-z]+://",
    re.IGNORECASE,
)
"""What makes PROJ open a file: a project must not name one."""
_AXES: Final = re.compile(r"\+axis\s*=\s*(\w+)")
"""Turns the axes of a PROJ string after everything else: true east and north stay the same."""
_HARMLESS: Final = re.compile(r"\+?\binit\s*=\s*(epsg|esri):\d+", re.IGNORECASE)


@lru_cache(maxsize=32)
def open_grid(text: str) -> Grid:
    """Open a projected CRS given as EPSG or ESRI code, PROJ string or WKT.

    Raises
    ------
    SurveyError
        If pyproj cannot read it or compute with it, if it names a file, or if it is no projected
        CRS: then it has no convergence.
    """
    axes = _AXES.search(text) if "+proj" in text else None
    crs = _read(text if axes is None else _AXES.sub("", text))
    horizontal = _horizontal(crs)
    named = text if text == horizontal.name else f"{' '.join(text.split())} ({horizontal.name})"
    geod = horizontal.get_geod()
    if not horizontal.is_projected or geod is None:
        raise crs_problem(
            said("a {type_name} has no meridian convergence", type_name=horizontal.type_name), named
        )
    plane = _plane(horizontal, named)
    directions = [axis.direction.lower() for axis in horizontal.axis_info[:2]]
    method = horizontal.coordinate_operation
    area = horizontal.area_of_use or crs.area_of_use
    return Grid(
        text=text,
        name=horizontal.name,
        plane=plane,
        geodesic=geod,
        directions_from_south=("south" in directions and len(set(directions)) == 2)
        or (axes is not None and "s" in axes[1]),
        transverse_mercator=method is not None and _is_transverse(method.method_name),
        area_deg=None if area is None else area.bounds,
    )


def _is_transverse(method: str) -> bool:
    return "transverse mercator" in method.lower().replace("_", " ")


def _read(text: str) -> CRS:
    load_pyproj()
    import pyproj
    from pyproj import CRS
    from pyproj.exceptions import CRSError, ProjError

    pyproj.network.set_network_enabled(active=False)
    if _FILES.search(_HARMLESS.sub("", text)):
        raise crs_problem(
            "the crs names a file, and a project opens none",
            " ".join(text.split())[:200],
            "Leave the datum shift out: directions and coordinates stay in the grid's own datum.",
        )
    try:
        return CRS.from_user_input(text)
    except (CRSError, ProjError) as error:
        raise crs_problem("the crs cannot be read", text, str(error)[:200]) from error


def _horizontal(crs: CRS) -> CRS:
    """The horizontal part of a CRS, without a shift to another datum and without heights."""
    if crs.is_compound:
        crs = crs.sub_crs_list[0]
    if crs.is_bound and crs.source_crs is not None:
        crs = crs.source_crs
    return crs.to_2d() if len(crs.axis_info) > 2 and crs.is_projected else crs


def _plane(crs: CRS, named: str) -> Plane:
    load_pyproj()
    from pyproj import Transformer
    from pyproj.exceptions import CRSError, ProjError

    base = crs.geodetic_crs
    axes = axes_of(crs)
    base_axes = None if base is None else axes_of(base)
    ellipsoid, conversion = crs.ellipsoid, crs.coordinate_operation
    if base_axes is None or ellipsoid is None or axes is None or conversion is None:
        raise crs_problem("the axes of this crs cannot be told apart", named)
    try:
        # its own conversion alone: between two CRS pyproj may choose a change of datum
        transformer = Transformer.from_pipeline(conversion.to_proj4() or "")
    except (CRSError, ProjError) as error:
        # some old grids stand in the register without usable parameters, ESRI's Lo with k = -1
        raise crs_problem(
            "this crs cannot be computed with",
            named,
            "Name the same grid by its EPSG code, or write its parameters as a PROJ string.",
        ) from error
    meridian = crs.prime_meridian
    zero = 0.0
    if meridian is not None:
        zero = float(meridian.longitude) * float(meridian.unit_conversion_factor)
    a, b = float(ellipsoid.semi_major_metre), float(ellipsoid.semi_minor_metre)
    return Plane(transformer, axes, base_axes, zero, a, 1.0 - (b / a) ** 2)


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
    load_pyproj()
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


def crs_problem(what: str, found: str, hint: str = "") -> SurveyError:
    """Error of a crs that cannot be used."""
    return SurveyError(
        Problem(
            what=what,
            where="project.toml, crs",
            found=found,
            expected='a projected CRS as EPSG code ("EPSG:4546"), PROJ string or WKT',
            hint=hint or "Name the grid in which the station coordinates are given.",
        )
    )
