"""Blunders that no statistic notices: a face typed wrongly, exchanged coordinates, one mark twice.

Each would give an azimuth with a fine sigma that is wrong by degrees. What cannot be meant is
refused, what is merely odd is a warning; nothing is corrected here.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Final

from surveyapp.core.geodesy import Grid
from surveyapp.core.orientation.lines import LineGeometry
from surveyapp.core.swing.sights import SightSet
from surveyapp.domain.mine_grid import StatedConvergence
from surveyapp.domain.project import OrientationSession, Project, Station
from surveyapp.domain.results import LineResult
from surveyapp.domain.subject import Subject
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said
from surveyapp_models.angles import ARCSEC, RHO_ARCSEC, wrap_pi

MAX_COLLIMATION: Final = math.radians(0.2)
"""No theodolite is as badly adjusted; a slip of one degree in one of four sights makes 0.25. A
bound of reason: no source states one."""
LARGEST_TWIST: Final = math.radians(1.0)
"""No tripod turns further during one observation and is still read."""
SHORTEST_LINE_M: Final = 1.0
"""Below it lies the shortest focusing distance: two stations at one place."""
LARGEST_CONSTANT: Final = math.radians(1.0)
"""Printed constants are minutes of arc (10'51" at Johannesburg); more is more likely a slip."""
SIGMAS_OF_CONVERGENCE: Final = 4.0
"""A stated convergence further from the computed one is another one (6 in 100000 by chance)."""
LEAST_CONVERGENCE_LIMIT: Final = 0.1 * ARCSEC
"""Old tables were computed by series to their last digit."""
LONGEST_LINE_M: Final = 50_000.0
"""Nobody sights further with a gyro-theodolite: coordinates in the wrong order or grid do."""


def refuse_wrong_faces(session: OrientationSession, sights: SightSet) -> None:
    """Refuse sights whose two faces do not lie half a circle apart.

    Raises
    ------
    SurveyError
        If the collimation would be above ``MAX_COLLIMATION``.
    """
    if sights.collimation is None or abs(sights.collimation) <= MAX_COLLIMATION:
        refuse_other_sights(session, sights)
        return
    apart = 180.0 - 2.0 * math.degrees(sights.collimation)
    raise SurveyError(
        Problem(
            what=said(
                "the two faces of the sights of {target} do not lie half a circle apart",
                target=sights.target,
            ),
            where=said("session {id}, {book_path}", id=session.id, book_path=session.book_path),
            found=said("{value:.4f} degrees apart", value=apart % 360.0),
            expected=said(
                "180 degrees, within {value:g}", value=2.0 * math.degrees(MAX_COLLIMATION)
            ),
            hint="A face (L, R) or a reading is typed wrongly: strike it and enter it anew.",
        )
    )


def refuse_other_sights(session: OrientationSession, sights: SightSet) -> None:
    """Refuse sights of one target that cannot be of one direction.

    Raises
    ------
    SurveyError
        If sights of one face lie further apart than any pointing error, or if the sights before
        and after do so by more than a tripod can turn.
    """
    turned = 0.0 if sights.drift is None else abs(sights.drift)
    if sights.largest_residual <= MAX_COLLIMATION and turned <= LARGEST_TWIST:
        return
    apart = math.degrees(max(2.0 * sights.largest_residual, turned))
    hint = "A reading is typed wrongly, or another target was sighted: strike it and enter it anew."
    if not sights.faces_known:
        hint = (
            "Are they of two faces? Write L or R beside each sight. Else a reading is typed "
            "wrongly, or another target was sighted: strike it and enter it anew."
        )
    raise SurveyError(
        Problem(
            what=said(
                "the sights of {target} do not belong to one direction", target=sights.target
            ),
            where=said("session {id}, {book_path}", id=session.id, book_path=session.book_path),
            found=said("{apart:.4f} degrees apart in one face", apart=apart),
            expected=said("within {value:g} degrees", value=2.0 * math.degrees(MAX_COLLIMATION)),
            hint=hint,
        )
    )


def refuse_one_place(geometry: Mapping[tuple[str, str], LineGeometry]) -> None:
    """Refuse lines whose two stations have one position: such a line has no azimuth.

    Raises
    ------
    SurveyError
        With all such lines together.
    """
    problems = {
        (line.start.name, line.end.name): Problem(
            what=said(
                "{name} and {name2} stand at one place", name=line.start.name, name2=line.end.name
            ),
            where=said("session {session}", session=session),
            found=said("{distance_m:.3f} m apart", distance_m=line.distance_m),
            expected=said("at least {shortest_line_m:g} m", shortest_line_m=SHORTEST_LINE_M),
            hint="Correct the coordinates of one of them, or leave them out.",
        )
        for (session, _), line in geometry.items()
        if line.distance_m is not None and line.distance_m < SHORTEST_LINE_M
    }
    if problems:
        raise SurveyError(problems.values())


def stated_convergence(session: OrientationSession, station: Station) -> StatedConvergence | None:
    """The convergence stated for a session: its own, else that of its station."""
    return session.convergence if session.convergence is not None else station.convergence


def refuse_other_convergence(
    project: Project, geometry: Mapping[tuple[str, str], LineGeometry]
) -> None:
    """Refuse a printed convergence that is not the one of the grid: one of the two is wrong.

    Raises
    ------
    SurveyError
        With all such stations together.
    """
    problems = {}
    for (name, _), line in geometry.items():
        session = project.session(name)
        stated = stated_convergence(session, project.station(session.station))
        if stated is None or line.convergence is None:
            continue
        apart = wrap_pi(stated.value - line.convergence)
        if abs(apart) > max(SIGMAS_OF_CONVERGENCE * stated.sigma, LEAST_CONVERGENCE_LIMIT):
            problems[session.station] = Problem(
                what=said(
                    "the convergence at {station} is given twice and differently",
                    station=session.station,
                ),
                where=said("session {id}", id=session.id),
                found=said(
                    'stated {value:+.2f}" off the one of the grid', value=apart * RHO_ARCSEC
                ),
                expected="the same, or only one of the two",
                hint="Is it the right crs, and has the stated convergence its right sign?",
            )
    if problems:
        raise SurveyError(problems.values())


def place_warnings(lines: Sequence[LineGeometry], grid: Grid | None) -> list[ResultWarning]:
    """Warn of lines too long to be sighted, and of stations beside the area of the grid."""
    warnings: list[ResultWarning] = []
    for line in lines:
        name = f"{line.start.name}-{line.end.name}"
        if line.distance_m is not None and line.distance_m > LONGEST_LINE_M:
            text = said(
                "line {name} is {distance_m:.0f} km long by its coordinates: are they in "
                "the right order, and in this grid?",
                name=name,
                distance_m=line.distance_m / 1000.0,
            )
            side = Subject.side(line.start.name, line.end.name)
            warnings.append(ResultWarning("line_long", text, side))
        at = line.position
        if grid is None or at.latitude is None or at.longitude is None:
            continue
        if grid.is_beside(latitude=at.latitude, longitude=at.longitude):
            text = said(
                "station {name} (latitude {latitude:.2f}, longitude {longitude:.2f}) lies "
                "beside the area of {name2}: are the coordinates in the right order, and "
                "is it the right crs?",
                name=line.start.name,
                latitude=math.degrees(at.latitude),
                longitude=math.degrees(at.longitude),
                name2=grid.name,
            )
            subject = Subject.of("station", line.start.name)
            warnings.append(ResultWarning("outside_grid", text, subject))
    return list(dict.fromkeys(warnings))


def azimuth_warnings(line: LineResult) -> list[ResultWarning]:
    """Warn of a constant of degrees, and of an azimuth degrees away from the coordinates."""
    name = said("line {station}-{target}", station=line.station, target=line.target)
    warnings = []
    if line.constant is not None and abs(line.constant) > LARGEST_CONSTANT:
        text = said(
            "{name}: the instrument constant is {constant:+.4f} degrees: is the known "
            "azimuth right, and were sight and target the right ones?",
            name=name,
            constant=math.degrees(line.constant),
        )
        warnings.append(ResultWarning("constant_large", text, line.subject))
    if line.grid_azimuth is not None and line.existing_azimuth is not None:
        apart = wrap_pi(line.grid_azimuth.value - line.existing_azimuth)
        if abs(apart) > LARGEST_CONSTANT:
            text = said(
                "{name}: the grid azimuth lies {apart:+.4f} degrees off the coordinates: "
                "was this the target, and are the coordinates in the right order?",
                name=name,
                apart=math.degrees(apart),
            )
            warnings.append(ResultWarning("far_from_coordinates", text, line.subject))
    return warnings
