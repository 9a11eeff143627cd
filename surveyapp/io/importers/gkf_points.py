"""Points of a .gkf file: statuses, axes, and coordinates that nothing observes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from surveyapp.core.network.touched import touched
from surveyapp.domain.observations import CorrelatedBlock, Observation
from surveyapp.domain.traverse import NetworkPoint, Status
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import SurveyError, nearest_names
from surveyapp.io.importers.gkf_document import GkfDocument, PointEntry
from surveyapp.languages import joined, said, some


def _status(entry: PointEntry, letters: str) -> Status:
    if any(letter in entry.fix.lower() for letter in letters):
        return Status.FIXED
    if any(letter.upper() in entry.adj for letter in letters):
        return Status.CONSTRAINED
    return Status.FREE if any(letter in entry.adj for letter in letters) else Status.UNUSED


def network_point(document: GkfDocument, entry: PointEntry) -> NetworkPoint | None:
    """Point of the network; what it refuses becomes problems of the document."""
    plane: dict[str, float | None] = {"e": None, "n": None}
    for axis, value in enumerate((entry.x, entry.y)):
        component, sign = document.axes.component(axis)
        plane[component] = None if value is None else sign * value
    status = _status(entry, "xy")
    try:
        return NetworkPoint(
            entry.name, plane["e"], plane["n"], entry.z, status, status, _status(entry, "z")
        )
    except SurveyError as refused:
        for item in refused.problems:
            document.problem(
                item.what,
                entry.line,
                joined(": ", (item.where, item.found)),
                expected=item.expected,
                hint=item.hint,
            )
        return None


def declared_only(
    document: GkfDocument, observations: Sequence[Observation], blocks: Sequence[CorrelatedBlock]
) -> tuple[list[Observation], list[CorrelatedBlock], list[ResultWarning]]:
    """Leave out observations that touch a point which the file does not declare, and tell it."""
    known = document.points
    lost: dict[str, list[int]] = {}
    keep = []
    for place, obs in enumerate(observations):
        missing = [name for name in (obs.at, obs.back, obs.to) if name and name not in known]
        for name in missing:
            lost.setdefault(name, []).append(obs.line)
        if not missing:
            keep.append(place)
    if not lost:
        return list(observations), list(blocks), []
    moved = {old: new for new, old in enumerate(keep)}
    kept_blocks = []
    for block in blocks:
        left = [i for i, member in enumerate(block.members) if member in moved]
        if left:
            members = tuple(moved[block.members[i]] for i in left)
            rows = tuple(tuple(block.covariance[i][j] for j in left) for i in left)
            kept_blocks.append(CorrelatedBlock(members, rows))
    if not keep:
        for name, lines in lost.items():
            hint = nearest_names(name, known)
            document.problem(
                "Unknown point", lines[0], name, expected="a point of the file", hint=hint
            )
    named = [said("{name} (line {line})", name=name, line=lines[0]) for name, lines in lost.items()]
    text = said(
        "{value} observations to points that the file does not declare were left out: {names}",
        value=len(observations) - len(keep),
        names=some(named, 6),
    )
    warning = ResultWarning("undeclared_points", text)
    return [observations[i] for i in keep], kept_blocks, [warning]


def without_idle(
    points: list[NetworkPoint], observations: list[Observation]
) -> tuple[list[NetworkPoint], list[ResultWarning]]:
    """Take coordinates that nothing observes out of the network, as the format's own program."""
    observed = touched(observations)
    adjusted = (Status.FREE, Status.CONSTRAINED)
    result, idle = [], []
    for point in points:
        parts = observed.get(point.name, set())
        if point.status_e in adjusted and "p" not in parts:
            point = replace(point, status_e=Status.UNUSED, status_n=Status.UNUSED)
            idle.append(f"{point.name} (xy)")
        if point.status_h in adjusted and "h" not in parts:
            point = replace(point, status_h=Status.UNUSED)
            idle.append(f"{point.name} (z)")
        result.append(point)
    if not idle:
        return result, []
    text = said("To be adjusted but not observed, left out: {names}", names=", ".join(idle))
    return result, [ResultWarning("points_not_observed", text)]
