"""A heading as geometry: sides, levers to the meeting point, walls.

Nothing here knows what is observed; that is ``rows``.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from surveyapp.domain.penetration import Heading, MeetingPoint
from surveyapp.domain.project import Station
from surveyapp_models.arrays import Floats

REACHED_M = 1.0
"""Within this distance the last station is the meeting point (penetration.md section 5)."""


@dataclass(frozen=True, slots=True)
class Route:
    """The sides of a heading.

    Parameters
    ----------
    heading : Heading
    sign : float
        +1 for heading 1, -1 for heading 2: the miss is heading 1 minus heading 2.
    e, n : ndarray, shape (sides + 1,)
        Stations [m].
    azimuth, length : ndarray, shape (sides,)
        [rad], [m].
    carried_m : float
        By how much the last side is carried on to reach the meeting point [m].
    """

    heading: Heading
    sign: float
    e: Floats
    n: Floats
    azimuth: Floats
    length: Floats
    carried_m: float = 0.0

    @property
    def sides(self) -> int:
        """Number of sides."""
        return int(self.length.size)

    @property
    def reach(self) -> Floats:
        """Length over which each side turns what lies ahead: the last one as carried on [m]."""
        reach = self.length.copy()
        reach[-1] += self.carried_m
        return reach

    @property
    def to_right(self) -> Floats:
        """Movement of the end per turn of each side, east and north [m/rad], shape (sides, 2)."""
        reach = self.reach
        return np.column_stack([reach * np.cos(self.azimuth), -reach * np.sin(self.azimuth)])

    @property
    def along(self) -> Floats:
        """Unit vectors of the sides, east and north, shape (sides, 2)."""
        return np.column_stack([np.sin(self.azimuth), np.cos(self.azimuth)])

    def side_of(self, at: str, to: str) -> tuple[int, bool] | None:
        """Number of a side and whether it is looked at forward; None where there is none."""
        for number, (first, second) in enumerate(self.heading.sides):
            if (at, to) == (first, second):
                return number, True
            if (at, to) == (second, first):
                return number, False
        return None


def route_of(
    heading: Heading, stations: Mapping[str, Station], *, sign: float, meeting: MeetingPoint
) -> Route:
    """Geometry of a heading whose stations all have coordinates."""
    e = np.array([stations[name].e for name in heading.route], dtype=np.float64)
    n = np.array([stations[name].n for name in heading.route], dtype=np.float64)
    east, north = np.diff(e), np.diff(n)
    azimuth = np.arctan2(east, north)
    gap = (meeting.e - float(e[-1]), meeting.n - float(n[-1]))
    ahead, _ = ahead_and_beside(gap, float(azimuth[-1]))
    carried = ahead if math.hypot(*gap) > REACHED_M else 0.0
    return Route(heading, sign, e, n, azimuth, np.hypot(east, north), carried)


def ahead_and_beside(gap: tuple[float, float], azimuth: float) -> tuple[float, float]:
    """Components of a vector along an azimuth and to its right [m]."""
    sine, cosine = math.sin(azimuth), math.cos(azimuth)
    return gap[0] * sine + gap[1] * cosine, gap[0] * cosine - gap[1] * sine


def axes(axis_azimuth: float) -> Floats:
    """Unit vectors to the right of the axis and along it, as columns (E, N), shape (2, 2).

    ``axis_azimuth`` [rad].
    """
    sine, cosine = math.sin(axis_azimuth), math.cos(axis_azimuth)
    return np.array([[cosine, sine], [-sine, cosine]])
