"""The traverses of a project: ``[[traverse]]`` tables with the rows of their books.

An unknown point or an impossible value is told when the folder is read. Whether every row has a
standard deviation is asked when a network is made of it: a prediction has its own.
"""

from __future__ import annotations

import unicodedata
from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import replace

from surveyapp.domain.traverse_book import Traverse, TraverseRow
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.io.files import decode
from surveyapp.io.findings import Findings
from surveyapp.io.project_files import PROJECT_FILE, ProjectFiles, inside
from surveyapp.io.tables import Table
from surveyapp.io.traverse.rows import parse_traverse
from surveyapp.languages import said
from surveyapp_models.angles import ARCSEC, AngleUnit

MM = 1e-3


def read_traverses(
    tables: Sequence[Table], files: ProjectFiles, stations: Sequence[str], unit: AngleUnit
) -> tuple[Traverse, ...]:
    """Every [[traverse]] with its book; problems are noted in the findings.

    Parameters
    ----------
    tables : sequence of Table
    files : ProjectFiles
    stations : sequence of str
        What rows may name.
    unit : AngleUnit
        Of angles whose row names none.
    """
    own = replace(files, findings=Findings()) if files.observing else files
    found = tuple(
        _read_traverse(table, number, own, (stations, unit))
        for number, table in enumerate(tables, start=1)
    )
    for name in sorted(n for n, count in Counter(t.name for t in found).items() if count > 1):
        own.findings.problems.append(
            Problem("two traverses have one name", PROJECT_FILE, name, "unique names")
        )
    if own is files:
        return found
    files.findings.warnings += own.findings.told()
    files.findings.warnings += [
        ResultWarning("traverse_unusable", str(problem)) for problem in own.findings.problems
    ]
    return () if own.findings.problems else found


def _read_traverse(
    table: Table,
    number: int,
    files: ProjectFiles,
    known: tuple[Sequence[str], AngleUnit],
) -> Traverse:
    table = Table(table.data, f"{PROJECT_FILE}, [[traverse]] number {number}", files.findings)
    traverse = _header(table, number)
    stations, unit = known
    if not traverse.book or not inside(traverse.book, table):
        return traverse
    data = files.read(traverse.book, table.where)
    if data is None:
        return traverse
    try:
        text = decode(data, where=traverse.book)
    except SurveyError as error:
        files.findings.absorb(error)
        return traverse
    rows, problems = parse_traverse(text, angle_unit=unit, where=traverse.book)
    rows = _respelled(rows, stations)
    problems += _unknown_points(rows, traverse, stations)
    traverse = replace(traverse, rows=tuple(rows))
    files.findings.problems += problems
    if not rows and not problems:
        text = said(
            "{book}: the book of {where} has no observation yet",
            book=traverse.book,
            where=table.where,
        )
        files.findings.warnings.append(ResultWarning("empty_book", text, traverse.subject))
    return traverse


def _heights(table: Table) -> tuple[float, float]:
    """``sigma_height_mm = { instrument, target }`` [m]."""
    inner = table.table("sigma_height_mm")
    if inner is None:
        return 0.0, 0.0
    values = [(inner.number(key, low=0.0) or 0.0) * MM for key in ("instrument", "target")]
    inner.warn_unknown()
    return values[0], values[1]


DOF_KEYS = ("angle", "zenith", "distance", "circles")
_MOST_DOF = 1e7


def _sigma_dof(table: Table) -> tuple[tuple[str, float], ...]:
    """``sigma_dof = { angle, zenith, distance, circles }``: of sigmas that were estimated."""
    inner = table.table("sigma_dof")
    if inner is None:
        return ()
    found = [(key, inner.number(key, low=1.0, high=_MOST_DOF)) for key in DOF_KEYS]
    inner.warn_unknown()
    return tuple((key, dof) for key, dof in found if dof is not None)


def _header(table: Table, number: int) -> Traverse:
    name = table.text("name", required=True) or said("number {number}", number=number)
    table.where = f"{PROJECT_FILE}, [[traverse]] {name}"
    book = table.text("book", required=True) or ""
    angle = table.number("sigma_angle_arcsec", positive=True)
    zenith = table.number("sigma_zenith_arcsec", positive=True)
    distance = table.table("sigma_distance")
    centring = table.table("centring_mm")
    traverse = Traverse(
        name,
        book,
        table.text("class") or "",
        None if angle is None else angle * ARCSEC,
        None if distance is None else distance.number("mm", low=0.0) or 0.0,
        None if distance is None else distance.number("ppm", low=0.0) or 0.0,
        0.0 if centring is None else (centring.number("instrument", low=0.0) or 0.0) * MM,
        0.0 if centring is None else (centring.number("target", low=0.0) or 0.0) * MM,
        table.boolean("atmosphere_applied") if "atmosphere_applied" in table else None,
        table.boolean("constant_applied") if "constant_applied" in table else None,
        _heights(table),
        sigma_zenith=None if zenith is None else zenith * ARCSEC,
        sigma_dof=_sigma_dof(table),
        centring_assumed=table.boolean("centring_assumed"),
    )
    for part in (distance, centring):
        if part is not None:
            part.warn_unknown()
    table.get("note")
    table.warn_unknown("effect")
    return traverse


def _respelled(rows: Sequence[TraverseRow], stations: Sequence[str]) -> list[TraverseRow]:
    """Names as the stations spell them: composed and decomposed letters are the same (NFC)."""
    if all((row.at + row.back + row.to).isascii() for row in rows):
        return list(rows)
    declared = {unicodedata.normalize("NFC", name): name for name in stations}

    def spelled(name: str) -> str:
        return name if name in stations else declared.get(unicodedata.normalize("NFC", name), name)

    return [
        replace(row, at=spelled(row.at), back=spelled(row.back), to=spelled(row.to)) for row in rows
    ]


def _unknown_points(
    rows: Sequence[TraverseRow], traverse: Traverse, known: Collection[str]
) -> list[Problem]:
    told: dict[str, Problem] = {}
    for row in rows:
        for name in (row.at, row.back, row.to):
            if name and name not in known and name not in told:
                told[name] = Problem(
                    "a point that is no station",
                    said("{book}, line {line}", book=traverse.book, line=row.line),
                    name,
                    "a name of a [[station]]",
                    nearest_names(name, known),
                )
    return list(told.values())
