"""``[[shaft]]`` of project.toml: kind, depth, wires, sigmas, checks, and the book they name."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Final, Literal, cast

from surveyapp.domain.shaft import CHECK_IDS, PlumbingCheck, Shaft, ShaftRowKind, ShaftTables
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.files import decode
from surveyapp.io.findings import Findings, told_once
from surveyapp.io.project_files import ProjectFiles, inside
from surveyapp.io.shafts.book import parse_shaft_book
from surveyapp.io.tables import Table
from surveyapp.languages import either, said
from surveyapp_models.angles import ARCSEC, AngleUnit

MM: Final = 1e-3


def read_shaft_tables(top: Table, files: ProjectFiles, unit: AngleUnit) -> ShaftTables | None:
    """Every ``[[shaft]]`` of a project.toml with its book and its problems; None without any.

    A book that does not exist or lies outside of the folder is a problem of the project itself.
    """
    raw = top.get("shaft")
    if raw is None:
        return None
    findings = Findings()
    if not isinstance(raw, list) or not all(isinstance(item, Mapping) for item in raw):
        where = "project.toml"
        findings.problems.append(Problem("shaft is no list of tables", where, "", "[[shaft]]"))
        raw = []
    shafts = []
    for number, item in enumerate(raw, start=1):
        table = Table(item, f"project.toml, [[shaft]] {item.get('id', number)}", findings)
        shaft = read_shaft(table)
        name = item.get("book")
        if isinstance(name, str) and name:
            outer = Table(item, table.where, files.findings)
            shaft = _with_book(shaft, name, (outer, files, unit), findings)
        shafts.append(shaft)
    names = [shaft.id for shaft in shafts]
    findings.problems += [
        Problem("two shafts have one id", "project.toml", name, "unique ids")
        for name in dict.fromkeys(names)
        if name and names.count(name) > 1
    ]
    return ShaftTables(tuple(shafts), tuple(told_once(findings.problems)), findings.told())


def read_shaft(table: Table) -> Shaft:
    """One ``[[shaft]]`` without its book; what is wrong is noted."""
    wires = table.get("wires")
    named = [w for w in wires if isinstance(w, str) and w] if isinstance(wires, list) else []
    if len(named) != 2 or len(set(named)) != 2:
        table.problem("wires are not two names", wires, 'wires = ["A", "B"]')
        named = ["A", "B"]
    angle = table.number("sigma_angle_arcsec", low=0.0, high=3.6e5)
    distance = table.table("sigma_distance")
    mm = ppm = None
    if distance is not None:
        mm = distance.number("mm", low=0.0, high=1e5) or 0.0
        ppm = distance.number("ppm", low=0.0, high=1e5) or 0.0
        distance.warn_unknown()
    plumb = table.number("sigma_plumb_mm", low=0.0, high=1e4, required=True)
    kind = table.choice("kind", ("one", "two"), required=True)
    radius = table.number("radius_m", low=6.0e6, high=7.0e6)
    shaft = Shaft(
        id=table.text("id", required=True) or "",
        kind=cast("Literal['one', 'two']", kind or "one"),
        depth_m=table.number("depth_m", high=12000.0, positive=True, required=True) or 1.0,
        wires=(named[0], named[1]),
        orient=_orient(table),
        sigma_plumb_m=(plumb or 0.0) * MM,
        sigma_angle=None if angle is None else angle * ARCSEC,
        sigma_mm=mm,
        sigma_ppm=ppm,
        radius_m=6_371_000.0 if radius is None else radius,
        checks=tuple(_check(item) for item in table.tables("check")),
    )
    table.text("book", required=True)
    table.get("note")
    table.warn_unknown()
    return shaft


def _orient(table: Table) -> tuple[str, str]:
    inner = table.table("orient")
    if inner is None:
        if "orient" not in table:
            table.problem("orient is missing", "", 'orient = { at = "...", to = "..." }')
        return "", ""
    at, to = (inner.text(key, required=True) or "" for key in ("at", "to"))
    inner.warn_unknown()
    if at and at == to:
        table.problem("the oriented side has one end", at, "two points")
    return at, to


def _check(table: Table) -> PlumbingCheck:
    done = table.get("done_at")
    text = done if isinstance(done, str) else "" if done is None else str(done)
    check = PlumbingCheck(
        table.choice("id", CHECK_IDS, required=True) or "",
        text,
        table.text("by") or "",
        table.text("note", multiline=True) or "",
    )
    table.warn_unknown()
    return check


def _with_book(
    shaft: Shaft, name: str, source: tuple[Table, ProjectFiles, AngleUnit], findings: Findings
) -> Shaft:
    """A shaft with the rows of its book."""
    table, files, unit = source
    data = files.read(name, table.where) if inside(name, table) else None
    if data is None:
        return shaft
    try:
        text = decode(data, where=name)
    except SurveyError as error:
        findings.absorb(error)
        return shaft
    rows, problems = parse_shaft_book(text, angle_unit=unit, where=name)
    findings.problems += problems
    shaft = replace(shaft, rows=tuple(rows))
    findings.problems += _row_problems(shaft, name)
    return shaft


def _row_problems(shaft: Shaft, book: str) -> list[Problem]:
    """What the rows of a book lack for their shaft."""
    problems = []
    for row in shaft.rows:
        where = said("{book}, line {line}", book=book, line=row.line)
        if row.kind is ShaftRowKind.SWING and row.at not in shaft.wires:
            found, expected = row.at, either(shaft.wires)
            problems.append(Problem("a swing of something that is no wire", where, found, expected))
        silent = row.sigma is None and (
            (row.kind is ShaftRowKind.ANGLE and shaft.sigma_angle is None)
            or (row.kind is ShaftRowKind.DISTANCE and shaft.sigma_mm is None)
        )
        if silent:
            expected = "sigma in the row, or sigma_angle_arcsec / sigma_distance in [[shaft]]"
            problems.append(
                Problem("an observation without a standard deviation", where, "nothing", expected)
            )
    below = {
        name
        for row in shaft.rows
        if row.place == "underground"
        for name in (row.at, row.back, row.to)
    }
    problems += [
        Problem(
            "a point that no underground row names",
            f"project.toml, [[shaft]] {shaft.id}",
            name,
            "a point of the underground rows",
        )
        for name in (*shaft.orient, *shaft.wires)
        if name and shaft.rows and name not in below
    ]
    return problems
