"""A constant of degrees that one slip of the hand explains: exchanged, reversed, in another unit.

A constant may have any size, so its size alone only warns. Where the known azimuth, changed as
hands and files change azimuths, makes it one of minutes of arc, the slip is the likelier cause:
each of the handful of slips does so by chance in 0.14 % of all large constants. An automatic gyro
would carry such a slip into every azimuth with a sigma of arc-seconds.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Final

from surveyapp.core.checks.blunders import LARGEST_CONSTANT, LONGEST_LINE_M
from surveyapp.core.geodesy import Grid, Position
from surveyapp.core.orientation.instrument_constant import Calibration, InstrumentConstant
from surveyapp.core.orientation.whole_project import Orientation
from surveyapp.domain.results import Check
from surveyapp.domain.subject import Subject
from surveyapp.errors import SurveyError
from surveyapp.languages import said
from surveyapp_models.angles import wrap_pi

USUAL_CONSTANT: Final = math.radians(0.25)
"""Constants of adjusted instruments: 10'46" and 10'51" at Johannesburg (physics.md section 7)."""
GON: Final = 0.9
"""Degrees of one gon."""
Point = tuple[float, float]
_CLAUSE: Final = said("a constant of degrees that one slip explains")
_SIGHT: Final = said("nobody sights so far with a gyro-theodolite")


def slip_checks(orientation: Orientation) -> list[Check]:
    """A check, not met, for every line too long to be sighted and every constant made by a slip."""
    return [*_too_long(orientation), *_slips(orientation)]


def _too_long(orientation: Orientation) -> list[Check]:
    """Oriented lines whose coordinates cannot both be right: one makes a wrong convergence."""
    return [
        Check(
            rule="coordinates.length",
            clause=_SIGHT,
            value=line.result.distance_m,
            limit=LONGEST_LINE_M,
            confirmed=True,
            passed=False,
            unit="m",
            where=line.result.subject.text,
            text=said("length of the line by its coordinates: is one of the stations mistyped?"),
            subject=line.result.subject,
        )
        for line in orientation.lines
        if line.result.distance_m is not None and line.result.distance_m > LONGEST_LINE_M
    ]


def _slips(orientation: Orientation) -> list[Check]:
    return [
        _failed(calibration, slip, value)
        for constant in orientation.constants
        for calibration in constant.calibrations
        if _is_large(constant, calibration)
        for slip, value in _likeliest(orientation, calibration)
    ]


def _is_large(constant: InstrumentConstant, calibration: Calibration) -> bool:
    """Whether a constant is one of degrees, and nobody states beforehand that it is."""
    value = calibration.value.value
    if constant.known is not None:
        value = wrap_pi(value - constant.known.value)
    return abs(value) > LARGEST_CONSTANT


def _likeliest(orientation: Orientation, item: Calibration) -> list[tuple[str, float]]:
    """The slip that leaves the smallest constant [rad], none where all leave a large one."""
    found = [
        (slip, value)
        for slip, change in _changes(orientation, item)
        if abs(value := wrap_pi(item.value.value + change)) <= USUAL_CONSTANT
    ]
    return sorted(found, key=lambda entry: abs(entry[1]))[:1]


def _changes(orientation: Orientation, item: Calibration) -> Iterator[tuple[str, float]]:
    """Every slip with the change of the true azimuth [rad] that mends it."""
    yield said("station and target of the known line are exchanged"), math.pi
    stated = orientation.project.session(item.session).azimuth_known
    if stated is None or item.target != orientation.project.session(item.session).target:
        yield from _of_coordinates(orientation, item)
        return
    yield said("the known azimuth is in gon"), stated * GON - stated
    if stated < 2.0 * math.pi * GON:
        yield said("the known azimuth is in degrees, not in gon"), stated / GON - stated


def _of_coordinates(orientation: Orientation, item: Calibration) -> Iterator[tuple[str, float]]:
    """Slips of coordinates that both stations of the known line share, in the area of the grid."""
    grid = orientation.grid
    start, end = (orientation.positions[name] for name in (item.station, item.target))
    if grid is None:
        return
    before = _true(grid, start, end, lambda e, n: (e, n))
    slips: tuple[tuple[str, Callable[[float, float], Point]], ...] = (
        (said("east and north of the known line are exchanged"), lambda e, n: (n, e)),
        (said("north of the known line has the wrong sign"), lambda e, n: (e, -n)),
        (said("east of the known line has the wrong sign"), lambda e, n: (-e, n)),
    )
    for text, mend in slips:
        after = _true(grid, start, end, mend)
        if before is not None and after is not None:
            yield text, after - before


def _true(
    grid: Grid, start: Position, end: Position, mend: Callable[[float, float], Point]
) -> float | None:
    """True azimuth [rad] of a line with mended coordinates, None where they cannot be meant."""
    if start.e is None or start.n is None or end.e is None or end.n is None:
        return None
    at, to = mend(start.e, start.n), mend(end.e, end.n)
    try:
        latitude, longitude = grid.geographic(e=at[0], n=at[1])
        if grid.area_deg is not None and grid.is_beside(latitude=latitude, longitude=longitude):
            return None
        convergence = grid.convergence(latitude=latitude, longitude=longitude)
    except SurveyError:
        return None
    return math.atan2(to[0] - at[0], to[1] - at[1]) + convergence


def _failed(item: Calibration, slip: str, value: float) -> Check:
    subject = Subject.session(item.session, item.target)
    text = said(
        "{station}-{target}: the constant is {constant:+.4f} degrees; it would be {value:+.4f} if "
        "{slip}",
        station=item.station,
        target=item.target,
        constant=math.degrees(item.value.value),
        value=math.degrees(value),
        slip=slip,
    )
    return Check(
        rule="constant.slip",
        clause=_CLAUSE,
        value=abs(math.degrees(item.value.value)),
        limit=math.degrees(LARGEST_CONSTANT),
        confirmed=True,
        passed=False,
        unit="deg",
        where=subject.text,
        text=text,
        subject=subject,
    )
