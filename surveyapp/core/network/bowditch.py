"""The compass rule (Bowditch) beside least squares, for those who must file it.

Angles take equal shares of the angular misclosure, coordinates shares in proportion to the length
travelled. It has no sigmas and no tests; it is not the program's answer.

Source: N. Bowditch, The Analyst 1 (1808), 88-93; the form used here: C. D. Ghilani, P. R. Wolf
(2012), Elementary Surveying, 13th ed., section 10.7.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from surveyapp.core.network.closures import plane_fixed, route_orientation, routes
from surveyapp.core.network.sights import Sighted, sighted
from surveyapp.domain.traverse import Network, NetworkPoint
from surveyapp_models.angles import RHO_ARCSEC


@dataclass(frozen=True, slots=True)
class CompassResult:
    """A traverse adjusted by the compass rule.

    Parameters
    ----------
    stations : tuple of str
        First and last are the given ends; a loop ends at its first station.
    e, n : tuple of float
        Coordinates [m].
    angular : float or None
        Angular misclosure that was distributed [rad]; None where the end had no known azimuth.
    misclosure_e, misclosure_n : float
        Linear misclosure [m] that was distributed: computed minus given.
    length_m : float
    """

    stations: tuple[str, ...]
    e: tuple[float, ...]
    n: tuple[float, ...]
    angular: float | None
    misclosure_e: float
    misclosure_n: float
    length_m: float

    @property
    def relative_1_in(self) -> float | None:
        """Length over misclosure, None for a perfect closure."""
        gap = math.hypot(self.misclosure_e, self.misclosure_n)
        return self.length_m / gap if gap > 0.0 else None

    def to_dict(self) -> dict[str, object]:
        """Keys of the JSON, angles in arc-seconds."""
        return {
            "points": [
                {"name": name, "e": e, "n": n}
                for name, e, n in zip(self.stations, self.e, self.n, strict=True)
            ],
            "angular_arcsec": None if self.angular is None else self.angular * RHO_ARCSEC,
            "misclosure_e_m": self.misclosure_e,
            "misclosure_n_m": self.misclosure_n,
            "length_m": self.length_m,
            "relative_1_in": self.relative_1_in,
        }


@dataclass(frozen=True, slots=True)
class CompassInput:
    """A traverse as it was measured.

    Parameters
    ----------
    stations : tuple of str
        n stations, the first and last with given coordinates.
    lengths : tuple of float
        n - 1 horizontal lengths [m].
    angles : tuple of float
        Clockwise angles at the 2nd to the last but one station [rad].
    azimuth : float
        Of the first leg [rad].
    closing_turn : float or None
        Angular misclosure to be distributed [rad], None = none is known.
    shares : int
        Angles among which it is distributed.
    start, end : tuple of float
        e, n of the first and the last station [m].
    """

    stations: tuple[str, ...]
    lengths: tuple[float, ...]
    angles: tuple[float, ...]
    azimuth: float
    closing_turn: float | None
    shares: int
    start: tuple[float, float]
    end: tuple[float, float]


def compass_rule(traverse: CompassInput) -> CompassResult:
    """Adjust one traverse by the compass rule.

    Parameters
    ----------
    traverse : CompassInput

    Returns
    -------
    CompassResult
    """
    share = 0.0 if traverse.closing_turn is None else traverse.closing_turn / traverse.shares
    bearing = traverse.azimuth - (share if traverse.shares > len(traverse.angles) else 0.0)
    e, n, travelled = [traverse.start[0]], [traverse.start[1]], [0.0]
    for i, length in enumerate(traverse.lengths):
        if i:
            bearing += math.pi + traverse.angles[i - 1] - share
        e.append(e[-1] + length * math.sin(bearing))
        n.append(n[-1] + length * math.cos(bearing))
        travelled.append(travelled[-1] + length)
    gap_e, gap_n = e[-1] - traverse.end[0], n[-1] - traverse.end[1]
    total = travelled[-1]
    return CompassResult(
        traverse.stations,
        tuple(x - gap_e * s / total for x, s in zip(e, travelled, strict=True)),
        tuple(x - gap_n * s / total for x, s in zip(n, travelled, strict=True)),
        traverse.closing_turn,
        gap_e,
        gap_n,
        total,
    )


def compass_adjust(network: Network) -> tuple[CompassResult, ...]:
    """Adjust every route between fixed points, and every loop from one, by the compass rule.

    Parameters
    ----------
    network : Network

    Returns
    -------
    tuple of CompassResult
        Routes without a known first azimuth, or with an angle missing, are left out.
    """
    seen = sighted(network.observations)
    points = {point.name: point for point in network.points}
    fixed = plane_fixed(network)
    results = []
    for route in routes(seen.neighbours(heights=False), fixed):
        names = _from_fixed(route.stations, fixed, closed=route.closed)
        if names is None:
            continue
        found = _first_azimuth(seen, points, fixed, names)
        if found is None:
            continue
        names, first = found
        start, end = points[names[0]], points[names[-1]]
        corners = [(names[i], names[i - 1], names[i + 1]) for i in range(1, len(names) - 1)]
        if any(corner not in seen.angles for corner in corners):
            continue
        angles = tuple(seen.angles[corner].value for corner in corners)
        last = route_orientation(seen, points, fixed, (names[-1], names[-2]))
        turn = None
        if last is not None:
            carried = first[0] + sum(math.pi + angle for angle in angles) + math.pi
            turn = math.remainder(carried - last[0], 2.0 * math.pi)
        results.append(
            compass_rule(
                CompassInput(
                    tuple(names),
                    tuple(
                        seen.lengths[names[i], names[i + 1]].value for i in range(len(names) - 1)
                    ),
                    angles,
                    first[0],
                    turn,
                    len(angles) + 2,
                    (start.e or 0.0, start.n or 0.0),
                    (end.e or 0.0, end.n or 0.0),
                )
            )
        )
    return tuple(results)


def _first_azimuth(
    seen: Sighted,
    points: dict[str, NetworkPoint],
    fixed: frozenset[str],
    names: list[str],
) -> tuple[list[str], tuple[float, float]] | None:
    """The route begun at the end that has a known azimuth, and that azimuth; None without one."""
    for order in (names, names[::-1]):
        first = route_orientation(seen, points, fixed, (order[0], order[1]))
        if first is not None:
            return order, first
    return None


def _from_fixed(
    stations: Sequence[str], fixed: frozenset[str], *, closed: bool
) -> list[str] | None:
    """Stations from one given point to another; a loop is turned so that it starts at one."""
    if not closed:
        return list(stations)
    first = next((i for i, name in enumerate(stations) if name in fixed), None)
    if first is None:
        return None
    turned = [*stations[first:], *stations[:first]]
    return [*turned, turned[0]]
