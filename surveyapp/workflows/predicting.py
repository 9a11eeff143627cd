"""A project made ready for prediction: its table, traverses, gyros and rule book, all checked.

Every problem of all of them comes in one error.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

from surveyapp.core.penetration.mine import MeasuredRows, Mine, build_mine
from surveyapp.core.penetration.refusals import (
    WHERE,
    Known,
    carried,
    free_sides,
    placed,
    refusals,
)
from surveyapp.core.penetration.rows import RowKind
from surveyapp.domain.penetration import Heading, Penetration
from surveyapp.domain.project import Project, Station
from surveyapp.domain.results import OrientationResult
from surveyapp.domain.rulebook import RuleBook
from surveyapp.domain.shaft_result import ShaftOrientation
from surveyapp.domain.traverse_book import Traverse
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.findings import Findings
from surveyapp.io.penetration.measured import header_sigmas, measured_rows
from surveyapp.languages import said
from surveyapp.workflows.plumbing import orient_shafts


@dataclass(frozen=True, slots=True)
class ReadyMine:
    """A mine ready for prediction, with its rule book and what its reader must know.

    ``defaults`` holds the instrument and the sigma [rad] of a further gyro side in a heading that
    has none.
    """

    mine: Mine
    rule_book: RuleBook | None
    defaults: dict[str, tuple[str, float]]
    warnings: tuple[ResultWarning, ...]
    project: str = ""
    digest: str = ""


@dataclass(slots=True)
class _Gathered:
    """What is gathered before it is judged."""

    project: Project
    findings: Findings
    measured: dict[str, MeasuredRows]


def has_penetration(project: Project) -> bool:
    """Whether the project holds a ``[penetration]`` table."""
    return project.penetration is not None


def penetration_plan(project: Project, findings: Findings) -> Penetration:
    """The ``[penetration]`` table of a project; its problems go to the findings.

    Raises
    ------
    SurveyError
        If there is none.
    """
    table = project.penetration
    if table is None:
        raise SurveyError(
            Problem(
                "the project holds no breakthrough",
                "project.toml",
                "no [penetration]",
                "[penetration] with its headings",
                "docs/how-to/predict-a-breakthrough.md shows one",
            )
        )
    findings.problems += table.problems
    findings.warnings += table.warnings
    return table.plan


def ready_mine(
    project: Project, orientation: OrientationResult | None, *, plan_sides: int | None = None
) -> ReadyMine:
    """Read everything that a prediction needs and refuse what cannot be predicted.

    Parameters
    ----------
    project : Project
    orientation : OrientationResult or None
        What the sessions have oriented; None without sessions.
    plan_sides : int or None
        Further gyro sides that are asked for.

    Raises
    ------
    SurveyError
        With every problem together.
    """
    gathered = _Gathered(project, Findings(), {})
    plan = penetration_plan(project, gathered.findings)
    stations = {station.name: station for station in project.stations}
    plan = _with_latitude(project, plan, stations)
    plan, fed = _with_shafts(project, plan, gathered.findings)
    headers = {item.name: item for item in project.traverses}
    lost = _measure(gathered, plan, headers, orientation)
    defaults = _defaults(project, plan)
    used = _used(plan, gathered.measured, defaults)
    constants, unknown = _constants(project, used, orientation)
    problems = gathered.findings.problems
    problems += refusals(plan, _known(project, plan, headers, gathered.measured))
    problems += _angle_problems(plan, gathered.measured)
    problems += _plan_problems(plan, gathered.measured, plan_sides)
    gathered.findings.raise_if_any()
    mine = build_mine(plan, stations, constants, gathered.measured)
    warnings = (*project.warnings, *gathered.findings.told(), *unknown, *lost, *fed)
    warnings = (*warnings, *carried(plan, stations))
    return ReadyMine(mine, project.rules, defaults, warnings, project.name, project.digest)


def _measure(
    gathered: _Gathered,
    plan: Penetration,
    headers: Mapping[str, Traverse],
    orientation: OrientationResult | None,
) -> list[ResultWarning]:
    """Rows of the traverses of all headings; what does not enter is told."""
    stations = {station.name: station for station in gathered.project.stations}
    lines = () if orientation is None else orientation.lines
    warnings = []
    named = [headers[h.traverse] for h in plan.headings if h.traverse in headers]
    for heading in plan.headings:
        header = headers.get(heading.traverse)
        if header is None:
            if named:  # the sigmas of the traverses named are the default of all
                gathered.measured[heading.name] = MeasuredRows((), {}, {}, header_sigmas(named[0]))
            continue
        if not placed(heading, stations):
            continue
        measured, lost = measured_rows(
            heading,
            header,
            stations,
            lines,
            deflection_apart=plan.deflection is not None,
        )
        gathered.measured[heading.name] = measured
        if lost:
            text = said(
                "traverse {name}: {lost} observations join no neighbouring sides of "
                "the route of heading {name2} and do not enter the prediction",
                name=header.name,
                lost=lost,
                name2=heading.name,
            )
            warnings.append(ResultWarning("rows_beside_route", text))
    return warnings


def _constants(
    project: Project, used: Mapping[str, bool], orientation: OrientationResult | None
) -> tuple[dict[str, float], list[ResultWarning]]:
    """Sigma of the constant of every gyro [rad]: calibrations win over what is known.

    ``used`` tells whether a gyro observes already; one that only may be planned is not warned of.
    """
    calibrated = {} if orientation is None else {c.instrument: c for c in orientation.constants}
    known = {item.id: item for item in project.instruments}
    found: dict[str, float] = {}
    warnings = []
    for name, observes in used.items():
        if name not in known:
            continue
        result, stated = calibrated.get(name), known[name].known_constant
        sigma = _in_force(name, orientation)  # what an adjustment of these lines takes
        if sigma is None and result is not None and result.value is not None:
            sigma = result.sigma
        if sigma is None or not math.isfinite(sigma):
            sigma = None if stated is None else stated[1]
        if sigma is None and observes:
            text = said(
                "instrument {name}: no constant is known, so its shared error counts "
                "as 0; calibrate it, or give constant = {{ arcsec, sigma_arcsec }}",
                name=name,
            )
            warnings.append(ResultWarning("constant_sigma_unknown", text))
        found[name] = sigma or 0.0
    return found, warnings


def _in_force(name: str, orientation: OrientationResult | None) -> float | None:
    """Sigma of the constant with which the lines of a gyro were oriented [rad]."""
    lines = () if orientation is None else orientation.lines
    found = [
        line.constant_sigma
        for line in lines
        if line.instrument == name and line.constant_sigma is not None
    ]
    if not found:
        return None
    return math.sqrt(sum(sigma**2 for sigma in found) / len(found))


def _used(
    plan: Penetration,
    measured: Mapping[str, MeasuredRows],
    defaults: Mapping[str, tuple[str, float]],
) -> dict[str, bool]:
    """Gyros of the mine, and whether they observe already or may only be planned."""
    used = [side.instrument for side in plan.gyro]
    for rows in measured.values():
        used += [row.instrument for row in rows.rows if row.kind is RowKind.GYRO]
    planned = [name for name, _ in defaults.values()]
    return {**dict.fromkeys(planned, False), **dict.fromkeys(used, True)}


def _defaults(project: Project, plan: Penetration) -> dict[str, tuple[str, float]]:
    """Instrument and sigma of a further side in each heading: its first one, else the card's."""
    found: dict[str, tuple[str, float]] = {}
    cards = {item.id: item.card.sigma.azimuth for item in project.instruments}
    for heading in plan.headings:
        sides = {frozenset(side) for side in heading.sides}
        own = [side for side in plan.gyro if frozenset((side.at, side.to)) in sides]
        if own:
            found[heading.name] = (own[0].instrument, own[0].sigma)
            continue
        # a heading without a gyro takes the one that the mine uses elsewhere, else any with a card
        names = [*(side.instrument for side in plan.gyro), *cards]
        sigma = next(((n, s) for n in names if (s := cards.get(n)) is not None), None)
        if sigma is not None:
            found[heading.name] = sigma
    return found


def _known(
    project: Project,
    plan: Penetration,
    headers: Mapping[str, Traverse],
    measured: Mapping[str, MeasuredRows],
) -> Known:
    shafts = [] if project.shafts is None else [shaft.id for shaft in project.shafts.shafts]
    oriented = {
        name
        for name, rows in measured.items()
        if any(row.kind in (RowKind.GYRO, RowKind.AZIMUTH) for row in rows.rows)
    }
    return Known(
        {station.name: station for station in project.stations},
        [item.id for item in project.instruments],
        headers,
        shafts,
        oriented,
    )


def _angle_problems(plan: Penetration, measured: Mapping[str, MeasuredRows]) -> list[Problem]:
    """A heading with an angle that nobody gives a sigma."""
    problems = []
    for heading in plan.headings:
        rows = measured.get(heading.name)
        assumed = plan.sigmas.angle if rows is None else plan.sigmas.angle or rows.sigmas.angle
        done = 0
        if rows is not None:
            done = len({row.side for row in rows.rows if row.kind is RowKind.ANGLE})
        if assumed is None and plan.sigmas.angle is None and done < len(heading.route) - 2:
            problems.append(
                Problem(
                    "the angles have no sigma",
                    said("{where}, heading {name}", where=WHERE, name=heading.name),
                    "nothing",
                    "sigma_angle_arcsec, or a traverse with one",
                )
            )
    return problems


def observed_sides(measured: Mapping[str, MeasuredRows], plan: Penetration) -> list[frozenset[str]]:
    """Sides whose gyro azimuth a traverse has already."""
    found = []
    for heading in plan.headings:
        rows = measured.get(heading.name)
        if rows is not None:
            found += [
                frozenset(heading.sides[row.side]) for row in rows.rows if row.kind is RowKind.GYRO
            ]
    return found


def _plan_problems(
    plan: Penetration, measured: Mapping[str, MeasuredRows], sides: int | None
) -> list[Problem]:
    if sides is None:
        return []
    free = len(free_sides(plan, observed_sides(measured, plan)))
    if 1 <= sides <= free:
        return []
    return [
        Problem(
            "more gyro sides are asked for than sides are free" if sides > 0 else "no sides asked",
            "plan",
            str(sides),
            said("1 to {free}", free=free),
        )
    ]


def _with_shafts(
    project: Project, plan: Penetration, findings: Findings
) -> tuple[Penetration, list[ResultWarning]]:
    """Starts of headings from the shafts through which they begin: azimuth and depth."""
    named = {heading.shaft for heading in plan.headings if heading.shaft}
    if not named or project.shafts is None:
        return plan, []
    try:
        shafts = {item.id: item for item in orient_shafts(project, software="").shafts}
    except SurveyError as refused:
        findings.absorb(refused)
        return plan, []
    headings, warnings = [], []
    for heading in plan.headings:
        shaft = shafts.get(heading.shaft)
        if shaft is not None:
            heading, told = _fed(heading, shaft)
            warnings += told
        headings.append(heading)
    return replace(plan, headings=tuple(headings)), warnings


def _fed(heading: Heading, shaft: ShaftOrientation) -> tuple[Heading, list[ResultWarning]]:
    """A heading with the start that its shaft gives; what the project states wins."""
    if heading.height_transfer_m is None:
        heading = replace(heading, height_transfer_m=shaft.depth.m)
    if heading.start.azimuth_sigma is not None:
        return heading, []
    where = f"heading {heading.name}, shaft {shaft.id}"
    if shaft.combined.azimuth is None:
        text = said(
            "{where}: wires and gyro contradict each other, no start azimuth is taken from them",
            where=where,
        )
        return heading, [ResultWarning("shaft_contradicts", text)]
    if heading.sides and set(heading.sides[0]) != {shaft.at, shaft.to}:
        text = said(
            "{where}: it orients {at}-{to}, which is not the first side",
            where=where,
            at=shaft.at,
            to=shaft.to,
        )
        return heading, [ResultWarning("shaft_side_not_first", text)]
    start = replace(heading.start, azimuth_sigma=shaft.combined.azimuth.sigma)
    return replace(heading, start=start), []


def _with_latitude(
    project: Project, plan: Penetration, stations: Mapping[str, Station]
) -> Penetration:
    """Latitude of the deflections from the grid where the project states none."""
    if plan.deflection is None or math.isfinite(plan.deflection.latitude):
        return plan
    from surveyapp.core.geodesy import grid_of

    try:
        grid = grid_of(project)
        if grid is None:
            return plan
        latitude, _ = grid.geographic(e=plan.meeting.e, n=plan.meeting.n)
    except SurveyError:
        return plan
    return replace(plan, deflection=replace(plan.deflection, latitude=latitude))
