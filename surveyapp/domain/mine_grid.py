"""A mine's own grid as the project states it, and a convergence that a record prints."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class MineGrid:
    """A grid turned, shifted and scaled against a projected CRS, or against true north.

    Parameters
    ----------
    rotation : float
        Azimuth of the mine's grid north in the base grid, or at the origin from true north [rad]:
        base azimuth = mine azimuth + rotation.
    base : str or None
        CRS as EPSG code, PROJ string or WKT; None: true north at the origin.
    e, n : float
        The origin in the mine's grid [m].
    base_e, base_n : float or None
        The origin in the base grid [m].
    latitude, longitude : float or None
        The origin [rad], instead.
    scale : float
        A length in the mine's grid divided by that in the base grid [-].
    rotation_sigma : float
        Standard deviation of the rotation [rad].
    """

    rotation: float
    base: str | None = None
    e: float = 0.0
    n: float = 0.0
    base_e: float | None = None
    base_n: float | None = None
    latitude: float | None = None
    longitude: float | None = None
    scale: float = 1.0
    rotation_sigma: float = 0.0


@dataclass(frozen=True, slots=True)
class StatedConvergence:
    """Meridian convergence as a record prints it, with its standard deviation [rad]."""

    value: float
    sigma: float
