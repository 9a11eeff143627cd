"""The plane of a projected CRS: true east and north in metres, whatever its axes and units are.

Positions go through pyproj's Transformer, which knows axis order, units and prime meridian of
every CRS; what a grid does to directions and lengths is the derivative of the positions.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from surveyapp_models.arrays import Floats

if TYPE_CHECKING:
    from pyproj import CRS, Transformer

STEP: Final = 3e-4
"""Step of the central differences [rad], about 2 km: with six points the truncation is below
1e-12 of the derivative, the rounding of the coordinates (1e-9 m) below 1e-12 as well."""
WEIGHTS: Final = (-1.0 / 60.0, 3.0 / 20.0, -3.0 / 4.0, 0.0, 3.0 / 4.0, -3.0 / 20.0, 1.0 / 60.0)
"""Central first derivative of order six. Source: Fornberg (1988), Math. Comp. 51, table 1."""

_EAST: Final = {"east": 1.0, "west": -1.0}
_NORTH: Final = {"north": 1.0, "south": -1.0}
_NAMED: Final = {
    "easting": (0, 1.0),
    "westing": (0, -1.0),
    "northing": (1, 1.0),
    "southing": (1, -1.0),
}


@dataclass(frozen=True, slots=True)
class Axis:
    """One axis of a CRS as it stands in its coordinates.

    Parameters
    ----------
    place : int
        0: the axis counts east (longitude), 1: north (latitude).
    factor : float
        What a coordinate is multiplied by: to metres or radians, negative where the axis points
        west or south.
    """

    place: int
    factor: float


def axes_of(crs: CRS) -> tuple[Axis, Axis] | None:
    """The two horizontal axes of a CRS in their order; None where they cannot be told apart.

    Both axes of a grid about a pole point north (or south) along different meridians: there their
    names tell which is the easting.
    """
    found = []
    for axis in crs.axis_info[:2]:
        direction, name = axis.direction.lower(), axis.name.lower()
        found.append((direction, name, float(axis.unit_conversion_factor)))
    if len(found) < 2:
        return None
    if {direction in _EAST for direction, _, _ in found} == {True, False}:
        places = [
            (0, _EAST[direction]) if direction in _EAST else (1, _NORTH.get(direction, 0.0))
            for direction, _, _ in found
        ]
    else:
        places = [_NAMED.get(name, (0, 0.0)) for _, name, _ in found]
    if {place for place, _ in places} != {0, 1} or any(sign == 0.0 for _, sign in places):
        return None
    first, second = (
        Axis(place, sign * unit) for (place, sign), (_, _, unit) in zip(places, found, strict=True)
    )
    return first, second


@dataclass(frozen=True, slots=True)
class Differential:
    """What a grid does to a small figure at a place.

    Parameters
    ----------
    by_meridian, by_parallel : tuple of float
        Change of east and north per metre towards north and towards east [-].
    """

    by_meridian: tuple[float, float]
    by_parallel: tuple[float, float]

    @property
    def convergence(self) -> float:
        """Angle from true north to grid north [rad], positive where grid north lies east."""
        east, north = self.by_meridian
        return -math.atan2(east, north)

    @property
    def scales(self) -> tuple[float, float]:
        """Smallest and largest scale factor over all directions [-]."""
        matrix = np.array([self.by_parallel, self.by_meridian]).T
        largest, smallest = np.linalg.svd(matrix, compute_uv=False).tolist()
        return smallest, largest

    @property
    def distortion(self) -> float:
        """Largest change of an angle [rad]; 0 for a conformal grid. Source: Snyder (1987), 4-1."""
        smallest, largest = self.scales
        return 2.0 * math.asin((largest - smallest) / (largest + smallest))

    @property
    def is_finite(self) -> bool:
        """Whether the grid is defined all around the place, and not turned inside out."""
        (me, mn), (pe, pn) = self.by_meridian, self.by_parallel
        determinant = pe * mn - me * pn
        return math.isfinite(determinant) and determinant > 0.0


@dataclass(frozen=True, slots=True)
class Plane:
    """A projected CRS as a map between the ellipsoid and true east and north.

    Parameters
    ----------
    transformer : pyproj.Transformer
        From the CRS's own geographic CRS to it, axes and units as both have them: a conversion
        without any change of datum.
    axes, base_axes : tuple of Axis
        Of the projected and of the geographic CRS.
    prime_meridian : float
        Longitude of the zero meridian east of Greenwich [rad].
    semi_major_m, eccentricity_squared : float
        Of the ellipsoid [m], [-].
    """

    transformer: Transformer
    axes: tuple[Axis, Axis]
    base_axes: tuple[Axis, Axis]
    prime_meridian: float
    semi_major_m: float
    eccentricity_squared: float

    def project(self, latitude: Floats, longitude: Floats) -> tuple[Floats, Floats]:
        """True east and north [m] of positions [rad], shape (n,); infinite where undefined."""
        own = (longitude - self.prime_meridian, latitude)
        given = [own[axis.place] / axis.factor for axis in self.base_axes]
        found = self.transformer.transform(given[0], given[1], direction="FORWARD")
        return _placed(found, self.axes)

    def unproject(self, e: float, n: float) -> tuple[float, float]:
        """Latitude and longitude east of Greenwich [rad]; infinite where undefined."""
        given = [(e, n)[axis.place] / axis.factor for axis in self.axes]
        found = self.transformer.transform(given[0], given[1], direction="INVERSE")
        longitude, latitude = _placed([np.array([v]) for v in found], self.base_axes)
        east = float(longitude[0]) + self.prime_meridian
        return float(latitude[0]), math.remainder(east, 2.0 * math.pi) if abs(east) < 1e9 else east

    def differential(self, *, latitude: float, longitude: float) -> Differential:
        """Derivatives of the position by a step on the ellipsoid, by central differences."""
        steps = STEP * np.arange(-3.0, 4.0)
        still = np.zeros_like(steps)
        e, n = self.project(
            np.concatenate([latitude + steps, latitude + still]),
            np.concatenate([longitude + still, longitude + steps]),
        )
        weights = np.array(WEIGHTS) / STEP
        w = 1.0 - self.eccentricity_squared * math.sin(latitude) ** 2
        meridian_m = self.semi_major_m * (1.0 - self.eccentricity_squared) / w**1.5
        parallel_m = self.semi_major_m / math.sqrt(w) * math.cos(latitude)
        with np.errstate(invalid="ignore"):
            meridian = [float(weights @ part[:7]) / meridian_m for part in (e, n)]
            parallel = [float(weights @ part[7:]) / parallel_m for part in (e, n)]
        return Differential((meridian[0], meridian[1]), (parallel[0], parallel[1]))


def _placed(values: Sequence[Floats], axes: tuple[Axis, Axis]) -> tuple[Floats, Floats]:
    """Coordinates in the order east, north."""
    ordered = {
        axis.place: np.asarray(value, dtype=np.float64) * axis.factor
        for axis, value in zip(axes, values, strict=True)
    }
    return ordered[0], ordered[1]
