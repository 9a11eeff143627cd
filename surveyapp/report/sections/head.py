"""The head of the record: project, instruments, observers, dates, grid, stations."""

from __future__ import annotations

import math

from surveyapp.domain.mine_grid import MineGrid
from surveyapp.domain.project import Project, Station
from surveyapp.domain.results import OrientationResult
from surveyapp.domain.rulebook import RuleBook
from surveyapp.languages import counted, joined, said, said_each, term
from surveyapp.report.blocks import Block, Heading, KeyValues, Paragraph, Table
from surveyapp.report.numbers import NOTHING, plain, seconds
from surveyapp_models.angles import RHO_ARCSEC, AngleUnit, format_angle

_LONGEST_CRS = 160


def blocks(
    project: Project,
    result: OrientationResult,
    rule_book: RuleBook | None,
    signed: tuple[tuple[str, str], ...] = (),
) -> tuple[Block, ...]:
    """Blocks of the head; ``signed`` is what it says of the closing, name and text."""
    facts = [(said("project"), project.name)]
    facts += [(said("instrument"), _instrument(project, item.id)) for item in project.instruments]
    facts += [
        (said("observer"), ", ".join(observers(project)) or NOTHING),
        (said("date of observation"), ", ".join(dates(project)) or NOTHING),
        (said("grid"), _grid(project)),
        (said("unit of angles"), term(str(project.angle_unit))),
        (
            said("rule book"),
            NOTHING
            if rule_book is None
            else joined(" ", (term(rule_book.title), f"({rule_book.id})")),
        ),
        (said("software"), result.software),
        (said("sha256 of the input"), result.input_sha256),
    ]
    met = sum(check.passed is True for check in result.checks)
    warned = sum(c.passed is False and not c.confirmed for c in result.checks)
    broken = sum(c.passed is False and c.confirmed for c in result.checks)
    still = sum(check.passed is None for check in result.checks)
    verdict = said(
        "{met} met, {broken} NOT MET, {warned} beyond a limit that is not confirmed, "
        "{still} open for want of data",
        met=met,
        broken=broken,
        warned=warned,
        still=still,
    )
    facts.append((said("checks"), verdict))
    if result.warnings:
        text = said("{number}, behind the checks", number=len(result.warnings))
        facts.append((said("warnings"), text))
    facts += signed
    answered = any(check.passed is not None and check.confirmed for check in result.checks)
    text = _verdict(broken, still) if answered else _nothing_judged(project)
    facts.insert(1, (said("verdict"), text))
    return (
        KeyValues(tuple(facts)),
        *_stations(project),
        Paragraph(
            said(
                "Azimuths and circle readings are clockwise. A suspended gyro gives the "
                "astronomic azimuth; grid azimuth = gyro azimuth + constant - deflection - "
                "convergence - arc-to-chord. Sigmas are one standard deviation."
            ),
            "small",
        ),
    )


def _verdict(broken: int, still: int) -> str:
    if broken:
        return counted(
            "NOT MET: {count} confirmed check", "NOT MET: {count} confirmed checks", count=broken
        )
    met = said("every confirmed check that could be answered is met")
    return met + said("; {still} open for want of data", still=still) if still else met


def _nothing_judged(project: Project) -> str:
    """No confirmed check was answered: that is no verdict on anything."""
    if project.sensor_logs and not project.sessions:
        return said("no azimuth is observed here; what each sensor log is good for stands below")
    return said("no confirmed check could be answered")


def observers(project: Project) -> list[str]:
    """Observers of all sessions, each once, in order."""
    return list(dict.fromkeys(s.observer for s in project.sessions if s.observer))


def dates(project: Project) -> list[str]:
    """Days of all sessions, each once, in order: the stated date, else the first time."""
    days = []
    for session in project.sessions:
        times = [row.time for row in session.book.rows if row.time is not None]
        if session.date is not None:
            days.append(session.date.isoformat())
        elif times:
            days.append(times[0].date().isoformat())
    return sorted(set(days))


def _instrument(project: Project, identity: str) -> str:
    item = project.instrument(identity)
    serial = said(", no. {serial}", serial=item.serial) if item.serial else ""
    return said(
        "{identity}: {title}{serial} (card {id}, {kind})",
        identity=identity,
        title=item.card.title,
        serial=serial,
        id=item.card.id,
        kind=term(item.card.kind),
    )


def _mine_grid(grid: MineGrid) -> str:
    """The mine's own grid in one line."""
    base = said("true north at the origin") if grid.base is None else " ".join(grid.base.split())
    turned = format_angle(grid.rotation % (2.0 * math.pi), AngleUnit.DMS, 1)
    text = said(
        "mine grid, north bears {turned} against {base}", turned=turned, base=base[:_LONGEST_CRS]
    )
    if grid.rotation_sigma > 0.0:
        text += f' +-{grid.rotation_sigma * RHO_ARCSEC:.1f}"'
    if grid.scale != 1.0:
        text += said(", scale {scale:.8f}", scale=grid.scale)
    return said("{text}; origin {e:.3f} {n:.3f}", text=text, e=grid.e, n=grid.n)


def _grid(project: Project) -> str:
    if project.grid is not None:
        return _mine_grid(project.grid)
    if project.crs is None:
        return said("none: no convergence and no grid azimuth")
    text = " ".join(project.crs.split())
    return text if len(text) <= _LONGEST_CRS else text[:_LONGEST_CRS] + "..."


def _stations(project: Project) -> tuple[Block, ...]:
    if not project.stations:
        return ()
    rows = tuple(_station(station) for station in project.stations)
    columns = said_each(
        "station", "E m", "N m", "lat deg", "lon deg", "h m", "fixed", 'xi "', 'eta "', '±"'
    )
    used = [
        index
        for index in range(len(columns))
        if index == 0 or any(row[index] not in (NOTHING, "") for row in rows)
    ]
    return (
        Heading(said("Stations"), 2),
        Table(
            tuple(columns[i] for i in used),
            tuple(tuple(row[i] for i in used) for row in rows),
            "".join("lrrrrrcrrr"[i] for i in used),
        ),
    )


def _station(station: Station) -> tuple[str, ...]:
    def degrees(angle: float | None) -> str:
        return NOTHING if angle is None else plain(math.degrees(angle), 7)

    deflection = station.deflection
    known = deflection.known
    return (
        station.name,
        plain(station.e, 3),
        plain(station.n, 3),
        degrees(station.latitude),
        degrees(station.longitude),
        plain(station.h, 3),
        said("yes") if station.fixed else "",
        seconds(deflection.xi) if known else NOTHING,
        seconds(deflection.eta) if known else NOTHING,
        seconds(deflection.sigma, 1),
    )
