"""Positions of stations completed through the grid, and the arc-to-chord of a side."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from surveyapp.core.geodesy.grid import Grid
from surveyapp.domain.project import Station
from surveyapp_models.angles import wrap_pi


@dataclass(frozen=True, slots=True)
class Position:
    """Where a station lies, as far as it is known. Angles [rad], lengths [m]."""

    latitude: float | None
    longitude: float | None
    e: float | None
    n: float | None
    h: float | None


def position_of(station: Station, grid: Grid | None) -> Position:
    """Complete the position of a station through the grid, where there is one."""
    at = Position(station.latitude, station.longitude, station.e, station.n, station.h)
    if grid is None:
        return at
    if at.latitude is None or at.longitude is None:
        if at.e is None or at.n is None:
            return at
        latitude, longitude = grid.geographic(e=at.e, n=at.n)
        return replace(at, latitude=latitude, longitude=longitude)
    if at.e is None or at.n is None:
        e, n = grid.projected(latitude=at.latitude, longitude=at.longitude)
        return replace(at, e=e, n=n)
    return at


def arc_to_chord(grid: Grid, start: Position, end: Position) -> float | None:
    """Arc-to-chord T - t at ``start`` [rad], None where a position is missing.

    T is the grid azimuth of the projected geodesic at the start, t that of the chord: T - t =
    geodesic azimuth - convergence - chord. Computed with the exact geodesic, so that it holds for
    every projection; for one that is not conformal it contains the distortion of the azimuth too.
    """
    if start.latitude is None or start.longitude is None or start.e is None or start.n is None:
        return None
    if end.latitude is None or end.longitude is None or end.e is None or end.n is None:
        return None
    if (start.e, start.n) == (end.e, end.n):
        return None
    azimuth, _, _ = grid.geodesic.inv(
        math.degrees(start.longitude),
        math.degrees(start.latitude),
        math.degrees(end.longitude),
        math.degrees(end.latitude),
    )
    chord = math.atan2(end.e - start.e, end.n - start.n)
    gamma = grid.convergence(latitude=start.latitude, longitude=start.longitude)
    return wrap_pi(math.radians(azimuth) - gamma - chord)
