"""What makes a mine unfit for prediction: every reason together, none of them raised here."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

from surveyapp.core.penetration.mine import heading_of_side
from surveyapp.core.penetration.route import REACHED_M, ahead_and_beside
from surveyapp.domain.penetration import Heading, Penetration
from surveyapp.domain.project import Station
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, nearest_names
from surveyapp.languages import said

WHERE = "project.toml, [penetration]"
ACROSS = math.radians(60.0)
BESIDE_M = 1.0
"""How far beside the meeting point a last side may pass that is carried on."""


@dataclass(frozen=True, slots=True)
class Known:
    """What the project declares beside ``[penetration]``.

    Parameters
    ----------
    stations : mapping of str to Station
    instruments, traverses, shafts : collection of str
    oriented : collection of str
        Headings whose traverse or shaft orients them.
    """

    stations: Mapping[str, Station]
    instruments: Collection[str] = ()
    traverses: Collection[str] = ()
    shafts: Collection[str] = ()
    oriented: Collection[str] = ()


def place(heading: Heading) -> str:
    """Where a heading stands, for messages."""
    return f"{WHERE}, heading {heading.name}"


def refusals(plan: Penetration, known: Known) -> list[Problem]:
    """Every reason why the mine cannot be predicted."""
    problems = _headings(plan)
    fit = [heading for heading in plan.headings if placed(heading, known.stations)]
    for heading in plan.headings:
        problems += _route(heading, known)
        if heading in fit:
            problems += _meeting(plan, heading, known.stations)
        problems += _names(heading, known)
    problems += _gyro(plan, known)
    if plan.deflection is not None:
        problems += _deflection(plan, known)
    if len(fit) == len(plan.headings) and fit and not plan.axis_across:
        problems += _axis(plan, known.stations)
    problems += _orientation(plan, known)
    return problems


def placed(heading: Heading, stations: Mapping[str, Station]) -> bool:
    """Whether a heading has a side and all its stations have coordinates."""
    return len(heading.route) >= 2 and all(
        name in stations and stations[name].has_grid_position for name in heading.route
    )


def _headings(plan: Penetration) -> list[Problem]:
    problems = []
    if len(plan.headings) != plan.case.headings:
        problems.append(
            Problem(
                said(
                    "the case {case} needs {headings} [[penetration.heading]]",
                    case=plan.case,
                    headings=plan.case.headings,
                ),
                WHERE,
                str(len(plan.headings)),
                str(plan.case.headings),
            )
        )
    names = [heading.name for heading in plan.headings]
    problems += [
        Problem("two headings have one name", WHERE, name, "unique names")
        for name in dict.fromkeys(names)
        if name and names.count(name) > 1
    ]
    return problems


def _route(heading: Heading, known: Known) -> list[Problem]:
    where, stations = place(heading), known.stations
    problems = []
    for name in dict.fromkeys(heading.route):
        if name not in stations:
            hint = nearest_names(name, stations)
            problems.append(
                Problem("an unknown station", where, name, "a name of a [[station]]", hint)
            )
        elif not stations[name].has_grid_position:
            problems.append(
                Problem("a station of the route has no coordinates", where, name, "e and n")
            )
    if len(heading.route) < 2:
        found = ", ".join(heading.route) or "nothing"
        problems.append(Problem("the route has no side", where, found, "two stations or more"))
        return problems
    first = stations.get(heading.route[0])
    if first is not None and not first.fixed:
        hint = "Set fixed = true where its coordinates are known."
        problems.append(
            Problem(
                "the route does not start at a fixed point", where, first.name, "fixed = true", hint
            )
        )
    if heading.wall and len(heading.wall) != len(heading.route):
        problems.append(
            Problem(
                "wall has another length than the route",
                where,
                said("{size} entries", size=len(heading.wall)),
                said("{size} entries, one per station", size=len(heading.route)),
            )
        )
    if placed(heading, stations):
        problems += _sides(heading, stations)
    return problems


def _sides(heading: Heading, stations: Mapping[str, Station]) -> list[Problem]:
    problems = []
    for a, b in heading.sides:
        p, q = stations[a], stations[b]
        if a == b or math.hypot((q.e or 0.0) - (p.e or 0.0), (q.n or 0.0) - (p.n or 0.0)) <= 0.0:
            problems.append(
                Problem(
                    "a side of the route has no length", place(heading), f"{a}-{b}", "above 0 m"
                )
            )
    repeated = [name for name in dict.fromkeys(heading.route) if heading.route.count(name) > 1]
    if repeated and not problems:
        problems.append(
            Problem("a station stands twice in the route", place(heading), repeated[0], "once")
        )
    return problems


def last_side(heading: Heading, stations: Mapping[str, Station]) -> tuple[float, Station]:
    """Azimuth of the last side [rad] and its end."""
    a, b = stations[heading.route[-2]], stations[heading.route[-1]]
    return math.atan2((b.e or 0.0) - (a.e or 0.0), (b.n or 0.0) - (a.n or 0.0)), b


def _meeting(plan: Penetration, heading: Heading, stations: Mapping[str, Station]) -> list[Problem]:
    """The last station lies at the meeting point, or its side carried on passes it."""
    azimuth, end = last_side(heading, stations)
    gap = (plan.meeting.e - (end.e or 0.0), plan.meeting.n - (end.n or 0.0))
    ahead, beside = ahead_and_beside(gap, azimuth)
    if math.hypot(*gap) <= REACHED_M or (ahead > 0.0 and abs(beside) <= BESIDE_M):
        return []
    found = said(
        "{name} ends {value:.2f} m away, the side passes {beside:.2f} m beside",
        name=end.name,
        value=math.hypot(*gap),
        beside=abs(beside),
    )
    if ahead <= 0.0:
        found = said(
            "{name} ends {value:.2f} m away, the meeting point lies behind",
            name=end.name,
            value=math.hypot(*gap),
        )
    expected = said(
        "the last station within {reached_m:g} m, or its side pointing at the meeting point",
        reached_m=REACHED_M,
    )
    return [Problem("the meeting point is not reached", place(heading), found, expected)]


def carried(plan: Penetration, stations: Mapping[str, Station]) -> list[ResultWarning]:
    """Headings whose last side is carried on to the meeting point, told."""
    warnings = []
    for heading in plan.headings:
        _, end = last_side(heading, stations)
        gap = math.hypot(plan.meeting.e - (end.e or 0.0), plan.meeting.n - (end.n or 0.0))
        if gap > REACHED_M:
            text = said(
                "heading {name} ends {gap:.1f} m before the meeting point: its last "
                "side is carried on",
                name=heading.name,
                gap=gap,
            )
            warnings.append(ResultWarning("carried_to_meeting", text))
    return warnings


def _names(heading: Heading, known: Known) -> list[Problem]:
    problems = []
    for what, name, names in (
        ("traverse", heading.traverse, known.traverses),
        ("shaft", heading.shaft, known.shafts),
    ):
        # a shaft without a table of its own is a name that headings share
        if name and name not in names and (what == "traverse" or names):
            problems.append(
                Problem(
                    said("there is no such {what}", what=what),
                    place(heading),
                    name,
                    said("a [[{what}]] of the project", what=what),
                    nearest_names(name, names),
                )
            )
    return problems


def _gyro(plan: Penetration, known: Known) -> list[Problem]:
    problems = []
    for side in plan.gyro:
        where, shown = said("{where}, gyro", where=WHERE), f"{side.at}-{side.to}"
        unknown = [name for name in (side.at, side.to) if name and name not in known.stations]
        for name in unknown:
            hint = nearest_names(name, known.stations)
            problems.append(
                Problem("an unknown station", where, name, "a name of a [[station]]", hint)
            )
        if not unknown and heading_of_side(plan.headings, side.at, side.to) is None:
            expected = "two neighbouring stations of a route"
            problems.append(Problem("the gyro side is no side of a route", where, shown, expected))
    return problems


def _deflection(plan: Penetration, known: Known) -> list[Problem]:
    field = plan.deflection
    if field is None:
        return []
    where, problems = said("{where}, deflection", where=WHERE), []
    if not math.isfinite(field.latitude):
        problems.append(
            Problem("the latitude is not known", where, "", "latitude_deg, or a crs of the project")
        )
    station = known.stations.get(field.calibrated_at)
    if station is None:
        found = field.calibrated_at or "nothing"
        hint = nearest_names(field.calibrated_at, known.stations) if field.calibrated_at else ""
        problems.append(
            Problem("calibrated_at names no station", where, found, "a name of a [[station]]", hint)
        )
    elif not station.has_grid_position:
        problems.append(Problem("calibrated_at has no coordinates", where, station.name, "e and n"))
    return problems


def _axis(plan: Penetration, stations: Mapping[str, Station]) -> list[Problem]:
    """An axis that lies across the last side of every heading is most likely turned by 90."""
    turns = []
    for heading in plan.headings:
        turn = abs(math.remainder(last_side(heading, stations)[0] - plan.axis_azimuth, math.pi))
        turns.append(turn)
    if min(turns) <= ACROSS:
        return []
    found = ", ".join(f"{math.degrees(turn):.0f} degrees" for turn in turns)
    hint = "Is it the direction across the drive? If it is meant, set axis_across = true."
    return [
        Problem(
            "the axis lies across the last side of every heading",
            f"{WHERE}, axis_azimuth",
            found,
            "the azimuth of the drive at the meeting point",
            hint,
        )
    ]


def _orientation(plan: Penetration, known: Known) -> list[Problem]:
    problems = []
    for heading in plan.headings:
        sides = {frozenset(side) for side in heading.sides}
        by_gyro = any(frozenset((side.at, side.to)) in sides for side in plan.gyro)
        if (
            heading.start.azimuth_sigma is None
            and not by_gyro
            and heading.name not in known.oriented
        ):
            problems.append(
                Problem(
                    "the heading is oriented by neither a start azimuth nor a gyro side",
                    place(heading),
                    "nothing",
                    "start = { azimuth_sigma_arcsec = ... } or a [[penetration.gyro]] on its route",
                )
            )
    return problems


def free_sides(
    plan: Penetration, observed: Sequence[frozenset[str]] = ()
) -> tuple[tuple[str, str], ...]:
    """Sides of all routes without a gyro, in order."""
    taken = {frozenset((side.at, side.to)) for side in plan.gyro} | set(observed)
    return tuple(
        side for heading in plan.headings for side in heading.sides if frozenset(side) not in taken
    )
