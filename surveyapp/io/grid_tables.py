"""The grid of project.toml: the mine's own grid, and convergences that a record prints."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Final

from surveyapp.domain.mine_grid import MineGrid, StatedConvergence
from surveyapp.domain.project import (
    DEFLECTION_LENGTH_M,
    Deflection,
    OrientationSession,
    Station,
)
from surveyapp.errors import Problem
from surveyapp.io.findings import Findings
from surveyapp.io.tables import Table
from surveyapp.languages import said
from surveyapp_models.angles import ARCSEC, RHO_ARCSEC, AngleUnit, wrap_pi

_LIMIT_M: Final = 1e8
_LAST_DIGIT: Final = {AngleUnit.GON: 3240.0, AngleUnit.DEG: 3600.0}
"""Arc-seconds of one unit where an angle is a plain number."""
SAME: Final = 0.005 * ARCSEC
"""Two statements of one convergence that differ by less are one."""


def read_mine_grid(top: Table, unit: AngleUnit, crs: str | None) -> MineGrid | None:
    """``grid = { base, rotation, origin, scale, rotation_sigma_arcsec }``, None where absent."""
    table = top.table("grid")
    if table is None:
        return None
    base = table.text("base", multiline=True)
    if crs is not None and base is not None and crs != base:
        found = f"crs = {crs[:80]}, base = {base[:80]}"
        table.problem("the grid is named twice and differently", found, "crs or grid.base")
    rotation = table.angle("rotation", unit)
    if rotation is None and "rotation" not in table:
        table.problem("rotation is missing", "", 'rotation = "12-00-00"')
    scale = table.number("scale", low=0.5, high=2.0)
    sigma = table.number("rotation_sigma_arcsec", low=0.0, high=36000.0)
    origin = _origin(table, based=base is not None or crs is not None)
    table.warn_unknown()
    return MineGrid(
        rotation=wrap_pi(rotation or 0.0),
        base=base if base is not None else crs,
        scale=1.0 if scale is None else scale,
        rotation_sigma=(sigma or 0.0) * ARCSEC,
        e=origin.get("e", 0.0),
        n=origin.get("n", 0.0),
        base_e=origin.get("base_e"),
        base_n=origin.get("base_n"),
        latitude=None if "lat" not in origin else math.radians(origin["lat"]),
        longitude=None if "lon" not in origin else math.radians(origin["lon"]),
    )


def _origin(grid: Table, *, based: bool) -> dict[str, float]:
    """What is given of the origin; it must tell where the mine's grid lies."""
    table = grid.table("origin")
    wanted = "e, n, base_e, base_n" if based else "e, n, lat, lon"
    if table is None:
        if "origin" not in grid:
            grid.problem(
                "rotation stands without origin", "", said("origin = {{ {wanted} }}", wanted=wanted)
            )
        return {}
    found: dict[str, float] = {}
    pairs = ((("e", "n"), _LIMIT_M), (("base_e", "base_n"), _LIMIT_M), (("lat", "lon"), 180.0))
    for keys, limit in pairs:
        for key in keys:
            value = table.number(key, low=-limit, high=90.0 if key == "lat" else limit)
            if value is not None:
                found[key] = value
        if (keys[0] in table) != (keys[1] in table):
            table.problem(
                said("{keys} and {keys2} belong together", keys=keys[0], keys2=keys[1]),
                "",
                "both or none",
            )
    if abs(found.get("lat", 0.0)) > 90.0:
        table.problem("lat is out of range", found["lat"], "-90 to 90")
    if "base_e" in table and "lat" in table:
        table.problem("the origin is given twice", "base_e/base_n and lat/lon", "one of them")
    if "base_e" in table and not based:
        table.problem("base_e and base_n stand without base", "", 'base = "EPSG:..."')
    elif not {"base_e", "lat"} & set(table.data):
        table.problem(
            "the origin does not tell where it lies",
            "",
            said("origin = {{ {wanted} }}", wanted=wanted),
        )
    table.warn_unknown()
    return found


def with_regional_deflection(
    top: Table, stations: Sequence[Station]
) -> tuple[list[Station], float]:
    """``deflection = { sigma_arcsec, correlation_km }`` of the region.

    Returns
    -------
    stations, length
        Stations without a deflection of their own with the regional sigma; correlation length [m].
    """
    table = top.table("deflection")
    if table is None:
        return list(stations), DEFLECTION_LENGTH_M
    sigma = table.number("sigma_arcsec", low=0.0, high=300.0)
    length = table.number("correlation_km", low=0.0, high=2000.0)
    table.warn_unknown()
    found = list(stations)
    if sigma is not None:
        regional = Deflection(sigma=sigma * ARCSEC)
        found = [
            replace(station, deflection=regional) if station.deflection == Deflection() else station
            for station in stations
        ]
    return found, DEFLECTION_LENGTH_M if length is None else length * 1000.0


def read_convergence(table: Table, unit: AngleUnit) -> StatedConvergence | None:
    """``convergence`` with ``convergence_sigma_arcsec`` of a station or session.

    Without a sigma it is known to its last printed digit.
    """
    value = table.angle("convergence", unit)
    sigma = table.number("convergence_sigma_arcsec", low=0.0, high=36000.0)
    if value is None:
        if sigma is not None and "convergence" not in table:
            table.problem("convergence_sigma_arcsec stands without convergence")
        return None
    if sigma is None:
        sigma = last_digit_arcsec(str(table.data["convergence"]), unit) / math.sqrt(12.0)
    return StatedConvergence(wrap_pi(value), sigma * ARCSEC)


def last_digit_arcsec(text: str, unit: AngleUnit) -> float:
    """Size of the last digit of an angle [arc-seconds]."""
    decimals = re.search(r"\.(\d*)\D*$", text)
    digits = len(decimals[1]) if decimals is not None else 0
    return float(_LAST_DIGIT.get(unit, 1.0) * 10.0**-digits)


def refuse_two_convergences(
    stations: Sequence[Station], sessions: Sequence[OrientationSession], findings: Findings
) -> None:
    """A station has one convergence, whoever states it."""
    by_station: dict[str, list[tuple[str, StatedConvergence]]] = {}
    for session in sessions:
        if session.convergence is not None:
            found = (f"session {session.id}", session.convergence)
            by_station.setdefault(session.station, []).append(found)
    for station in stations:
        stated = by_station.get(station.name, [])
        if station.convergence is not None:
            stated.insert(0, (f"station {station.name}", station.convergence))
        if len(stated) < 2:
            continue
        first, value = stated[0]
        for where, other in stated[1:]:
            apart = wrap_pi(other.value - value.value)
            if abs(apart) > SAME:
                findings.problems.append(
                    Problem(
                        said(
                            "the convergence at {name} is stated twice and differently",
                            name=station.name,
                        ),
                        said("project.toml, {first} and {where}", first=first, where=where),
                        said('{value:+.2f}" apart', value=apart * RHO_ARCSEC),
                        "one convergence for each station",
                    )
                )
