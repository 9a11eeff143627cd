"""The ``[[traverse]]`` tables of a project: class, sigmas, centring, corrections applied."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from surveyapp.domain.project import Project
from surveyapp.errors import Problem
from surveyapp.io.tables import Findings, Table
from surveyapp_models.angles import ARCSEC

MM = 1e-3


@dataclass(frozen=True, slots=True)
class TraverseHeader:
    """The ``[[traverse]]`` table.

    Parameters
    ----------
    name, book, traverse_class : str
    sigma_angle : float or None
        One angle [rad].
    sigma_mm, sigma_ppm : float or None
        Of a distance.
    instrument_m, target_m : float
        Centring, each component [m].
    atmosphere_applied, constant_applied : bool or None
        Whether the instrument has corrected the distances; None where nobody says.
    """

    name: str
    book: str
    traverse_class: str = ""
    sigma_angle: float | None = None
    sigma_mm: float | None = None
    sigma_ppm: float | None = None
    instrument_m: float = 0.0
    target_m: float = 0.0
    atmosphere_applied: bool | None = None
    constant_applied: bool | None = None


def _header(data: Mapping[str, object], number: int, findings: Findings) -> TraverseHeader:
    table = Table(data, f"project.toml, [[traverse]] number {number}", findings)
    name = table.text("name", required=True) or f"number {number}"
    table.where = f"project.toml, [[traverse]] {name}"
    book = table.text("book", required=True) or ""
    angle = table.number("sigma_angle_arcsec", positive=True)
    distance = table.table("sigma_distance")
    centring = table.table("centring_mm")
    header = TraverseHeader(
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
    )
    for part in (distance, centring):
        if part is not None:
            part.warn_unknown()
    table.warn_unknown("effect")
    return header


def traverse_headers(project: Project) -> tuple[TraverseHeader, ...]:
    """Headers of all traverses of a project.

    Raises
    ------
    SurveyError
        All problems of the ``[[traverse]]`` tables.
    """
    findings = Findings()
    raw = project.tables.get("traverse", [])
    tables = [item for item in raw if isinstance(item, Mapping)] if isinstance(raw, list) else []
    headers = tuple(_header(item, i, findings) for i, item in enumerate(tables, start=1))
    names = [header.name for header in headers]
    findings.problems += [
        Problem("two traverses have one name", "project.toml", name, "unique names")
        for name in dict.fromkeys(names)
        if names.count(name) > 1
    ]
    findings.raise_if_any()
    return headers
