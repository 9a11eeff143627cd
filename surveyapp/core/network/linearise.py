"""One linearisation per kind of observation: computed value and partial derivatives.

Each function takes the slots (places in the vector of all coordinates and nuisance values) of many
observations of its kind and returns their computed values and partials in the order of the slots.
Azimuths are clockwise from north, arctan2(east, north); no unit factor appears here.

Source of the partials: C. D. Ghilani (2010), Adjustment Computations, 5th ed., chapters 14
(distances) and 15 (azimuths, angles); H. Wolf (1979), Ausgleichungsrechnung II, pp. 87-90 (space).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from surveyapp.domain.observations import ObservationKind
from surveyapp_models.arrays import Floats

Ints = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class Linear:
    """Computed values (n,) and partials (n, q)."""

    computed: Floats
    partials: Floats


Kind = Callable[[Floats, Ints, Floats], Linear]
"""values (all slots), slots (n, q), constant part (n,) -> Linear."""


def _bearing(east: Floats, north: Floats) -> tuple[Floats, Floats, Floats]:
    """Azimuth and its partials with respect to the target's east and north."""
    square = east * east + north * north
    return np.arctan2(east, north), north / square, -east / square


def distance(values: Floats, slots: Ints, constant: Floats) -> Linear:
    """Horizontal distance; slots e1, n1, e2, n2."""
    p = values[slots]
    east, north = p[:, 2] - p[:, 0], p[:, 3] - p[:, 1]
    length = np.hypot(east, north)
    u, v = east / length, north / length
    return Linear(length + constant, np.stack((-u, -v, u, v), axis=1))


def slope_distance(values: Floats, slots: Ints, constant: Floats) -> Linear:
    """Slope distance; slots e1, n1, h1, e2, n2, h2; constant = ht - hi."""
    p = values[slots]
    delta = p[:, 3:] - p[:, :3]
    delta[:, 2] += constant
    length = np.sqrt(np.einsum("ni,ni->n", delta, delta))
    unit = delta / length[:, None]
    return Linear(length, np.concatenate((-unit, unit), axis=1))


def zenith(values: Floats, slots: Ints, constant: Floats) -> Linear:
    """Zenith angle; slots e1, n1, h1, e2, n2, h2; constant = ht - hi."""
    p = values[slots]
    delta = p[:, 3:] - p[:, :3]
    delta[:, 2] += constant
    level = np.hypot(delta[:, 0], delta[:, 1])
    square = level**2 + delta[:, 2] ** 2
    factor = delta[:, 2] / (square * level)
    unit = np.stack((delta[:, 0] * factor, delta[:, 1] * factor, -level / square), axis=1)
    return Linear(np.arctan2(level, delta[:, 2]), np.concatenate((-unit, unit), axis=1))


def azimuth(values: Floats, slots: Ints, constant: Floats) -> Linear:
    """Grid azimuth; slots e1, n1, e2, n2."""
    p = values[slots]
    angle, u, v = _bearing(p[:, 2] - p[:, 0], p[:, 3] - p[:, 1])
    return Linear(angle + constant, np.stack((-u, -v, u, v), axis=1))


def oriented(values: Floats, slots: Ints, constant: Floats) -> Linear:
    """Azimuth minus a shared unknown; slots e1, n1, e2, n2, unknown.

    A direction (unknown = orientation of the circle) and a gyro azimuth (unknown = instrument
    constant, constant = convergence of the station) are the same function.
    """
    line = azimuth(values, slots[:, :4], constant)
    shared = np.full((len(slots), 1), -1.0)
    return Linear(
        line.computed - values[slots[:, 4]], np.concatenate((line.partials, shared), axis=1)
    )


def angle(values: Floats, slots: Ints, constant: Floats) -> Linear:
    """Angle clockwise from the back sight; slots e, n of station, back sight, fore sight."""
    p = values[slots]
    back, ub, vb = _bearing(p[:, 2] - p[:, 0], p[:, 3] - p[:, 1])
    fore, uf, vf = _bearing(p[:, 4] - p[:, 0], p[:, 5] - p[:, 1])
    partials = np.stack((ub - uf, vb - vf, -ub, -vb, uf, vf), axis=1)
    return Linear(fore - back + constant, partials)


def difference(values: Floats, slots: Ints, constant: Floats) -> Linear:
    """Difference of one coordinate; slots of station and target; constant = ht - hi or 0."""
    p = values[slots]
    partials = np.tile(np.array([-1.0, 1.0]), (len(slots), 1))
    return Linear(p[:, 1] - p[:, 0] + constant, partials)


def single(values: Floats, slots: Ints, constant: Floats) -> Linear:
    """One unknown observed directly; one slot."""
    return Linear(values[slots[:, 0]] + constant, np.ones((len(slots), 1)))


Touched = tuple[tuple[str, int], ...]
"""Coordinates in the order of the partials: of ``at``, ``back``, ``to``; east, north or height."""

PLANE: Touched = tuple((who, c) for who in ("at", "to") for c in (0, 1))
SPACE: Touched = tuple((who, c) for who in ("at", "to") for c in (0, 1, 2))
TURNED: Touched = tuple((who, c) for who in ("at", "back", "to") for c in (0, 1))


@dataclass(frozen=True, slots=True)
class Equation:
    """The observation equation of one kind.

    Parameters
    ----------
    kind : ObservationKind
    linear : callable
        Computed value and partials.
    touches : tuple of (str, int)
        Coordinates in the order of the partials.
    shares : bool
        One more slot behind them: the orientation of a set, or an instrument constant.
    heights : bool
        Its constant part is the height of the target minus that of the instrument.
    """

    kind: ObservationKind
    linear: Kind
    touches: Touched
    shares: bool = False
    heights: bool = False


K = ObservationKind
EQUATIONS: tuple[Equation, ...] = (
    Equation(K.ANGLE, angle, TURNED),
    Equation(K.DIRECTION, oriented, PLANE, shares=True),
    Equation(K.DISTANCE, distance, PLANE),
    Equation(K.SLOPE_DISTANCE, slope_distance, SPACE, heights=True),
    Equation(K.ZENITH, zenith, SPACE, heights=True),
    Equation(K.HEIGHT_DIFFERENCE, difference, (("at", 2), ("to", 2)), heights=True),
    Equation(K.AZIMUTH, azimuth, PLANE),
    Equation(K.GYRO, oriented, PLANE, shares=True),
    Equation(K.GYRO_CONSTANT, single, (), shares=True),
    Equation(K.COORDINATE_E, single, (("at", 0),)),
    Equation(K.COORDINATE_N, single, (("at", 1),)),
    Equation(K.COORDINATE_H, single, (("at", 2),)),
    Equation(K.VECTOR_E, difference, (("at", 0), ("to", 0))),
    Equation(K.VECTOR_N, difference, (("at", 1), ("to", 1))),
    Equation(K.VECTOR_H, difference, (("at", 2), ("to", 2)), heights=True),
)
"""One equation for every kind of ``domain.observations``; a test asks for completeness."""

LINEARISATION = MappingProxyType({item.kind: item.linear for item in EQUATIONS})
OFFSETS = MappingProxyType({item.kind: item.touches for item in EQUATIONS})
SHARING = frozenset(item.kind for item in EQUATIONS if item.shares)
"""Kinds with one more slot: an orientation or a constant."""
WITH_HEIGHTS = frozenset(item.kind for item in EQUATIONS if item.heights)
