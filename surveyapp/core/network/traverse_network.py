"""Traverses of a project as a network: rows, sigmas, centring, stations and oriented lines.

Gives every observation the sigma of its traverse and its centring, and every gyro row the value of
its sessions. It does not adjust anything.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from surveyapp.core.network.setups import as_blocks, setup_blocks
from surveyapp.core.network.stated_sigmas import estimated_part, row_sigma, side_lengths
from surveyapp.core.network.touched import touched
from surveyapp.domain.observations import CorrelatedBlock, Observation, ObservationKind
from surveyapp.domain.project import Project, Station
from surveyapp.domain.station_line import StationLine
from surveyapp.domain.subject import Subject
from surveyapp.domain.traverse import GyroConstant, Network, NetworkPoint, OrientedLine, Status
from surveyapp.domain.traverse_book import Traverse, TraverseRow
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.languages import said

K = ObservationKind
MM: Final = 1e-3
_LENGTHS = frozenset({K.DISTANCE, K.SLOPE_DISTANCE})


def _observation(
    row: TraverseRow, header: Traverse, sigma: float, problems: list[Problem]
) -> Observation | None:
    try:
        return Observation(
            kind=row.kind,
            at=row.at,
            to=row.to,
            value=row.value if row.value is not None else math.nan,
            sigma=sigma,
            back=row.back,
            set=f"{header.name}:{row.set}" if row.set else header.name,
            hi=row.hi,
            ht=row.ht,
            note=row.note,
            line=row.line,
            length_m=row.length_m,
            estimated=estimated_part(row, header),
        )
    except SurveyError as refused:
        problems += [problem.within(header.book) for problem in refused.problems]
        return None


def _oriented(row: TraverseRow, lines: Sequence[OrientedLine]) -> list[tuple[int, Observation]]:
    """Observations of a gyro row: one for every instrument that oriented the line."""
    return [
        (
            place,
            Observation(
                kind=K.GYRO,
                at=row.at,
                to=row.to,
                value=line.gyro_azimuth,
                sigma=line.sigma,
                constant=line.constant,
                convergence=line.convergence,
                note=row.note,
                line=row.line,
            ),
        )
        for place, line in enumerate(lines)
        if line.station == row.at and line.target == row.to
    ]


def book_observations(
    traverse: Traverse, stations: Sequence[Station]
) -> tuple[dict[int, Observation], list[Problem]]:
    """Observations of a traverse's book that need no orientation, by the place of their row.

    Parameters
    ----------
    traverse : Traverse
    stations : sequence of Station
        For the lengths of sides that no row gives.

    Returns
    -------
    observations, problems
        A row without a standard deviation, or with a value that cannot be, is a problem.
    """
    lengths = side_lengths(traverse.rows, {station.name: station for station in stations})
    observations: dict[int, Observation] = {}
    problems: list[Problem] = []
    for place, row in enumerate(traverse.rows):
        if row.kind is K.GYRO:
            continue
        sigma = row_sigma(row, traverse, lengths)
        if sigma is None:
            where = said("{book}, line {line}", book=traverse.book, line=row.line)
            expected = said(
                "a sigma in the row, or sigma_angle_arcsec / sigma_distance in [[traverse]]"
            )
            problems.append(
                Problem("an observation without a standard deviation", where, "nothing", expected)
            )
            continue
        built = _observation(row, traverse, sigma, problems)
        if built is not None:
            observations[place] = built
    return observations, problems


def _collect(
    project: Project,
    traverse: Traverse,
    lines: Sequence[OrientedLine],
    waiting: Collection[tuple[str, str]],
    *,
    done: set[int],
) -> tuple[list[Observation], list[tuple[int, int]], list[CorrelatedBlock], list[Problem]]:
    """Observations, (line, observation) of the gyro sides, blocks of set-ups, problems.

    A gyro side whose session is still being observed is passed over, and one that stands in a row
    before (``done``, which grows): an azimuth is one observation however often it is named.
    """
    known, problems = book_observations(traverse, project.stations)
    lengths = side_lengths(traverse.rows, {station.name: station for station in project.stations})
    known, blocks = setup_blocks(traverse, known, lengths)
    member_of: dict[int, int] = {}
    observations: list[Observation] = []
    gyro: list[tuple[int, int]] = []
    for number, row in enumerate(traverse.rows):
        if row.kind is not K.GYRO:
            if number in known:
                member_of[number] = len(observations)
                observations.append(known[number])
            continue
        found = _oriented(row, lines)
        if not found and (row.at, row.to) not in waiting:
            problems.append(_not_oriented(row, traverse, lines))
        for place, obs in found:
            if place in done:
                continue
            done.add(place)
            gyro.append((place, len(observations)))
            observations.append(obs)
    return observations, gyro, as_blocks(blocks, member_of), problems


def _not_oriented(row: TraverseRow, traverse: Traverse, lines: Sequence[OrientedLine]) -> Problem:
    return Problem(
        "a gyro side that no session has oriented",
        said("{book}, line {line}", book=traverse.book, line=row.line),
        f"{row.at}-{row.to}",
        ", ".join(f"{x.station}-{x.target}" for x in lines) or "an oriented line",
        "Its station and target must be those of survey sessions with a sight.",
    )


def _gyro_blocks(
    gyro: Sequence[tuple[int, int]], lines: Sequence[OrientedLine]
) -> tuple[CorrelatedBlock, ...]:
    """One covariance matrix of the gyro sides, where lines are correlated at all."""
    if not any(lines[place].covariance for place, _ in gyro):
        return ()
    matrix = np.diag([lines[place].sigma ** 2 for place, _ in gyro])
    for i, (place, _) in enumerate(gyro):
        for other, value in lines[place].covariance:
            for j, (partner, _) in enumerate(gyro):
                if partner == other and j != i:
                    matrix[i, j] = matrix[j, i] = value
    members = tuple(member for _, member in gyro)
    return (CorrelatedBlock(members, tuple(tuple(row) for row in matrix.tolist())),)


def _points(
    project: Project, observations: Sequence[Observation]
) -> tuple[list[NetworkPoint], list[ResultWarning]]:
    parts = touched(observations)
    points: list[NetworkPoint] = []
    for station in project.stations:
        if station.name not in parts:
            continue
        fixed_plane = station.fixed and station.has_grid_position
        plane = Status.FIXED if fixed_plane else Status.FREE
        level = Status.FIXED if station.fixed and station.h is not None else Status.FREE
        points.append(
            NetworkPoint(
                station.name,
                station.e,
                station.n,
                station.h,
                plane if "p" in parts[station.name] else Status.UNUSED,
                plane if "p" in parts[station.name] else Status.UNUSED,
                level if "h" in parts[station.name] else Status.UNUSED,
            )
        )
    with_height = [i for i, point in enumerate(points) if point.status_h is not Status.UNUSED]
    if not with_height or any(points[i].status_h is Status.FIXED for i in with_height):
        return points, []
    first = next((i for i in with_height if points[i].h is not None), with_height[0])
    height = points[first].h or 0.0
    points[first] = replace(points[first], h=height, status_h=Status.FIXED)
    text = said(
        "no height is fixed: heights count from {name} = {height:g} m",
        name=points[first].name,
        height=height,
    )
    return points, [
        ResultWarning("heights_relative", text, Subject.of("station", points[first].name))
    ]


def _header_warnings(header: Traverse) -> list[ResultWarning]:
    warnings = []
    subject = Subject.of("traverse", header.name)
    for flag, what in (
        (header.atmosphere_applied, "atmosphere"),
        (header.constant_applied, "constant"),
    ):
        if flag is False:
            text = said(
                "traverse {name}: the {what} correction was not applied by the instrument "
                "and is not applied here: enter corrected distances",
                name=header.name,
                what=what,
            )
            warnings.append(ResultWarning(f"{what}_not_applied", text, subject))
    seen: dict[tuple[str, str, str], tuple[float, float]] = {}
    unlike = {}
    for row in header.rows:
        if row.kind in (K.ZENITH, K.SLOPE_DISTANCE):
            heights = seen.setdefault((row.at, row.to, row.set), (row.hi, row.ht))
            if heights != (row.hi, row.ht):
                unlike[StationLine(row.at, row.to)] = row.line
    if unlike:
        places = ", ".join(
            said("{sight} (line {line})", sight=sight, line=line)
            for sight, line in list(unlike.items())[:6]
        )
        text = said(
            "zenith angle and distance of a sight have other heights hi, ht: {places}",
            places=places,
        )
        warnings.append(ResultWarning("heights_disagree", text, subject))
    return warnings


def network_of(
    project: Project,
    traverse_name: str | None,
    lines: Sequence[OrientedLine] = (),
    constants: Sequence[GyroConstant] = (),
    *,
    waiting: Collection[tuple[str, str]] = (),
) -> Network:
    """Network of one traverse of a project, or of all of them together.

    Parameters
    ----------
    project : Project
    traverse_name : str or None
        None: all traverses.
    lines : sequence of OrientedLine
        What the sessions have oriented; gyro rows take their value from here.
    constants : sequence of GyroConstant
        Constants that the lines share; one that is not given is an unknown of the network.
    waiting : collection of (station, target)
        Sides whose session is still being observed: their gyro rows are left out.

    Returns
    -------
    Network

    Raises
    ------
    SurveyError
        No such traverse, and a gyro side that no session has oriented.
    """
    chosen = [t for t in project.traverses if traverse_name is None or t.name == traverse_name]
    if not chosen:
        raise SurveyError(
            Problem(
                "there is no traverse of this name" if traverse_name else "there is no traverse",
                "project.toml",
                traverse_name or "",
                "the name of a [[traverse]]",
                nearest_names(traverse_name or "", [item.name for item in project.traverses]),
            )
        )
    observations: list[Observation] = []
    gyro: list[tuple[int, int]] = []
    blocks: list[CorrelatedBlock] = []
    problems: list[Problem] = []
    warnings: list[ResultWarning] = []
    done: set[int] = set()
    for header in chosen:
        found, sides, shared_by, faults = _collect(project, header, lines, waiting, done=done)
        blocks += [
            replace(block, members=tuple(m + len(observations) for m in block.members))
            for block in shared_by
        ]
        gyro += [(place, member + len(observations)) for place, member in sides]
        observations += found
        problems += faults
        warnings += _header_warnings(header)
    if problems:
        raise SurveyError(problems)
    points, height_warnings = _points(project, observations)
    shared = {item.name: item for item in constants}
    names = dict.fromkeys(obs.constant for obs in observations if obs.kind is K.GYRO)
    return Network(
        points=tuple(points),
        observations=tuple(observations),
        blocks=(*_gyro_blocks(gyro, lines), *blocks),
        constants=tuple(shared.get(name, GyroConstant(name)) for name in names),
        name=f"{project.name}: {', '.join(header.name for header in chosen)}",
        warnings=(*warnings, *height_warnings),
    )
