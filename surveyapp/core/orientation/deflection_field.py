"""Unknown deflections of the vertical as a field: near stations have nearly the same.

The correlation falls as exp(-d / L) with the distance d. A difference of two stations has the
variance 2 sigma^2 (1 - exp(-d / L)): what is common to the known and the unknown line cancels, as
it does in nature. Length and regional sigma are defaults of reason and editable.

Source: Markov model of the first order; Moritz (1980), Advanced physical geodesy, section 22.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from surveyapp.core.geodesy import Position
from surveyapp.core.uncertain import Source
from surveyapp.domain.project import Project, Station
from surveyapp_models.arrays import Floats

EARTH_RADIUS_M = 6371000.0
JITTER = 1e-10
"""Added to the diagonal of a correlation matrix: stations at one place."""

Field = Mapping[str, Mapping[Source, float]]
"""Contributions [rad] of independent sources to one component at each station."""


def deflection_field(project: Project, positions: Mapping[str, Position]) -> Field:
    """Independent sources of the deflection at every occupied station.

    A station with a known deflection, or without a position, has an error of its own.
    """
    occupied = dict.fromkeys(session.station for session in project.sessions)
    stations = [project.station(name) for name in occupied]
    alone = [s for s in stations if s.deflection.known or _place(positions[s.name]) is None]
    field: dict[str, dict[Source, float]] = {
        station.name: {Source("deflection", station.name): station.deflection.sigma}
        for station in alone
    }
    joined = [station for station in stations if station not in alone]
    if joined:
        root = _root(joined, positions, length_m=project.deflection_length_m)
        for row, station in zip(root, joined, strict=True):
            field[station.name] = {
                Source("deflection", other.name): float(weight) * station.deflection.sigma
                for other, weight in zip(joined, row, strict=True)
                if weight != 0.0
            }
    return field


def _root(
    stations: Sequence[Station], positions: Mapping[str, Position], *, length_m: float
) -> Floats:
    """Square root of the correlation matrix, shape (n, n)."""
    count = len(stations)
    correlation = np.eye(count)
    if length_m > 0.0:
        places = [_place(positions[station.name]) for station in stations]
        for i in range(count):
            for j in range(i):
                apart = _distance(places[i], places[j])
                if apart is not None:
                    correlation[i, j] = correlation[j, i] = math.exp(-apart / length_m)
    matrix = correlation + JITTER * np.eye(count)
    return np.asarray(np.linalg.cholesky(matrix), dtype=np.float64)


Place = tuple[str, float, float] | None


def _place(at: Position) -> Place:
    if at.latitude is not None and at.longitude is not None:
        return "geographic", at.latitude, at.longitude
    return None if at.e is None or at.n is None else ("plane", at.e, at.n)


def _distance(first: Place, second: Place) -> float | None:
    if first is None or second is None or first[0] != second[0]:
        return None
    if first[0] == "plane":
        return math.hypot(first[1] - second[1], first[2] - second[2])
    north = first[1] - second[1]
    east = math.remainder(first[2] - second[2], 2.0 * math.pi) * math.cos(first[1])
    return math.hypot(north, east) * EARTH_RADIUS_M
