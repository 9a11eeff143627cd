"""Oriented lines and known azimuths against coordinates, scaled by the sigma of both.

Confirmed where both ends are fixed: then a difference beyond chance is a blunder of the one or the
other. The coordinates of an old plan, or those that merely hold a place, only warn.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Final

from surveyapp.core.orientation.known_azimuth import coordinate_error, known_error
from surveyapp.core.orientation.lines import LineGeometry, OrientedLine
from surveyapp.core.orientation.whole_project import Orientation
from surveyapp.core.statistics.distributions import student_quantile
from surveyapp.core.statistics.levels import level_of_one
from surveyapp.core.uncertain import Source, Uncertain
from surveyapp.domain.project import OrientationSession, Station, grid_bearing
from surveyapp.domain.results import Check
from surveyapp.domain.subject import Subject
from surveyapp.languages import said
from surveyapp_models.angles import RHO_ARCSEC, wrap_pi

PLAN_SIGMA_M: Final = 0.1
"""Of each coordinate of a station that is not fixed and states no sigma: read from a plan."""
_CLAUSE: Final = said("difference against its own sigma, level shared over the project")


def coordinate_checks(orientation: Orientation) -> list[Check]:
    """All comparisons of one project; they share one level."""
    pairs = [*_line_pairs(orientation), *_known_pairs(orientation)]
    level = level_of_one(len(pairs))
    return [_judged(pair, level) for pair in pairs]


Pair = tuple[str, Subject, Uncertain, bool, str]
"""Rule, subject, difference, whether it is confirmed, what is compared."""


def _judged(pair: Pair, level: float) -> Check:
    rule, subject, difference, confirmed, text = pair
    dof = max(difference.dof, 1.0)
    limit = student_quantile(1.0 - 0.5 * level, dof) * difference.sigma
    value = abs(wrap_pi(difference.value))
    usable = math.isfinite(limit)
    return Check(
        rule=rule,
        clause=_CLAUSE,
        value=value * RHO_ARCSEC,
        limit=limit * RHO_ARCSEC if usable else None,
        confirmed=confirmed,
        passed=value <= limit if usable else None,
        unit="arcsec",
        where=subject.text,
        text=text + f': {wrap_pi(difference.value) * RHO_ARCSEC:+.1f}"',
        subject=subject,
    )


def _line_pairs(orientation: Orientation) -> list[Pair]:
    pairs: list[Pair] = []
    for line in orientation.lines:
        if line.grid is None:
            continue
        result = line.result
        geometry = _geometry(orientation, line)
        bearing = grid_bearing(geometry.start, geometry.end)
        if bearing is not None:
            error = _plan_error(orientation, geometry)
            difference = line.grid - Uncertain(bearing, error.parts)
            fixed = geometry.start.fixed and geometry.end.fixed
            text = said("grid azimuth minus that of the coordinates")
            pairs.append(("coordinates.line", result.subject, difference, fixed, text))
        pairs += _stated_pairs(orientation, line, geometry)
    return pairs


def _stated_pairs(
    orientation: Orientation, line: OrientedLine, geometry: LineGeometry
) -> list[Pair]:
    """A survey session that states a known azimuth of its own line."""
    pairs: list[Pair] = []
    for name in line.result.sessions:
        session = orientation.project.session(name)
        if session.azimuth_known is None or session.target != line.result.target:
            continue
        if line.grid is None:
            continue
        error = known_error(orientation.project, session, geometry).error
        difference = line.grid - Uncertain(session.azimuth_known, error.parts)
        text = said("grid azimuth minus the known azimuth of session {name}", name=name)
        pairs.append(("known_azimuth.line", line.result.subject, difference, True, text))
    return pairs


def _known_pairs(orientation: Orientation) -> list[Pair]:
    """Known azimuths of calibrations against the coordinates of their line."""
    pairs: list[Pair] = []
    for session in orientation.project.sessions:
        if session.azimuth_known is None or session.target is None:
            continue
        if session.purpose != "calibration":
            continue
        start, end = (_station(orientation, n) for n in (session.station, session.target))
        bearing = grid_bearing(start, end)
        if bearing is None:
            continue
        geometry = _bare(orientation, start, end)
        coordinates = _plan_error(orientation, geometry)
        stated = _own_error(orientation, session, geometry)
        difference = Uncertain(session.azimuth_known, stated.parts) - Uncertain(
            bearing, coordinates.parts
        )
        text = said("known azimuth minus that of the coordinates")
        subject = Subject.session(session.id)
        fixed = start.fixed and end.fixed
        pairs.append(("coordinates.known_azimuth", subject, difference, fixed, text))
    return pairs


def _own_error(
    orientation: Orientation, session: OrientationSession, geometry: LineGeometry
) -> Uncertain:
    """Error of a known azimuth that is independent of the coordinates: stated, or as large."""
    error = known_error(orientation.project, session, geometry)
    if error.origin == "stated":
        return error.error
    name = f"{session.station}-{session.target}"
    return Uncertain(0.0, {Source("known azimuth", name): error.error.sigma})


def _plan_error(orientation: Orientation, geometry: LineGeometry) -> Uncertain:
    """Error of the azimuth from coordinates; those of an unfixed station are an old plan's."""
    project = orientation.project
    error = coordinate_error(project, geometry)
    if not geometry.distance_m:
        return error
    for end in (geometry.start, geometry.end):
        own = project.station(end.name)
        if not own.fixed and own.sigma_m is None:
            source = Source("plan", end.name)
            error = error.with_part(source, PLAN_SIGMA_M / geometry.distance_m)
    return error


def _station(orientation: Orientation, name: str) -> Station:
    at = orientation.positions[name]
    station = orientation.project.station(name)
    return replace(station, e=at.e, n=at.n, latitude=at.latitude, longitude=at.longitude)


def _geometry(orientation: Orientation, line: OrientedLine) -> LineGeometry:
    start, end = (_station(orientation, n) for n in (line.result.station, line.result.target))
    return _bare(orientation, start, end)


def _bare(orientation: Orientation, start: Station, end: Station) -> LineGeometry:
    """A line between two stations, as far as its coordinates are concerned."""
    length = None
    if start.e is not None and start.n is not None and end.e is not None and end.n is not None:
        length = math.hypot(end.e - start.e, end.n - start.n)
    position = orientation.positions[start.name]
    return LineGeometry(
        start=start,
        end=end,
        position=position,
        zenith=0.5 * math.pi,
        convergence=None,
        arc_to_chord=None,
        distance_m=length,
        from_south=False,
    )
