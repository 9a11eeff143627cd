"""Unknown deflections of the vertical as a field: near stations have nearly the same.

The correlation falls as exp(-d / L) with the distance d. A difference of two stations has the
variance 2 sigma^2 (1 - exp(-d / L)): what is common to the known and the unknown line cancels, as
it does in nature. Length and regional sigma are defaults of reason and editable.

Every line uses the constant, and so the stations of the calibrations; it meets the other lines
seldom. The stations of the calibrations have the sources of the whole factor, every other station
these and one of its own for what they do not tell. Variances of lines, and covariances of a line
with a constant, are those of the dense field; work and memory are linear in the stations. Lines
of several stations that enter one difference are first put through ``jointly``.

Source: Markov model of the first order; Moritz (1980), Advanced physical geodesy, section 22.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from surveyapp.core.geodesy import Position
from surveyapp.core.uncertain import Source, Uncertain
from surveyapp.domain.project import Project
from surveyapp_models.arrays import Floats

EARTH_RADIUS_M = 6371000.0
JITTER = 1e-10
"""Added to the diagonal of a correlation matrix: stations at one place."""
NAME = "deflection"


@dataclass(frozen=True, slots=True)
class _Places:
    """Stations of the field in their order of occupation.

    Parameters
    ----------
    plane : ndarray, shape (n,)
        1 where a place is known in a plane only, else 0; between the two no distance is known.
    north, east : ndarray, shape (n,)
        [m], or latitude and longitude [rad].
    length_m : float
        Correlation length.
    """

    plane: Floats
    north: Floats
    east: Floats
    length_m: float

    def correlation(self, rows: Sequence[int], columns: Sequence[int]) -> Floats:
        """Correlation of some stations with others, shape (rows, columns)."""
        i, j = np.asarray(rows, dtype=int)[:, None], np.asarray(columns, dtype=int)[None, :]
        same = np.where(i == j, 1.0 + JITTER, 0.0)
        if self.length_m <= 0.0:
            return same
        north, east = self.north[i] - self.north[j], self.east[i] - self.east[j]
        turned = east - 2.0 * math.pi * np.round(east / (2.0 * math.pi))
        turned = turned * np.cos(self.north[np.maximum(i, j)])
        on_earth = np.hypot(north, turned) * EARTH_RADIUS_M
        apart = np.where(self.plane[i] > 0.0, np.hypot(north, east), on_earth)
        known = (self.plane[i] == self.plane[j]) & (i != j)
        return np.asarray(same + np.where(known, np.exp(-apart / self.length_m), 0.0))


@dataclass(frozen=True, slots=True)
class DeflectionField:
    """Independent sources of the deflection at every occupied station.

    Parameters
    ----------
    sources : mapping of station to its sources
        Contributions [rad] to one component. A station with a known deflection, or without a
        position, has an error of its own.
    free : mapping of station to (place, weights)
        Stations of no calibration: their place in the field, and the part of them that the
        stations of the calibrations tell, shape (k,).
    places : _Places
    """

    sources: Mapping[str, Mapping[Source, float]]
    free: Mapping[str, tuple[int, Floats]]
    places: _Places

    def jointly(self, items: Sequence[Uncertain]) -> list[Uncertain]:
        """Values with the sources that their stations share, for sums and differences of them.

        Each keeps its variance; the covariance of any two becomes that of the dense field.
        """
        names = list(
            dict.fromkeys(
                source.entity
                for item in items
                for source in item.parts
                if source.name == NAME and source.entity in self.free
            )
        )
        if len(names) < 2:
            return list(items)
        rows = self._root_of_rest(names)
        return [replace(item, parts=_spread(item.parts, names, rows)) for item in items]

    def _root_of_rest(self, names: Sequence[str]) -> Mapping[str, Floats]:
        """Square root of the correlation of what the calibrations do not tell, by station."""
        at = [self.free[name][0] for name in names]
        told = np.array([self.free[name][1] for name in names])
        rest = self.places.correlation(at, at) - told @ told.T
        scale = np.sqrt(np.diag(rest))
        root = np.linalg.cholesky(rest / np.outer(scale, scale))
        return dict(zip(names, root, strict=True))


def _spread(
    parts: Mapping[Source, float], names: Sequence[str], rows: Mapping[str, Floats]
) -> dict[Source, float]:
    """Contributions with that of each station's rest spread over the sources of all of them."""
    found: dict[Source, float] = {}
    for source, part in parts.items():
        shared = [(source, 1.0)]
        if source.name == NAME and source.entity in rows:
            weights = rows[source.entity].tolist()
            shared = [
                (replace(source, entity=name), weight)
                for name, weight in zip(names, weights, strict=True)
                if weight != 0.0
            ]
        for own, weight in shared:
            found[own] = found.get(own, 0.0) + weight * part
    return found


def deflection_field(project: Project, positions: Mapping[str, Position]) -> DeflectionField:
    """Independent sources of the deflection at every occupied station."""
    occupied = dict.fromkeys(session.station for session in project.sessions)
    known = {s.station for s in project.sessions if s.purpose == "calibration"}
    stations = {station.name: station for station in project.stations}
    joined = [
        name
        for name in occupied
        if not stations[name].deflection.known and _place(positions[name]) is not None
    ]
    places = _places([positions[name] for name in joined], length_m=project.deflection_length_m)
    base = [i for i, name in enumerate(joined) if name in known]
    rest = [i for i, name in enumerate(joined) if name not in known]
    root = np.linalg.cholesky(places.correlation(base, base))
    told = np.linalg.solve(root, places.correlation(base, rest)).T
    own = np.sqrt(1.0 + JITTER - np.sum(told * told, axis=1))
    weights = {joined[i]: row for i, row in zip(base, root, strict=True)}
    weights |= {joined[i]: row for i, row in zip(rest, told, strict=True)}
    alone = dict(zip((joined[i] for i in rest), own.tolist(), strict=True))
    shared = [Source(NAME, joined[i]) for i in base]
    field: dict[str, dict[Source, float]] = {}
    for name in occupied:
        sigma = stations[name].deflection.sigma
        if name not in weights:
            field[name] = {Source(NAME, name): sigma}
            continue
        row = zip(shared, weights[name].tolist(), strict=True)
        field[name] = {source: weight * sigma for source, weight in row if weight != 0.0}
        if name in alone:
            field[name][Source(NAME, name)] = alone[name] * sigma
    free = {joined[i]: (i, row) for i, row in zip(rest, told, strict=True)}
    return DeflectionField(field, free, places)


Place = tuple[float, float, float]


def _places(positions: Sequence[Position], *, length_m: float) -> _Places:
    found = np.array([_place(at) for at in positions], dtype=np.float64).reshape(-1, 3)
    return _Places(found[:, 0], found[:, 1], found[:, 2], length_m)


def _place(at: Position) -> Place | None:
    """Whether in a plane only (1 or 0), north and east; None where the position is not known."""
    if at.latitude is not None and at.longitude is not None:
        return 0.0, at.latitude, at.longitude
    return None if at.e is None or at.n is None else (1.0, at.n, at.e)
