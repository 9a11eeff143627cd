"""The oriented lines: every correction on its own line with its origin, and the budget."""

from __future__ import annotations

from collections.abc import Sequence

from surveyapp.domain.project import Project
from surveyapp.domain.results import (
    AngleResult,
    CombinedResult,
    LineResult,
    OrientationResult,
    to_degrees,
)
from surveyapp.languages import joined, said, said_each
from surveyapp.report.blocks import Block, Heading, Paragraph, Table
from surveyapp.report.numbers import (
    NOTHING,
    direction,
    plain,
    seconds,
    signed_angle,
    with_sigma,
)
from surveyapp_models.angles import AngleUnit


def blocks(project: Project, result: OrientationResult) -> tuple[Block, ...]:
    """Summary of all lines, then each line with its steps and its budget."""
    found: list[Block] = [Heading(said("Azimuths"))]
    if not result.lines:
        text = said("No line was oriented: no survey session has sights of a target.")
        return (Heading(said("Azimuths")), Paragraph(text), *_norths(project, result))
    found.append(_summary(project, result))
    for line in result.lines:
        found += _line(project, line)
    return (*found, *_combined(project, result.combined))


def _combined(project: Project, sides: Sequence[CombinedResult]) -> tuple[Block, ...]:
    """Sides with several lines: their mean by variances, or that they disagree."""
    rows = []
    for side in sides:
        test = f"{plain(side.chi_square, 2)} ({side.dof})"
        verdict = said("agree") if side.agree else said("disagree, not combined")
        lines = joined("; ", [joined(" ", (of.name, _share(of.weight))) for of in side.lines])
        name = f"{side.station} - {side.target}"
        value = with_sigma(side.grid_azimuth, project.angle_unit)
        rows.append((name, *value, test, verdict, lines))
    if not rows:
        return ()
    head = said_each(
        "side", "grid azimuth", '±"', '95 % ±"', "chi-square (dof)", "lines", "weights %"
    )
    return (
        Heading(said("Lines of one side, combined by their variances"), 2),
        Table(head, tuple(rows), "lrrrrll"),
    )


def _share(weight: float | None) -> str:
    return said("no sigma") if weight is None else plain(100.0 * weight, 1)


def _norths(project: Project, result: OrientationResult) -> tuple[Block, ...]:
    rows = [
        (session.id, session.station, *with_sigma(session.gyro_north, project.angle_unit))
        for session in result.sessions
        if session.gyro_north is not None
    ]
    if not rows:
        return ()
    head = said_each("session", "station", "gyro north on the circle", '±"', '95 % ±"')
    return (Table(head, tuple(rows), "llrrr"),)


def _summary(project: Project, result: OrientationResult) -> Table:
    unit = project.angle_unit
    rows = []
    for line in result.lines:
        final = line.grid_azimuth or line.true_azimuth or line.gyro_azimuth
        kind = (
            said("grid")
            if line.grid_azimuth
            else said("astronomic")
            if line.true_azimuth
            else said("gyro")
        )
        rows.append(
            (
                f"{line.station} - {line.target}",
                line.instrument,
                str(line.rounds),
                kind,
                *with_sigma(final, unit),
                plain(to_degrees(final.value), 6),
            )
        )
    head = said_each("line", "instrument", "rounds", "azimuth", "value", '±"', '95 % ±"', "degrees")
    return Table(head, tuple(rows), "llrlrrrr", strong=frozenset(range(len(rows))))


def _line(project: Project, line: LineResult) -> list[Block]:
    unit = project.angle_unit
    rows, strong = _steps(project, line, unit)
    head = said_each("step", "value", '±"', '95 % ±"', "where it comes from")
    found: list[Block] = [
        Heading(said("Line {station} - {target}", station=line.station, target=line.target), 2),
        Table(head, tuple(rows), "lrrrl", strong=strong),
    ]
    if line.budget:
        budget = [
            (item.source, seconds(item.sigma), plain(100.0 * item.share, 1)) for item in line.budget
        ]
        found.append(
            Table(said_each("source of error", '±"', "share of variance %"), tuple(budget), "lrr")
        )
    return found


def _steps(
    project: Project, line: LineResult, unit: AngleUnit
) -> tuple[list[tuple[str, ...]], frozenset[int]]:
    rows: list[tuple[str, ...]] = []
    strong: set[int] = set()

    def result(label: str, item: AngleResult | None, origin: str) -> None:
        if item is not None:
            rows.append((label, *with_sigma(item, unit), origin))

    def small(label: str, value: float | None, sigma: float | None, origin: str) -> None:
        shown = signed_angle(value) if value is not None else said("not known")
        rows.append((label, shown, seconds(sigma), "", origin))

    sessions = ", ".join(line.sessions)
    result(
        said("gyro azimuth"),
        line.gyro_azimuth,
        said("{rounds} rounds: {sessions}", rounds=line.rounds, sessions=sessions),
    )
    choice = line.constant_choice or ""
    origin = said("no constant of this instrument is known")
    if choice:
        origin = joined(", ", (line.instrument, choice))
    small(said("+ instrument constant"), line.constant, line.constant_sigma, origin)
    if line.true_azimuth is not None:
        strong.add(len(rows))
    result(said("= true azimuth (astronomic)"), line.true_azimuth, "")
    small(said("- deflection of the vertical"), line.deflection, None, _deflection(project, line))
    known = project.crs or project.grid
    where = said("{station} in the grid", station=line.station) if known else said("as stated")
    small(said("- meridian convergence"), line.convergence, None, where)
    whole = line.arc_to_chord is not None
    ends = said("both ends in the grid") if whole else said("a position is missing")
    small(said("- arc-to-chord"), line.arc_to_chord, None, ends)
    if line.grid_azimuth is not None:
        strong.add(len(rows))
    result(said("= grid azimuth"), line.grid_azimuth, said("from grid north, clockwise"))
    if line.direction_from_south is not None:
        text = direction(line.direction_from_south, unit)
        rows.append(
            (said("direction from south"), text, "", "", said("the axes of the grid ask for it"))
        )
    if line.existing_azimuth is not None:
        text = direction(line.existing_azimuth, unit)
        rows.append((said("azimuth from coordinates"), text, "", "", said("for comparison only")))
    if line.distance_m is not None:
        rows.append((said("length of the line m"), plain(line.distance_m, 3), "", "", said("grid")))
    return [row if any(row) else (NOTHING,) * 5 for row in rows], frozenset(strong)


def _deflection(project: Project, line: LineResult) -> str:
    """Where the deflection comes from."""
    if project.station(line.station).deflection.known:
        return said("of the station")
    return said("not known, 0 assumed with its sigma")
