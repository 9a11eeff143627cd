"""A grid ready to compute: one of the register, or a mine's own beside it.

``e`` and ``n`` are always true east and north of the grid in metres. Signs as in design.md
section 2: the convergence is positive where grid north lies east of true north.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

import numpy as np

from surveyapp.core.geodesy.plane import Differential, Plane
from surveyapp.errors import Problem, SurveyError
from surveyapp_models.angles import wrap_pi

if TYPE_CHECKING:
    from pyproj import Geod

AREA_MARGIN_DEG: Final = 1.0
"""Beside its area by less, a grid may still be in use: the neighbour's zone is often carried on."""
ZONE_DEG: Final = 6.0
"""Width of a zone of UTM."""


@dataclass(frozen=True, slots=True)
class Frame:
    """A mine's own coordinates against those of its base grid: turned, shifted and scaled.

    Parameters
    ----------
    rotation : float
        Azimuth of the mine's grid north in the base grid [rad], clockwise: base azimuth = mine
        azimuth + rotation.
    e, n : float
        The origin in the mine's coordinates [m].
    base_e, base_n : float
        The same point in the base grid [m].
    scale : float
        A length in the mine's grid divided by that in the base grid [-].
    sigma : float
        Standard deviation of the rotation [rad].
    """

    rotation: float = 0.0
    e: float = 0.0
    n: float = 0.0
    base_e: float = 0.0
    base_n: float = 0.0
    scale: float = 1.0
    sigma: float = 0.0

    def to_base(self, *, e: float, n: float) -> tuple[float, float]:
        """Base coordinates [m] of a point in the mine's."""
        east, north = (e - self.e) / self.scale, (n - self.n) / self.scale
        c, s = math.cos(self.rotation), math.sin(self.rotation)
        return self.base_e + east * c + north * s, self.base_n - east * s + north * c

    def from_base(self, *, e: float, n: float) -> tuple[float, float]:
        """The mine's coordinates [m] of a point in the base grid."""
        east, north = (e - self.base_e) * self.scale, (n - self.base_n) * self.scale
        c, s = math.cos(self.rotation), math.sin(self.rotation)
        return self.e + east * c - north * s, self.n + east * s + north * c


@dataclass(frozen=True, slots=True)
class Grid:
    """A grid, ready to compute.

    Parameters
    ----------
    text : str
        As written in the project.
    name : str
        Its official name.
    plane : Plane
        The projected CRS below it.
    geodesic : pyproj.Geod
    directions_from_south : bool
        Whether the axes ask for directions counted from south.
    transverse_mercator : bool
        Whether the base is a transverse Mercator (Gauss-Krueger, UTM, Lo).
    area_deg : tuple of float or None
        West, south, east, north of the area for which the grid is made [degrees].
    frame : Frame
        The mine's own grid against the base; as it stands where there is none.
    """

    text: str
    name: str
    plane: Plane
    geodesic: Geod
    directions_from_south: bool = False
    transverse_mercator: bool = False
    area_deg: tuple[float, float, float, float] | None = None
    frame: Frame = field(default_factory=Frame)

    def geographic(self, *, e: float, n: float) -> tuple[float, float]:
        """Latitude and longitude [rad] of true grid coordinates [m]."""
        base_e, base_n = self.frame.to_base(e=e, n=n)
        latitude, longitude = self.plane.unproject(base_e, base_n)
        finite = math.isfinite(latitude) and math.isfinite(longitude)
        if not finite or abs(latitude) > 0.5 * math.pi:
            raise self._outside(f"e = {e:.3f}, n = {n:.3f}")
        return latitude, longitude

    def projected(self, *, latitude: float, longitude: float) -> tuple[float, float]:
        """True east and north [m] of a geographic position [rad]."""
        e, n = self.plane.project(np.array([latitude]), np.array([longitude]))
        if not (math.isfinite(e[0]) and math.isfinite(n[0])):
            raise self._outside(_degrees(latitude=latitude, longitude=longitude))
        return self.frame.from_base(e=float(e[0]), n=float(n[0]))

    def differential(self, *, latitude: float, longitude: float) -> Differential:
        """What the base grid does to directions and lengths at a place [rad]."""
        found = self.plane.differential(latitude=latitude, longitude=longitude)
        if not found.is_finite:
            raise self._outside(_degrees(latitude=latitude, longitude=longitude))
        return found

    def convergence(self, *, latitude: float, longitude: float) -> float:
        """Convergence [rad], positive where grid north lies east of true north.

        That of the base as the derivative of the position along the meridian, and the rotation of
        the mine's own grid against it.
        """
        base = self.differential(latitude=latitude, longitude=longitude).convergence
        return wrap_pi(base + self.frame.rotation)

    def is_beside(self, *, latitude: float, longitude: float) -> bool:
        """Whether a place [rad] lies beside the area of the grid by more than a margin."""
        if self.area_deg is None:
            return False
        west, south, east, north = self.area_deg
        width = (east - west) % 360.0 or 360.0
        from_west = (math.degrees(longitude) - west + AREA_MARGIN_DEG) % 360.0
        inside = south - AREA_MARGIN_DEG <= math.degrees(latitude) <= north + AREA_MARGIN_DEG
        return not (inside and from_west <= width + 2.0 * AREA_MARGIN_DEG)

    def beyond_deg(self, *, latitude: float, longitude: float) -> float:
        """How far a place [rad] lies outside of the area of the grid [degrees of arc], 0 inside.

        The zone beside that of a transverse Mercator is inside: whole countries are mapped so.
        """
        if self.area_deg is None:
            return 0.0
        west, south, east, north = self.area_deg
        latitude_deg = math.degrees(latitude)
        along = max(south - latitude_deg, latitude_deg - north, 0.0)
        width = (east - west) % 360.0 or 360.0
        from_west = (math.degrees(longitude) - west) % 360.0
        across = 0.0 if from_west <= width else min(from_west - width, 360.0 - from_west)
        if self.transverse_mercator:
            across = max(across - ZONE_DEG, 0.0)
        return math.hypot(along, across * math.cos(latitude))

    def _outside(self, where: str) -> SurveyError:
        return SurveyError(
            Problem(
                what="the position lies outside the area where this grid is defined",
                where=where,
                found=self.text,
                expected="a position that the projection can reach",
                hint="Check the coordinates, their order and the crs.",
            )
        )


def _degrees(*, latitude: float, longitude: float) -> str:
    return f"latitude {math.degrees(latitude):.6f}, longitude {math.degrees(longitude):.6f}"
