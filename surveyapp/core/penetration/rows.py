"""The observations of all headings as linear rows in the azimuths of the sides.

State: the azimuth of every side of every heading, then one constant per gyro. A row keeps apart
what its sigma is made of (reading, centring), because weights take both and the budget names each.
Refraction and deflection never enter the weights: an adjustment does not know them.

Source: penetration.md section 1.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from surveyapp.core.penetration.route import Route
from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats
from surveyapp_models.sight_refraction import sight_displacement

Ints = NDArray[np.int64]

LEAST_SIGMA = 1e-3 * ARCSEC
"""Floor of a sigma in the weights: an error-free row stays a row."""


class RowKind(IntEnum):
    """What a row observes."""

    ANGLE = 0
    GYRO = 1
    AZIMUTH = 2


@dataclass(frozen=True, slots=True)
class Row:
    """One observation of a heading.

    Parameters
    ----------
    kind : RowKind
    side : int
        Angle: the side ahead of the station (side - 1 lies behind); gyro, azimuth: the side.
    reading, centring : float
        1 sigma of each [rad].
    forward : bool
        Whether a gyro looks from the side's first station to its second.
    instrument : str
        Of a gyro.
    """

    kind: RowKind
    side: int
    reading: float
    centring: float = 0.0
    forward: bool = True
    instrument: str = ""


@dataclass(frozen=True, slots=True)
class HeadingRows:
    """What is observed in one heading.

    Parameters
    ----------
    route : Route
    rows : tuple of Row
    length_sigma, length_centring : ndarray, shape (sides,)
        1 sigma of each side by reading and by centring [m].
    height_sigma : ndarray, shape (sides,)
        1 sigma of each measured height difference [m]; NaN: not measured, the method of the
        project counts.
    marks : tuple of float
        Centring of instrument and of targets, each component [m].
    """

    route: Route
    rows: tuple[Row, ...]
    length_sigma: Floats
    length_centring: Floats
    height_sigma: Floats
    marks: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True, slots=True)
class RowArrays:
    """Rows of all headings as arrays, one entry per row.

    Parameters
    ----------
    unknowns : int array, shape (rows, 3)
        -1 where a row has fewer.
    partials : ndarray, shape (rows, 3)
    reading, centring, weight : ndarray, shape (rows,)
        [rad], [rad], [1/rad^2].
    heading, kind, instrument, station : int array, shape (rows,)
        Numbers; instrument -1 for none; station counts over all routes one after the other.
    refraction : ndarray, shape (rows,)
        Change of the reading per gradient at the warm wall [rad per K/m].
    size : int
        Number of unknowns.
    """

    unknowns: Ints
    partials: Floats
    reading: Floats
    centring: Floats
    weight: Floats
    heading: Ints
    kind: Ints
    instrument: Ints
    station: Ints
    refraction: Floats
    size: int

    def apply(self, values: Floats) -> Floats:
        """A x for one or several columns x, shape (rows, columns)."""
        padded = np.vstack([values, np.zeros((1, values.shape[1]))])
        return np.asarray(
            np.einsum("rk,rkc->rc", self.partials, padded[self.unknowns]), dtype=np.float64
        )


def angle_centring_sigma(
    route: Route, station: int, *, instrument_m: float, target_m: float
) -> float:
    """1 sigma of an angle by centring of instrument and both targets [rad]."""
    back, fore = float(route.length[station - 1]), float(route.length[station])
    turn = float(route.azimuth[station] - route.azimuth[station - 1])
    # |d_i/l_i^2 + d_(i-1)/l_(i-1)^2|^2
    between = 1.0 / fore**2 + 1.0 / back**2 + 2.0 * math.cos(turn) / (fore * back)
    return math.sqrt(
        target_m**2 * (1.0 / fore**2 + 1.0 / back**2) + instrument_m**2 * max(between, 0.0)
    )


def side_centring_sigma(route: Route, side: int, *, instrument_m: float, target_m: float) -> float:
    """1 sigma of the azimuth of a side by centring of both ends [rad]."""
    return math.hypot(instrument_m, target_m) / float(route.length[side])


def refraction_per_gradient(route: Route, row: Row, curvature: float) -> float:
    """Change of a reading by lateral refraction per gradient at the warm wall [rad per K/m].

    Displaced to the right where the warm wall is right of the drive and the sight looks forward,
    to the left where it looks back; an angle has both.
    """
    wall = route.heading.wall_signs()

    def sight(start: int, end: int, length: float) -> float:
        angle = sight_displacement(
            length, at_station=curvature * wall[start], at_target=curvature * wall[end]
        )
        return angle if end > start else -angle

    side = row.side
    if row.kind is RowKind.ANGLE:
        ahead = sight(side, side + 1, float(route.length[side]))
        return ahead - sight(side, side - 1, float(route.length[side - 1]))
    if row.kind is RowKind.GYRO:
        ends = (side, side + 1) if row.forward else (side + 1, side)
        return sight(*ends, float(route.length[side]))
    return 0.0


def row_arrays(
    headings: Sequence[HeadingRows], instruments: Sequence[str], *, curvature: float
) -> RowArrays:
    """Lay the rows of all headings side by side.

    Parameters
    ----------
    headings : sequence of HeadingRows
    instruments : sequence of str
        Gyros with a constant each, in the order of their unknowns.
    curvature : float
        Curvature per gradient [1/m per K/m].
    """
    sides = [heading.route.sides for heading in headings]
    first_side = np.concatenate(([0], np.cumsum(sides)))
    size = int(first_side[-1]) + len(instruments)
    place = {name: int(first_side[-1]) + i for i, name in enumerate(instruments)}
    unknowns, partials, plain = [], [], []
    for number, heading in enumerate(headings):
        base = int(first_side[number])
        station_base = base + number
        for row in heading.rows:
            at = base + row.side
            constant = place[row.instrument] if row.kind is RowKind.GYRO else -1
            if row.kind is RowKind.ANGLE:
                unknowns.append((at, at - 1, -1))
                partials.append((1.0, -1.0, 0.0))
            else:
                unknowns.append((at, constant, -1))
                partials.append((1.0, 1.0 if constant >= 0 else 0.0, 0.0))
            station = station_base + row.side + (0 if row.forward else 1)
            index = instruments.index(row.instrument) if constant >= 0 else -1
            bend = refraction_per_gradient(heading.route, row, curvature)
            variance = max(math.hypot(row.reading, row.centring), LEAST_SIGMA) ** 2
            plain.append(
                (row.reading, row.centring, 1.0 / variance, number, row.kind, index, station, bend)
            )
    table = np.array(plain, dtype=np.float64).reshape(-1, 8)
    numbers = table[:, 3:7].astype(np.int64)
    return RowArrays(
        np.array(unknowns, dtype=np.int64).reshape(-1, 3),
        np.array(partials, dtype=np.float64).reshape(-1, 3),
        table[:, 0],
        table[:, 1],
        table[:, 2],
        numbers[:, 0],
        numbers[:, 1],
        numbers[:, 2],
        numbers[:, 3],
        table[:, 7],
        size,
    )
