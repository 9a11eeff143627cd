"""The error of a known azimuth: stated, else from the coordinates of the two ends.

A known line is itself the result of a survey. Its error is the same in every determination on it,
does not average out, and is shared by all lines that begin or end at the same station.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final, Literal

from surveyapp.core.orientation.lines import LineGeometry
from surveyapp.core.uncertain import Source, Uncertain
from surveyapp.domain.project import OrientationSession, Project, Station
from surveyapp_models.angles import ARCSEC

STATION_SIGMA_M: Final = 0.005
"""Of each coordinate against the neighbouring station where neither station, project nor rule book
states one: control by total station or satellite is good to a few millimetres."""
AZIMUTH_SIGMA: Final = 5.0 * ARCSEC
"""Of a known azimuth whose line has no length. Source: Instruction for mine surveying (USSR, 1985),
side of the surface control; as cited in the issue, not read."""
FINEST_DECIMALS: Final = 12
COARSEST_DECIMALS: Final = 6
EARTH_RADIUS_M: Final = 6371000.0
NAME: Final = "known azimuth"

Origin = Literal["stated", "coordinates", "default"]


@dataclass(frozen=True, slots=True)
class KnownError:
    """Zero with the error of a known azimuth [rad], and where it comes from."""

    error: Uncertain
    origin: Origin


def known_error(project: Project, session: OrientationSession, line: LineGeometry) -> KnownError:
    """Error of the known azimuth of a line.

    Parameters
    ----------
    project : Project
        Its ``station_sigma_m`` (or the rule book's) holds for stations that state none.
    session : OrientationSession
        Its ``azimuth_known_sigma`` wins for its own target.
    line : LineGeometry
    """
    if session.azimuth_known_sigma is not None and line.end.name == session.target:
        name = "-".join(sorted((line.start.name, line.end.name)))
        return KnownError(_zero_with(Source(NAME, name), session.azimuth_known_sigma), "stated")
    if not line.distance_m:
        name = "-".join(sorted((line.start.name, line.end.name)))
        return KnownError(_zero_with(Source(NAME, name), AZIMUTH_SIGMA), "default")
    error = coordinate_error(project, line)
    stated = all(_stated_sigma(project, end) is not None for end in (line.start, line.end))
    return KnownError(error, "coordinates" if stated else "default")


def coordinate_error(project: Project, line: LineGeometry) -> Uncertain:
    """Zero with the error [rad] that the coordinates of its ends give an azimuth.

    d alpha = (cos alpha (dE2 - dE1) - sin alpha (dN2 - dN1)) / s.
    """
    start, end = line.start, line.end
    if not line.distance_m or None in (start.e, start.n, end.e, end.n):
        return Uncertain(0.0)
    azimuth = math.atan2((end.e or 0.0) - (start.e or 0.0), (end.n or 0.0) - (start.n or 0.0))
    rounding = _rounding_m(project.station(start.name), project.station(end.name))
    parts: dict[Source, float] = {}
    for sign, station in ((-1.0, start), (1.0, end)):
        stated = _stated_sigma(project, station)
        sigma = math.hypot(STATION_SIGMA_M if stated is None else stated, rounding)
        by_length = sign * sigma / line.distance_m
        parts[Source(NAME, station.name, detail="e")] = math.cos(azimuth) * by_length
        parts[Source(NAME, station.name, detail="n")] = -math.sin(azimuth) * by_length
    return Uncertain(0.0, {source: part for source, part in parts.items() if part != 0.0})


def _stated_sigma(project: Project, station: Station) -> float | None:
    return station.sigma_m if station.sigma_m is not None else project.station_sigma_m


def _zero_with(source: Source, sigma: float) -> Uncertain:
    return Uncertain(0.0, {source: sigma} if sigma > 0.0 else {})


def _rounding_m(start: Station, end: Station) -> float:
    """Sigma of each coordinate [m] from the last digit of latitudes and longitudes.

    The line is as fine as its finest number: zeros at the end of a number are not seen.
    """
    angles = (start.latitude, start.longitude, end.latitude, end.longitude)
    if any(angle is None for angle in angles):
        return 0.0
    digits = max(_decimals(math.degrees(angle)) for angle in angles if angle is not None)
    return math.radians(10.0**-digits) * EARTH_RADIUS_M / math.sqrt(12.0)


def _decimals(degrees: float) -> int:
    """Decimals with which a number of degrees was written."""
    text = f"{degrees:.{FINEST_DECIMALS}f}".rstrip("0")
    return max(len(text.partition(".")[2]), COARSEST_DECIMALS)
