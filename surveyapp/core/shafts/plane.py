"""A small plane network around the wires: surface or underground, by least squares.

Underground nothing is fixed: what is asked of it (azimuths relative to the line of the wires,
their distance) does not depend on where it lies, and the least-norm solution serves. What is not
determined is refused by name.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from surveyapp.domain.shaft import ShaftRow, ShaftRowKind
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said
from surveyapp_models.angles import wrap_pi
from surveyapp_models.arrays import Floats

MAX_ITERATIONS = 40
SMALLEST_STEP_M = 1e-11
RANK = 1e-9
"""Singular values below this share of the largest belong to what is not determined."""
SUPPOSED_M = 50.0
"""Length of a side that is oriented and not measured: its azimuth does not depend on it."""

Place = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Sight:
    """A row with its standard deviation."""

    row: ShaftRow
    sigma: float


@dataclass(frozen=True, slots=True)
class PlaneSolution:
    """Adjusted network.

    Parameters
    ----------
    places : mapping of str to (east, north)
        [m]; underground in a frame of its own.
    order : tuple of str
        Free points, in the order of their unknowns.
    spread : ndarray, shape (unknowns, rows)
        Change of the unknowns per standard deviation of each row.
    open : ndarray, shape (unknowns, q)
        Directions in which the network is not determined.
    rows : tuple of Sight
    """

    places: Mapping[str, Place]
    order: tuple[str, ...]
    spread: Floats
    open: Floats
    rows: tuple[Sight, ...]

    def gradient(self, function: Callable[[Mapping[str, Place]], float]) -> Floats:
        """Derivative of a function of the places by the unknowns (central differences)."""
        found = np.zeros(2 * len(self.order))
        for i in range(len(found)):
            name, axis = self.order[i // 2], i % 2
            values = []
            for step in (1e-5, -1e-5):
                moved = dict(self.places)
                old = moved[name]
                moved[name] = (old[0] + step, old[1]) if axis == 0 else (old[0], old[1] + step)
                values.append(function(moved))
            found[i] = wrap_pi(values[0] - values[1]) / 2e-5
        return found

    def per_row(self, function: Callable[[Mapping[str, Place]], float], what: str) -> Floats:
        """What one standard deviation of each row does to a function of the places.

        Raises
        ------
        SurveyError
            If the network does not determine it.
        """
        slope = self.gradient(function)
        loose = float(np.linalg.norm(slope @ self.open)) if self.open.size else 0.0
        if loose > 1e-6 * max(float(np.linalg.norm(slope)), 1e-12):
            raise SurveyError(
                Problem(
                    said("{what} is not determined by the rows of the book", what=what),
                    what,
                    "",
                    "more rows",
                )
            )
        return np.asarray(slope @ self.spread, dtype=np.float64)


def bearing(places: Mapping[str, Place], at: str, to: str) -> float:
    """Azimuth from one point to another [rad]."""
    a, b = places[at], places[to]
    return math.atan2(b[0] - a[0], b[1] - a[1])


def length(places: Mapping[str, Place], at: str, to: str) -> float:
    """Distance of two points [m]."""
    a, b = places[at], places[to]
    return math.hypot(b[0] - a[0], b[1] - a[1])


def solve_plane(
    sights: Sequence[Sight], fixed: Mapping[str, Place], start: tuple[str, str]
) -> PlaneSolution:
    """Adjust a network.

    Parameters
    ----------
    sights : sequence of Sight
        Angles, distances and azimuths.
    fixed : mapping
        Points with known coordinates; empty for a network in a frame of its own.
    start : tuple of str
        The side from which a free network is laid out.

    Raises
    ------
    SurveyError
        If a point cannot be placed from what is known.
    """
    places = _laid_out([sight.row for sight in sights], fixed, start)
    order = tuple(name for name in places if name not in fixed)
    free = {name: i for i, name in enumerate(order)}
    if not sights or not order:
        spread = np.zeros((2 * len(order), len(sights)))
        return PlaneSolution(places, order, spread, np.eye(2 * len(order)), tuple(sights))
    inverse: Floats = np.zeros((2 * len(order), len(sights)))
    jacobian: Floats = np.zeros((len(sights), 2 * len(order)))
    for _ in range(MAX_ITERATIONS):
        jacobian, misclosure = _equations(sights, places, free)
        inverse = np.asarray(np.linalg.pinv(jacobian, rcond=RANK), dtype=np.float64)
        step = inverse @ misclosure
        for name, i in free.items():
            e, n = places[name]
            places[name] = (e + float(step[2 * i]), n + float(step[2 * i + 1]))
        if float(np.max(np.abs(step), initial=0.0)) < SMALLEST_STEP_M:
            break
    _, values, vectors = np.linalg.svd(jacobian, full_matrices=True)
    rank = int(np.sum(values > RANK * values[0]))
    return PlaneSolution(places, order, inverse, vectors[rank:].T, tuple(sights))


def _equations(
    sights: Sequence[Sight], places: Mapping[str, Place], free: Mapping[str, int]
) -> tuple[Floats, Floats]:
    """Whitened derivatives and misclosures."""
    jacobian = np.zeros((len(sights), 2 * len(free)))
    misclosure = np.zeros(len(sights))
    for i, sight in enumerate(sights):
        row = sight.row
        if row.kind is ShaftRowKind.DISTANCE:
            computed = length(places, row.at, row.to)
            misclosure[i] = (row.value - computed) / sight.sigma
            _add_distance(jacobian[i], (row.at, row.to), places, free)
        else:
            computed = bearing(places, row.at, row.to)
            _add_bearing(jacobian[i], (row.at, row.to), places, (free, 1.0))
            if row.kind is ShaftRowKind.ANGLE:
                computed -= bearing(places, row.at, row.back)
                _add_bearing(jacobian[i], (row.at, row.back), places, (free, -1.0))
            misclosure[i] = wrap_pi(row.value - computed) / sight.sigma
        jacobian[i] /= sight.sigma
    return jacobian, misclosure


def _add_distance(
    row: Floats, ends: tuple[str, str], places: Mapping[str, Place], free: Mapping[str, int]
) -> None:
    azimuth = bearing(places, *ends)
    for name, sign in zip(ends, (-1.0, 1.0), strict=True):
        if name in free:
            row[2 * free[name]] += sign * math.sin(azimuth)
            row[2 * free[name] + 1] += sign * math.cos(azimuth)


def _add_bearing(
    row: Floats,
    ends: tuple[str, str],
    places: Mapping[str, Place],
    how: tuple[Mapping[str, int], float],
) -> None:
    free, factor = how
    azimuth, distance = bearing(places, *ends), length(places, *ends)
    for name, sign in zip(ends, (-factor, factor), strict=True):
        if name in free:
            row[2 * free[name]] += sign * math.cos(azimuth) / distance
            row[2 * free[name] + 1] -= sign * math.sin(azimuth) / distance


def _laid_out(
    rows: Sequence[ShaftRow], fixed: Mapping[str, Place], start: tuple[str, str]
) -> dict[str, Place]:
    """First places of all points, carried from what is known side by side."""
    distances = {
        frozenset((row.at, row.to)): row.value for row in rows if row.kind is ShaftRowKind.DISTANCE
    }
    names = dict.fromkeys(name for row in rows for name in (row.at, row.back, row.to) if name)
    places: dict[str, Place] = {name: place for name, place in fixed.items() if name in names}
    if not fixed:
        reach = distances.get(frozenset(start), SUPPOSED_M)
        places = {start[0]: (0.0, 0.0), start[1]: (0.0, reach)}
    growing = True
    while growing:
        growing = any(_placed(row, places, distances, start) for row in rows)
    missing = [name for name in names if name not in places]
    if missing:
        expected = "an angle and a distance that join it to placed points"
        raise SurveyError(
            [
                Problem(
                    "a point that cannot be placed", said("point {name}", name=name), "", expected
                )
                for name in missing
            ]
        )
    return places


def _placed(
    row: ShaftRow,
    places: dict[str, Place],
    distances: Mapping[frozenset[str], float],
    start: tuple[str, str],
) -> bool:
    """Place one more point by a row, if it can be."""
    if row.at not in places or row.kind is ShaftRowKind.DISTANCE:
        return False
    if row.kind is ShaftRowKind.AZIMUTH:
        turns = [(row.to, row.value)]
    elif row.back in places:
        turns = [(row.to, bearing(places, row.at, row.back) + row.value)]
    elif row.to in places:
        turns = [(row.back, bearing(places, row.at, row.to) - row.value)]
    else:
        return False
    for name, azimuth in turns:
        reach = distances.get(frozenset((row.at, name)))
        if reach is None and {row.at, name} == set(start):
            reach = SUPPOSED_M
        if name not in places and reach is not None:
            e, n = places[row.at]
            places[name] = (e + reach * math.sin(azimuth), n + reach * math.cos(azimuth))
            return True
    return False
