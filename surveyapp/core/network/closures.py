"""Closures before the adjustment: loops, routes between fixed points, height loops.

Raw observations only; a gross error shows here before least squares smears it. The angular
misclosure is distributed equally before the linear one is formed, as a computer of traverses does
it by hand.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

from surveyapp.core.network.sights import Sighted, sighted
from surveyapp.domain.adjustment import SIGMAS, Closure
from surveyapp.domain.observations import Observation, ObservationKind
from surveyapp.domain.traverse import Network, NetworkPoint, Status
from surveyapp_models.angles import wrap_pi

MOST_ROUTES = 500
"""So many closures are formed, the shortest routes first; a dense network has no use for more."""

MOST_SECTIONS = 500
"""So many levelled sections are looked at for a run back."""

_GROUND = ""


@dataclass(frozen=True, slots=True)
class Route:
    """Stations one after the other; ``closed``: the last is joined to the first again."""

    stations: tuple[str, ...]
    closed: bool


def _forest(
    joined: dict[str, list[str]], fixed: frozenset[str]
) -> tuple[dict[str, str], dict[str, int], list[tuple[str, str]]]:
    """Parent and depth of each point, and the legs outside the tree; fixed points are roots."""
    parent: dict[str, str] = {}
    depth: dict[str, int] = {}
    chords: list[tuple[str, str]] = []
    seen: set[tuple[str, str]] = set()
    roots = [name for name in joined if name in fixed]
    for first in (roots, *([name] for name in joined)):
        queue = deque(name for name in first if name not in depth)
        for name in queue:
            depth[name], parent[name] = 0, _GROUND
        while queue:
            name = queue.popleft()
            for other in joined[name]:
                if other not in depth:
                    depth[other], parent[other] = depth[name] + 1, name
                    queue.append(other)
                elif parent[name] != other and parent[other] != name:
                    pair = (min(name, other), max(name, other))
                    if pair not in seen:
                        seen.add(pair)
                        chords.append((name, other))
    return parent, depth, chords


def routes(joined: dict[str, list[str]], fixed: frozenset[str]) -> list[Route]:
    """Loops and routes between fixed points, one for every leg more than a tree needs.

    Parameters
    ----------
    joined : dict
        Neighbours of each point.
    fixed : frozenset of str
        Points whose position is known.

    Returns
    -------
    list of Route
        At most ``MOST_ROUTES``, shortest first.
    """
    parent, depth, chords = _forest(joined, fixed)
    chords = [(a, b) for a, b in chords if not (a in fixed and b in fixed)]
    chords.sort(key=lambda pair: depth[pair[0]] + depth[pair[1]])
    found = []
    for start, end in chords[:MOST_ROUTES]:
        left, right = [start], [end]
        while left[-1] != right[-1] and (parent[left[-1]] or parent[right[-1]]):
            longer = left if depth[left[-1]] >= depth[right[-1]] else right
            longer.append(parent[longer[-1]])
        closed = left[-1] == right[-1]
        stations = left[::-1] + (right[:-1] if closed else right)
        found.append(Route(tuple(stations), closed))
    return found


def _turn(seen: Sighted, at: str, back: str, to: str) -> tuple[float, float] | None:
    angle = seen.angles.get((at, back, to))
    return None if angle is None else (angle.value, angle.sigma**2)


def _loop(route: Route, seen: Sighted) -> Closure | None:
    names = route.stations
    n = len(names)
    if n < 3:
        return None
    turns = [_turn(seen, names[i], names[i - 1], names[(i + 1) % n]) for i in range(n)]
    lengths = [seen.lengths[names[i], names[(i + 1) % n]].value for i in range(n)]
    known = [turn for turn in turns if turn is not None]
    angular = sigma = None
    if len(known) == n:
        angular = wrap_pi(sum(value for value, _ in known) - n * math.pi)
        sigma = math.sqrt(sum(variance for _, variance in known))
    linear = None
    if len(known) == n or (len(known) == n - 1 and turns[0] is None):
        share = 0.0 if angular is None else angular / n
        linear = abs(_walk(turns, lengths, share))
    if angular is None and linear is None:
        return None
    passed = None if angular is None or sigma is None else abs(angular) <= SIGMAS * sigma
    return Closure("loop", names, angular, len(known), sigma, linear, sum(lengths), passed=passed)


def _walk(
    turns: Sequence[tuple[float, float] | None], lengths: Sequence[float], share: float
) -> complex:
    """East + i north of the end of a route that starts northward; turns[i] at its i-th station."""
    bearing, at = 0.0, 0j
    for i, length in enumerate(lengths):
        turn = turns[i]
        if i > 0 and turn is not None:
            bearing += math.pi + turn[0] - share
        at += length * complex(math.sin(bearing), math.cos(bearing))
    return at


def _known_bearing(points: dict[str, NetworkPoint], start: str, end: str) -> float | None:
    a, b = points[start], points[end]
    if a.e is None or a.n is None or b.e is None or b.n is None:
        return None
    return math.atan2(b.e - a.e, b.n - a.n)


def route_orientation(
    seen: Sighted, points: dict[str, NetworkPoint], fixed: frozenset[str], leg: tuple[str, str]
) -> tuple[float, float] | None:
    """Azimuth of a leg out of a fixed point, from a sight to another fixed point."""
    at, to = leg
    for station, back, target in seen.angles:
        if station == at and target == to and back in fixed:
            known = _known_bearing(points, at, back)
            turn = _turn(seen, at, back, to)
            if known is not None and turn is not None:
                return known + turn[0], turn[1]
    return None


def plane_fixed(network: Network) -> frozenset[str]:
    """Points with fixed east and north."""
    return frozenset(
        p.name for p in network.points if p.status_e is Status.FIXED and p.status_n is Status.FIXED
    )


def _connecting(
    route: Route, seen: Sighted, points: dict[str, NetworkPoint], fixed: frozenset[str]
) -> Closure | None:
    names = route.stations
    n = len(names)
    turns = [None] + [_turn(seen, names[i], names[i - 1], names[i + 1]) for i in range(1, n - 1)]
    if any(turn is None for turn in turns[1:]):
        return None
    start = route_orientation(seen, points, fixed, (names[0], names[1]))
    end = route_orientation(seen, points, fixed, (names[-1], names[-2]))
    lengths = [seen.lengths[names[i], names[i + 1]].value for i in range(n - 1)]
    inner = [turn for turn in turns[1:] if turn is not None]
    angular = sigma = None
    if start is not None and end is not None:
        carried = start[0] + sum(math.pi + value for value, _ in inner)
        angular = wrap_pi(carried + math.pi - end[0])
        sigma = math.sqrt(start[1] + end[1] + sum(variance for _, variance in inner))
    share = 0.0 if angular is None else angular / n
    reached = _walk(turns, lengths, share)
    a, b = points[names[0]], points[names[-1]]
    if a.e is None or a.n is None or b.e is None or b.n is None:
        return None
    target = complex(b.e - a.e, b.n - a.n)
    if start is not None:
        bearing = start[0] - share
        reached *= complex(math.cos(bearing), -math.sin(bearing))  # turn clockwise
        linear = abs(reached - target)
    else:
        linear = abs(abs(reached) - abs(target))
    angles = len(inner) + (2 if angular is not None else int(start is not None))
    passed = None if angular is None or sigma is None else abs(angular) <= SIGMAS * sigma
    return Closure("connecting", names, angular, angles, sigma, linear, sum(lengths), passed=passed)


def _height(route: Route, seen: Sighted, points: dict[str, NetworkPoint]) -> Closure | None:
    names = route.stations
    ends = (*names, names[0]) if route.closed else names
    steps = [seen.rises[ends[i], ends[i + 1]] for i in range(len(ends) - 1)]
    total = sum(step.value for step in steps)
    if not route.closed:
        a, b = points[names[0]].h, points[names[-1]].h
        if a is None or b is None:
            return None
        total -= b - a
    elif len(names) < 3:
        return None
    sigma = math.sqrt(sum(step.sigma**2 for step in steps))
    known = [step.length for step in steps if step.length is not None]
    return Closure(
        "height",
        names,
        length_m=sum(known) if len(known) == len(steps) else None,
        height_m=total,
        height_sigma_m=sigma,
        passed=abs(total) <= SIGMAS * sigma,
    )


def _there_and_back(observations: Sequence[Observation]) -> list[Closure]:
    """Sections levelled in both directions: forth plus back, over the length of both runs."""
    runs: dict[tuple[str, str], list[Observation]] = {}
    for obs in observations:
        if obs.kind is ObservationKind.HEIGHT_DIFFERENCE:
            runs.setdefault((obs.at, obs.to), []).append(obs)
    found: list[Closure] = []
    for (a, b), forth in list(runs.items())[:MOST_SECTIONS]:
        back = runs.get((b, a))
        if back is None or any(item.stations == (b, a, b) for item in found):
            continue
        both = (forth, back)
        total = sum(sum(o.value - o.ht + o.hi for o in run) / len(run) for run in both)
        sigma = math.hypot(*(math.hypot(*(o.sigma for o in run)) / len(run) for run in both))
        lengths = [o.length_m for o in (forth[0], back[0]) if o.length_m is not None]
        found.append(
            Closure(
                "height",
                (a, b, a),
                length_m=sum(lengths) if len(lengths) == len(both) else None,
                height_m=total,
                height_sigma_m=sigma,
                passed=abs(total) <= SIGMAS * sigma,
            )
        )
    return found


def network_closures(network: Network) -> tuple[Closure, ...]:
    """All closures that the observations of a network allow.

    Parameters
    ----------
    network : Network

    Returns
    -------
    tuple of Closure
        Loops and connecting routes (angular, linear), then height routes and sections levelled in
        both directions. A loop's misclosures
        need every angle; a connecting route's angular one needs a fixed back sight at both ends.
    """
    seen = sighted(network.observations)
    points = {point.name: point for point in network.points}
    plane = plane_fixed(network)
    level = frozenset(p.name for p in network.points if p.status_h is Status.FIXED)
    found = [
        _loop(route, seen) if route.closed else _connecting(route, seen, points, plane)
        for route in routes(seen.neighbours(heights=False), plane)
    ]
    found += [
        _height(route, seen, points) for route in routes(seen.neighbours(heights=True), level)
    ]
    return tuple(item for item in found if item is not None) + tuple(
        _there_and_back(network.observations)
    )
