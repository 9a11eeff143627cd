"""The oriented lines: every correction on its own line with its origin, and the budget."""

from __future__ import annotations

from collections.abc import Sequence

from surveyapp.domain.project import Project
from surveyapp.domain.results import AngleResult, CombinedResult, LineResult, OrientationResult
from surveyapp.languages import counted, joined, said, said_each, term
from surveyapp.report.blocks import Block, Heading, Paragraph, Table
from surveyapp.report.numbers import (
    NOTHING,
    direction,
    line_name,
    plain,
    seconds,
    signed_angle,
    with_sigma,
)
from surveyapp.report.sections.improvement import most_helps
from surveyapp_models.angles import AngleUnit

STEPS = said_each("step", "value", '±"', '95 % ±"', "where it comes from")
"""Columns of every table of steps."""


def blocks(project: Project, result: OrientationResult) -> tuple[Block, ...]:
    """Summary of all lines, then each line with its steps and its budget."""
    found: list[Block] = [Heading(said("Azimuths"))]
    if not result.lines:
        text = said("No line was oriented: no survey session has sights of a target.")
        return (Heading(said("Azimuths")), Paragraph(text))
    found.append(summary(project, result))
    for line in result.lines:
        found += line_blocks(project, line)
    return (*found, *_combined(project, result.combined))


def _combined(project: Project, sides: Sequence[CombinedResult]) -> tuple[Block, ...]:
    """Sides with several lines: their mean by variances, or that they disagree."""
    rows = []
    for side in sides:
        test = f"{plain(side.chi_square, 2)} ({side.dof})"
        verdict = said("agree") if side.agree else said("disagree, not combined")
        lines = joined("; ", [joined(" ", (of.name, _share(of.weight))) for of in side.lines])
        name = line_name(side.station, side.target)
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


SUMMARY = said_each("line", "instrument", "rounds", "azimuth", "value", '±"', '95 % ±"')
"""Columns of ``summary``."""


def summary(project: Project, result: OrientationResult) -> Table:
    """Each oriented line in one row, with the last azimuth that it reaches."""
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
        name, value = line_name(line.station, line.target), with_sigma(final, project.angle_unit)
        rows.append((name, line.instrument, str(line.rounds), kind, *value))
    return Table(SUMMARY, tuple(rows), "llrlrrr", strong=frozenset(range(len(rows))))


def line_blocks(project: Project, line: LineResult) -> tuple[Block, ...]:
    """One line: every step from the gyro azimuth on, the budget, and what would help most."""
    rows, strong = _steps(project, line, project.angle_unit)
    name = line_name(line.station, line.target)
    return (
        Heading(said("Line {name}", name=name), 2),
        Table(STEPS, tuple(rows), "lrrrl", strong=strong),
        *_budget(line),
    )


def _budget(line: LineResult) -> tuple[Block, ...]:
    """The parts of the sigma, those that are zero in one sentence, and the part that matters."""
    if not line.budget:
        return ()
    rows = tuple(
        (term(item.source), seconds(item.sigma), plain(100.0 * item.share, 1))
        for item in line.budget
        if item.sigma > 0.0
    )
    head = said_each("source of error", '±"', "share of variance %")
    zero = [term(item.source) for item in line.budget if item.sigma == 0.0]
    found: list[Block] = [Table(head, rows, "lrr")] if rows else []
    if zero:
        found.append(Paragraph(said("Zero: {sources}.", sources=joined(", ", zero)), "small"))
    if helps := most_helps(line):
        found.append(Paragraph(helps))
    return tuple(found)


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
        counted(
            "{count} round: {sessions}",
            "{count} rounds: {sessions}",
            count=line.rounds,
            sessions=sessions,
        ),
    )
    choice = line.constant_choice or ""
    origin = said("no constant of this instrument is known")
    if choice:
        origin = joined(", ", (line.instrument, term(choice)))
    small(said("+ instrument constant"), line.constant, line.constant_sigma, origin)
    if line.if_drifting is not None:
        half = seconds(line.if_drifting)
        rows.append((said("its interval if it drifts"), "", "", half, said("far in time: 95 %")))
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
