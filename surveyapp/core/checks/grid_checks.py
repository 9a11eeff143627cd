"""Whether a grid may be used where the stations lie: coordinates in another unit or exchanged.

A grid without an area of use takes any coordinates. What it does to directions and lengths there
tells that they cannot be meant: then nothing that is computed with it is right.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from surveyapp.core.geodesy import Grid, Position, grid_of, position_of
from surveyapp.core.geodesy.plane import Differential
from surveyapp.core.orientation.whole_project import Orientation
from surveyapp.domain.project import Project
from surveyapp.domain.results import Check
from surveyapp.domain.subject import Subject
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import joined, said

SCALE_MARGIN: Final = 0.1
"""UTM has 0.9996 to 1.001, six degrees off the axis 1.005; a foot is 0.3 of a metre."""
MOST_CONVERGENCE_DEG: Final = 10.0
"""On a transverse Mercator: 3 degrees off the axis at latitude 75 make 2.9 degrees."""
MOST_ARC_TO_CHORD_ARCMIN: Final = 1.0
"""10 km long and 100 km off the axis: 2.5" (physics.md 3.4)."""
MOST_DISTORTION_ARCMIN: Final = 1.0
"""Of an angle, by a grid that is not conformal: beyond, a convergence says nothing."""
MOST_BEYOND_DEG: Final = 3.0
"""Outside of the area of use of the crs: 330 km. A grid of a country is carried on across its
border, not across the next country; a million left out of a northing makes nine degrees, feet in
place of metres more."""

_CLAUSE: Final = said("no survey is computed so: unit, order of the coordinates, or crs")
_QUESTION: Final = said(
    "are the coordinates metres (whatever the unit of the grid), east and "
    "north not exchanged, and is it the right crs?"
)


@dataclass(frozen=True, slots=True)
class _Place:
    """What the grid does at one station."""

    station: str
    local: Differential
    beyond_deg: float

    @property
    def scale_error(self) -> float:
        """Scale factor minus 1, the one furthest from 0."""
        return max((scale - 1.0 for scale in self.local.scales), key=abs)


def grid_checks(orientation: Orientation) -> list[Check]:
    """Scale, angles and convergence of the grid at the worst station, arc-to-chord of a side."""
    grid = orientation.grid
    if grid is None:
        return []
    used = {item.session.station for item in orientation.sessions}
    positions = {name: orientation.positions[name] for name in sorted(used)}
    return [*_place_checks(grid, positions), *_chord_check(orientation)]


def refuse_unfit_grid(project: Project) -> None:
    """Refuse a grid with which no survey is computed: for results that carry no checks.

    Raises
    ------
    SurveyError
        With every check of the grid that is not met.
    """
    grid = grid_of(project)
    if grid is None:
        return
    occupied = {session.station for session in project.sessions}
    positions = {
        station.name: position_of(station, grid)
        for station in project.stations
        if station.name in occupied
    }
    problems = [
        Problem(
            check.text,
            said("station {where} in {name}", where=check.where, name=grid.name),
            "",
            check.clause,
            _QUESTION,
        )
        for check in _place_checks(grid, positions)
        if check.passed is False
    ]
    if problems:
        raise SurveyError(problems)


def _place_checks(grid: Grid, positions: dict[str, Position]) -> list[Check]:
    places = [
        _Place(
            name,
            grid.differential(latitude=at.latitude, longitude=at.longitude),
            grid.beyond_deg(latitude=at.latitude, longitude=at.longitude),
        )
        for name, at in positions.items()
        if at.latitude is not None and at.longitude is not None
    ]
    if not places:
        return []
    scaled = max(places, key=lambda place: abs(place.scale_error))
    bent = max(places, key=lambda place: place.local.distortion)
    turned = max(places, key=lambda place: abs(place.local.convergence))
    scale, angle = 1.0 + scaled.scale_error, math.degrees(bent.local.distortion) * 60.0
    checks = [
        _check(
            "scale",
            Subject.of("station", scaled.station),
            abs(scale - 1.0),
            SCALE_MARGIN,
            text=said("scale factor {scale:.6f}", scale=scale),
        ),
        _check(
            "angles",
            Subject.of("station", bent.station),
            angle,
            MOST_DISTORTION_ARCMIN,
            text=said("the grid changes angles by up to {angle:.3f}'", angle=angle),
            unit="arcmin",
        ),
    ]
    if grid.transverse_mercator:
        degrees = math.degrees(turned.local.convergence)
        text = said(
            "convergence of the transverse Mercator {degrees:+.4f} degrees", degrees=degrees
        )
        limit = MOST_CONVERGENCE_DEG
        subject = Subject.of("station", turned.station)
        checks.append(_check("convergence", subject, abs(degrees), limit, text=text, unit="deg"))
    return [*checks, *_area_check(grid, places)]


def _area_check(grid: Grid, places: Sequence[_Place]) -> list[Check]:
    """The station furthest from the area of use of the crs, where one lies outside of it."""
    far = max(places, key=lambda place: place.beyond_deg)
    if far.beyond_deg == 0.0:
        return []
    text = said(
        "{beyond:.1f} degrees outside of the area of {grid}", beyond=far.beyond_deg, grid=grid.name
    )
    subject = Subject.of("station", far.station)
    return [_check("area", subject, far.beyond_deg, MOST_BEYOND_DEG, text=text, unit="deg")]


def _chord_check(orientation: Orientation) -> list[Check]:
    sides = [
        (Subject.side(line.result.station, line.result.target), line.result.arc_to_chord)
        for line in orientation.lines
    ]
    known = [(side, chord) for side, chord in sides if chord is not None]
    if not known:
        return []
    side, chord = max(known, key=lambda item: abs(item[1]))
    minutes = math.degrees(chord) * 60.0
    text = said("arc-to-chord of the side {minutes:+.4f}'", minutes=minutes)
    limit = MOST_ARC_TO_CHORD_ARCMIN
    return [_check("arc_to_chord", side, abs(minutes), limit, text=text, unit="arcmin")]


def _check(
    rule: str, subject: Subject, value: float, limit: float, *, text: str, unit: str = ""
) -> Check:
    passed = value <= limit
    return Check(
        rule=f"grid.{rule}",
        clause=_CLAUSE,
        value=value,
        limit=limit,
        confirmed=True,
        passed=passed,
        unit=unit,
        where=subject.text,
        text=text if passed else joined(": ", (text, _QUESTION)),
        subject=subject,
    )
