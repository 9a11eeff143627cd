"""Points of a field file as stations of a project: added, the same, or in conflict.

A station of the project is never changed; ``fixed`` is set only where the surveyor says so.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Final

from surveyapp.domain.fieldfile import ImportedStation, KnownPoint, State
from surveyapp.domain.project import Project, Station
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.languages import said

SAME_M: Final = 1e-3
"""Coordinates that agree within a millimetre are the same (formats.md)."""
_LONGEST: Final = 200
_LOST_FRONT_M: Final = 100_000.0


def _table(point: KnownPoint, *, fixed: bool) -> dict[str, object]:
    table: dict[str, object] = {"name": point.name}
    for key, value in (("e", point.e), ("n", point.n), ("h", point.h)):
        if value is not None:
            table[key] = round(value, 6)
    if fixed:
        table["fixed"] = True
    return table


def _gap(station: Station, point: KnownPoint) -> float:
    """Largest difference of a coordinate that both have [m]."""
    pairs = ((station.e, point.e), (station.n, point.n), (station.h, point.h))
    return max((abs(a - b) for a, b in pairs if a is not None and b is not None), default=0.0)


def _conflict(station: Station, point: KnownPoint) -> ResultWarning:
    gap = _gap(station, point)
    text = said(
        "{name}: the file (line {line}) lies {gap:.3f} m away; the project's coordinates were kept",
        name=station.name,
        line=point.line,
        gap=gap,
    )
    rest = math.remainder(gap, _LOST_FRONT_M)
    if gap > 0.5 * _LOST_FRONT_M and abs(rest) < 1.0:
        text += said("; GSI-8 cuts coordinates beyond 99,999.999 m: is the front missing?")
    return ResultWarning("station_conflict", text)


def check_names(names: Iterable[str], where: str) -> None:
    """Refuse names that no project can hold."""
    problems = [
        Problem("this is no usable name of a point", where, repr(name)[:60], "printable characters")
        for name in names
        if not name.strip() or not name.isprintable() or len(name) > _LONGEST
    ]
    if problems:
        raise SurveyError(problems)


def _fix_problems(fixed: Sequence[str], project: Project, points: Mapping[str, KnownPoint]) -> None:
    known = {station.name for station in project.stations}
    problems = []
    for name in fixed:
        point = points.get(name)
        if name in known:
            text = "the station is in the project already: say fixed = true there"
            problems.append(Problem(text, "fixed", name, "a station that the file brings"))
        elif point is None or (point.e is None and point.h is None):
            hint = nearest_names(name, [p.name for p in points.values() if p.e is not None])
            problems.append(
                Problem("the file holds no coordinates of this point", "fixed", name, "", hint)
            )
    if problems:
        raise SurveyError(problems)


def match_stations(
    project: Project, names: Sequence[str], points: Mapping[str, KnownPoint], fixed: Sequence[str]
) -> tuple[list[ImportedStation], list[dict[str, object]], list[ResultWarning]]:
    """Compare the points of a file with the stations of a project.

    Parameters
    ----------
    project : Project
    names : sequence of str
        Every point of the readings.
    points : mapping
        Coordinates that the file holds.
    fixed : sequence of str
        New stations that the surveyor declares fixed.

    Returns
    -------
    stations, tables, warnings
        Tables of those to be added.
    """
    _fix_problems(fixed, project, points)
    known = {station.name: station for station in project.stations}
    folded = {name.casefold(): name for name in known}
    stations, tables, warnings = [], [], []
    for name in names:
        point = points.get(name, KnownPoint(name, None, None, None))
        old = known.get(name)
        if old is None:
            tables.append(_table(point, fixed=name in fixed))
            stations.append(ImportedStation(name, point.e, point.n, point.h, "added"))
            near = folded.get(name.casefold())
            if near is not None:
                text = said(
                    "{name} is new, though the project has {near}: is it the same point?",
                    name=name,
                    near=near,
                )
                warnings.append(ResultWarning("similar_name", text))
            continue
        clash = _gap(old, point) > SAME_M
        if clash:
            warnings.append(_conflict(old, point))
        elif (old.e is None and point.e is not None) or (old.h is None and point.h is not None):
            text = said(
                "{name}: the file holds coordinates that the project has not; not taken over",
                name=name,
            )
            warnings.append(ResultWarning("coordinates_not_taken", text))
        state: State = "conflict" if clash else "same"
        stations.append(ImportedStation(name, old.e, old.n, old.h, state))
    return stations, tables, warnings
