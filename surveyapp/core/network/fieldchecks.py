"""Field checks of a traverse as a rule book asks for them: what was measured, without any limit.

Closures by class, repeated traverses, the last angle measured again, gyro sides against the azimuth
that the traverse carries, forward against back, lengths of sides. Limits come from elsewhere.
"""

from __future__ import annotations

import math
from collections import defaultdict, deque
from collections.abc import Sequence
from dataclasses import dataclass

from surveyapp.core.network.sights import Measured as Sight
from surveyapp.core.network.sights import Sighted, sighted
from surveyapp.core.tolerance import Measured
from surveyapp.domain.adjustment import AdjustmentResult, Closure
from surveyapp.domain.observations import Observation, ObservationKind
from surveyapp.domain.subject import Subject
from surveyapp.domain.traverse import Network, Status
from surveyapp.languages import said
from surveyapp_models.angles import RHO_ARCSEC, wrap_pi

K = ObservationKind
NETWORK = Subject.of("traverse", "")
"""A network that has no name of its own: all traverses together, or a file."""


def closure_measures(
    closures: Sequence[Closure], *, class_name: str = "", subject: Subject = NETWORK
) -> list[Measured]:
    """Angular and relative closures of loops and of routes between fixed points.

    Parameters
    ----------
    closures : sequence of Closure
    class_name : str
        The class of the traverse in the rule book's own words.
    subject : Subject
        The traverse.

    Returns
    -------
    list of Measured
        ``angular_closure_closed`` [arcsec] with n angles, ``relative_closure_closed`` as 1 in N;
        a route that closes to the last digit has no ratio and is left out of the second.
    """
    found = []
    for item in closures:
        where = "-".join(item.stations[:4]) + ("-..." if len(item.stations) > 4 else "")
        variables = {"n": float(item.angles)}
        if item.angular is not None:
            value = abs(item.angular) * RHO_ARCSEC
            text = said("{kind}, {angles} angles", kind=item.kind, angles=item.angles)
            found.append(
                Measured(
                    "angular_closure_closed",
                    value,
                    where,
                    text,
                    variables,
                    class_name,
                    subject=subject,
                )
            )
        if item.linear_m and item.length_m:
            text = f"{item.kind}, {item.linear_m:.4f} m in {item.length_m:.1f} m"
            ratio = item.length_m / item.linear_m
            variables = {"n": float(item.angles), "L": item.length_m / 1000.0}
            found.append(
                Measured(
                    "relative_closure_closed",
                    ratio,
                    where,
                    text,
                    variables,
                    class_name,
                    subject=subject,
                )
            )
    return found


def repeated_angles(
    observations: Sequence[Observation], *, class_name: str = "", subject: Subject = NETWORK
) -> list[Measured]:
    """Angles that stand in the book more than once: the last one against the first.

    The check before a traverse is extended: its last angle is measured again.
    """
    first: dict[tuple[str, str, str], Observation] = {}
    last: dict[tuple[str, str, str], Observation] = {}
    for obs in observations:
        if obs.kind is K.ANGLE:
            key = (obs.at, obs.back, obs.to)
            first.setdefault(key, obs)
            last[key] = obs
    return [
        Measured(
            "last_angle_again",
            abs(wrap_pi(last[key].value - obs.value)) * RHO_ARCSEC,
            f"{key[1]}-{key[0]}-{key[2]}",
            said("measured again"),
            {"n": 2.0},
            class_name,
            subject=subject,
        )
        for key, obs in first.items()
        if last[key] is not obs
    ]


def repeated_traverse(
    first: Network, second: Network, *, class_name: str = "", subject: Subject = NETWORK
) -> list[Measured]:
    """An open traverse measured twice: sums of angles and ends of the routes against each other.

    Parameters
    ----------
    first, second : Network
        The two measurements; what both have in common is compared.
    class_name : str

    Returns
    -------
    list of Measured
        ``angular_closure_repeated`` with n angles of both together and
        ``relative_closure_repeated``; empty where the two have no route of two sides in common.
    """
    one, two = sighted(first.observations), sighted(second.observations)
    route = _common_route(one, two)
    if len(route) < 3:
        return []
    corners = [(route[i], route[i - 1], route[i + 1]) for i in range(1, len(route) - 1)]
    turn = sum(wrap_pi(one.angles[c].value - two.angles[c].value) for c in corners)
    where = f"{route[0]}-...-{route[-1]}"
    n = 2 * len(corners)
    measured = [
        Measured(
            "angular_closure_repeated",
            abs(turn) * RHO_ARCSEC,
            where,
            said("{n} angles together", n=n),
            {"n": float(n)},
            class_name,
            subject=subject,
        )
    ]
    gap = abs(_end(one, route) - _end(two, route))
    length = sum(one.lengths[route[i], route[i + 1]].value for i in range(len(route) - 1))
    if gap > 0.0:
        variables = {"n": float(n), "L": length / 1000.0}
        text = f"{gap:.4f} m in {length:.1f} m"
        ratio = length / gap
        measured.append(
            Measured(
                "relative_closure_repeated",
                ratio,
                where,
                text,
                variables,
                class_name,
                subject=subject,
            )
        )
    return measured


def _end(seen: Sighted, route: Sequence[str]) -> complex:
    bearing, at = 0.0, 0j
    for i in range(len(route) - 1):
        if i:
            bearing += math.pi + seen.angles[route[i], route[i - 1], route[i + 1]].value
        length = seen.lengths[route[i], route[i + 1]].value
        at += length * complex(math.sin(bearing), math.cos(bearing))
    return at


def _common_route(one: Sighted, two: Sighted) -> list[str]:
    """Longest chain from an end of the common legs, with an angle of both at every corner."""
    joined: dict[str, list[str]] = defaultdict(list)
    for a, b in one.lengths:
        if (a, b) in two.lengths:
            joined[a].append(b)
    longest: list[str] = []
    for start in (name for name, near in joined.items() if len(near) == 1):
        route = [start, joined[start][0]]
        while True:
            onward = [
                name
                for name in joined[route[-1]]
                if name not in route
                and (route[-1], route[-2], name) in one.angles
                and (route[-1], route[-2], name) in two.angles
            ]
            if not onward:
                break
            route.append(onward[0])
        longest = max(longest, route, key=len)
    return longest


@dataclass(frozen=True, slots=True)
class CarriedAzimuth:
    """A gyro azimuth against the azimuth that the angles carry from another oriented side.

    Parameters
    ----------
    start, end : str
        The sides, ``station-target``.
    difference : float
        Gyro minus carried [rad].
    sigma : float
        Of the difference, constant included only where the two sides do not share it [rad].
    angles : int
        Angles on the way.
    """

    start: str
    end: str
    difference: float
    sigma: float
    angles: int


def _oriented_sides(network: Network) -> dict[tuple[str, str], tuple[Sight, str]]:
    """Azimuth and constant of every oriented side, fixed pairs included, one way."""
    constants = {item.name: item for item in network.constants}
    sides: dict[tuple[str, str], tuple[Sight, str]] = {}
    points = {point.name: point for point in network.points}
    for obs in network.observations:
        if obs.kind is K.AZIMUTH:
            sides[obs.at, obs.to] = (Sight(obs.value, obs.sigma), "")
        elif obs.kind is K.GYRO and constants[obs.constant].sigma is not None:
            value = obs.value + constants[obs.constant].value - obs.convergence
            sides[obs.at, obs.to] = (Sight(value, obs.sigma), obs.constant)
        elif obs.to:
            a, b = points[obs.at], points[obs.to]
            fixed = all(s is Status.FIXED for s in (a.status_e, a.status_n, b.status_e, b.status_n))
            if fixed and None not in (a.e, a.n, b.e, b.n):
                east, north = (b.e or 0.0) - (a.e or 0.0), (b.n or 0.0) - (a.n or 0.0)
                sides.setdefault((obs.at, obs.to), (Sight(math.atan2(east, north), 0.0), ""))
    return sides


def carried_azimuths(network: Network) -> list[CarriedAzimuth]:
    """Compare every gyro side with the next oriented side that angles lead to.

    Parameters
    ----------
    network : Network

    Returns
    -------
    list of CarriedAzimuth
        One for each gyro side that the angles join to an earlier oriented side, over the fewest
        angles.
    """
    seen = sighted(network.observations)
    sides = _oriented_sides(network)
    gyro = [
        (o.at, o.to) for o in network.observations if o.kind is K.GYRO and (o.at, o.to) in sides
    ]
    order = {side: i for i, side in enumerate(sides)}
    turns: dict[tuple[str, str], list[tuple[tuple[str, str], Sight]]] = defaultdict(list)
    for (at, back, to), angle in seen.angles.items():
        turns[back, at].append(((at, to), angle))
    found = []
    for side in dict.fromkeys(gyro):
        earlier = {s for s in sides if order[s] < order[side] and set(s) != set(side)}
        carried = _carry(side, earlier, turns)
        if carried is not None:
            found.append(_compared(network, sides, side, carried))
    return found


def _carry(
    side: tuple[str, str],
    targets: set[tuple[str, str]],
    turns: dict[tuple[str, str], list[tuple[tuple[str, str], Sight]]],
) -> tuple[tuple[str, str], float, float, int] | None:
    """Azimuth of another oriented side minus that of ``side``: side, turn, variance, angles."""
    queue = deque([(side, 0.0, 0.0, 0), ((side[1], side[0]), math.pi, 0.0, 0)])
    seen: set[tuple[str, str]] = set()
    while queue:
        leg, turn, variance, count = queue.popleft()
        if leg in seen:
            continue
        seen.add(leg)
        for direction, extra in ((leg, 0.0), ((leg[1], leg[0]), math.pi)):
            if direction in targets and count:
                return direction, turn + extra, variance, count
        for onward, angle in turns.get(leg, ()):
            total = turn + math.pi + angle.value
            queue.append((onward, total, variance + angle.sigma**2, count + 1))
    return None


def _compared(
    network: Network,
    sides: dict[tuple[str, str], tuple[Sight, str]],
    side: tuple[str, str],
    carried: tuple[tuple[str, str], float, float, int],
) -> CarriedAzimuth:
    start, turn, variance, count = carried
    (mine, own), (other, theirs) = sides[side], sides[start]
    constants = {item.name: item.sigma or 0.0 for item in network.constants}
    variance += mine.sigma**2 + other.sigma**2
    if own != theirs:
        variance += constants.get(own, 0.0) ** 2 + constants.get(theirs, 0.0) ** 2
    difference = wrap_pi(mine.value - (other.value - turn))
    return CarriedAzimuth("-".join(start), "-".join(side), difference, math.sqrt(variance), count)


def gyro_measures(
    network: Network, *, class_name: str = "", subject: Subject = NETWORK
) -> list[Measured]:
    """``gyro_against_traverse`` [arcsec] with n angles for every gyro side that angles reach."""
    return [
        Measured(
            "gyro_against_traverse",
            abs(item.difference) * RHO_ARCSEC,
            item.end,
            said(
                "against {start} over {angles} angles, expected within {sigma:.1f} arcsec "
                "(2 sigma)",
                start=item.start,
                angles=item.angles,
                sigma=2.0 * item.sigma * RHO_ARCSEC,
            ),
            {"n": float(item.angles)},
            class_name,
            subject=subject,
        )
        for item in carried_azimuths(network)
    ]


def ellipse_measures(
    result: AdjustmentResult, *, class_name: str = "", subject: Subject = NETWORK
) -> list[Measured]:
    """``control_ellipse`` [m] of all neighbours, L their distance [km]."""
    places = {point.name: point for point in result.points}
    found = []
    for item in result.relative:
        a, b = places[item.start], places[item.end]
        if a.e is None or a.n is None or b.e is None or b.n is None:
            continue
        length = math.hypot(b.e - a.e, b.n - a.n) / 1000.0
        where = f"{item.start}-{item.end}"
        found.append(
            Measured(
                "control_ellipse",
                item.ellipse.a_m,
                where,
                "",
                {"L": length},
                class_name,
                subject=subject,
            )
        )
    return found


def side_measures(
    network: Network, *, class_name: str = "", subject: Subject = NETWORK
) -> list[Measured]:
    """The shortest and the longest side of a traverse, for the limits of its class [m]."""
    lengths = sighted(network.observations).lengths
    if not lengths:
        return []
    ordered = sorted(lengths.items(), key=lambda item: item[1].value)
    return [
        Measured(
            quantity,
            sight.value,
            "-".join(pair),
            quantity.replace("_", " "),
            {},
            class_name,
            subject=subject,
        )
        for quantity, (pair, sight) in (
            ("shortest_side", ordered[0]),
            ("longest_side", ordered[-1]),
        )
    ]
