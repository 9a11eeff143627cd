"""Starting values of every slot: given coordinates where there are any, else found by itself.

Positions in the plane come from ``sketch``, heights from differences and zenith angles or, failing
those, from spheres; orientations and gyro constants from the positions. Nothing is adjusted here.
"""

from __future__ import annotations

import math
from collections import defaultdict, deque
from collections.abc import Iterable, Iterator

import numpy as np

from surveyapp.core.network.linearise import azimuth
from surveyapp.core.network.model import Model
from surveyapp.core.network.sketch import Pencil, Positions, Sights, sketch_variants
from surveyapp.core.network.spheres import on_spheres
from surveyapp.domain.observations import Observation, ObservationKind
from surveyapp.domain.traverse import Network, NetworkPoint, Status
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said
from surveyapp_models.angles import wrap_pi_array
from surveyapp_models.arrays import Floats

K = ObservationKind


def _horizontal(observations: Iterable[Observation]) -> dict[str, dict[str, float]]:
    """Horizontal distances both ways; slope distances reduced by their zenith angle if there is."""
    zeniths = {
        (obs.at, obs.to): obs.value for obs in observations if obs.kind is ObservationKind.ZENITH
    }
    found: dict[str, dict[str, float]] = {}
    for obs in observations:
        if obs.kind is K.DISTANCE:
            length = obs.value
        elif obs.kind is K.SLOPE_DISTANCE:
            steep = zeniths.get((obs.at, obs.to), zeniths.get((obs.to, obs.at), math.pi / 2.0))
            length = obs.value * abs(math.sin(steep))
            if obs.to in found.get(obs.at, {}):
                continue
        else:
            continue
        found.setdefault(obs.at, {})[obs.to] = length
        found.setdefault(obs.to, {})[obs.at] = length
    return found


def _pencils(network: Network, observations: Iterable[Observation]) -> tuple[Pencil, ...]:
    known = {item.name: item.value for item in network.constants if item.sigma is not None}
    sets: dict[tuple[str, str], dict[str, float]] = defaultdict(dict)
    angles: dict[str, dict[str, dict[str, float]]] = {}
    oriented: dict[str, dict[str, float]] = defaultdict(dict)
    for obs in observations:
        if obs.kind is K.DIRECTION:
            sets[obs.at, obs.set].setdefault(obs.to, obs.value)
        elif obs.kind is K.ANGLE:
            graph = angles.setdefault(obs.at, {})
            graph.setdefault(obs.back, {}).setdefault(obs.to, obs.value)
            graph.setdefault(obs.to, {}).setdefault(obs.back, -obs.value)
        elif obs.kind is K.AZIMUTH:
            oriented[obs.at].setdefault(obs.to, obs.value)
        elif obs.kind is K.GYRO and obs.constant in known:
            grid = obs.value + known[obs.constant] - obs.convergence
            oriented[obs.at].setdefault(obs.to, grid)
    pencils = [Pencil(at, rays, 0.0, absolute=True) for at, rays in oriented.items()]
    pencils += [Pencil(at, rays) for (at, _), rays in sets.items()]
    pencils += [Pencil(at, rays) for at, graph in angles.items() for rays in _joined(graph)]
    return tuple(_shared_orientation(pencils))


def _joined(graph: dict[str, dict[str, float]]) -> list[dict[str, float]]:
    """Angles of one station that hang together, as rays from a common zero."""
    left = dict.fromkeys(graph)
    bundles = []
    while left:
        first = next(iter(left))
        rays = {first: 0.0}
        work = deque([first])
        while work:
            name = work.popleft()
            left.pop(name, None)
            for other, turn in graph[name].items():
                if other not in rays:
                    rays[other] = rays[name] + turn
                    work.append(other)
        bundles.append(rays)
    return bundles


def _shared_orientation(pencils: list[Pencil]) -> list[Pencil]:
    """Orient the sets that share a target with an oriented pencil of their station."""
    oriented = {p.station: p.rays for p in pencils if p.absolute}
    for pencil in pencils:
        rays = oriented.get(pencil.station)
        if rays is None or pencil.absolute:
            continue
        common = next((target for target in pencil.rays if target in rays), None)
        if common is not None:
            pencil.orientation = rays[common] - pencil.rays[common]
    return pencils


def _vectors(observations: Iterable[Observation]) -> dict[str, dict[str, complex]]:
    parts: dict[tuple[str, str], list[float | None]] = defaultdict(lambda: [None, None])
    for obs in observations:
        if obs.kind is K.VECTOR_E:
            parts[obs.at, obs.to][0] = obs.value
        elif obs.kind is K.VECTOR_N:
            parts[obs.at, obs.to][1] = obs.value
    vectors: dict[str, dict[str, complex]] = defaultdict(dict)
    for (at, to), (east, north) in parts.items():
        if east is not None and north is not None:
            vectors[at][to] = complex(east, north)
            vectors[to][at] = -complex(east, north)
    return dict(vectors)


def _observed_coordinates(observations: Iterable[Observation]) -> dict[str, list[float | None]]:
    kinds = {K.COORDINATE_E: 0, K.COORDINATE_N: 1, K.COORDINATE_H: 2}
    found: dict[str, list[float | None]] = defaultdict(lambda: [None, None, None])
    for obs in observations:
        if obs.kind in kinds:
            found[obs.at][kinds[obs.kind]] = obs.value
    return found


def _keeps(status: Status, *, fresh: bool) -> bool:
    """Whether a given value of this status is used as a start."""
    return not fresh or status is not Status.FREE


def _known_plane(
    network: Network, observed: dict[str, list[float | None]], *, fresh: bool
) -> Positions:
    known = {}
    for point in network.points:
        e, n = point.e, point.n
        if e is None or n is None or not _keeps(point.status_e, fresh=fresh):
            e, n = observed[point.name][:2] if point.name in observed else (None, None)
        if e is not None and n is not None:
            known[point.name] = complex(e, n)
    return known


def _needs_plane(point: NetworkPoint) -> bool:
    return Status.FREE in (point.status_e, point.status_n) or Status.CONSTRAINED in (
        point.status_e,
        point.status_n,
    )


def _planes(network: Network, model: Model, *, fresh: bool) -> list[Positions]:
    """Positions in the plane; several where points lie on either side of a line alike."""
    observed = _observed_coordinates(model.observations)
    known = _known_plane(network, observed, fresh=fresh)
    if all(point.name in known for point in network.points if _needs_plane(point)):
        return [known]
    distances = _horizontal(model.observations)
    heights = _heights(network, model, known, distances)
    _reduce_slopes(model.observations, heights, distances)
    sights = Sights(_pencils(network, model.observations), distances, _vectors(model.observations))
    used = {p.station for p in sights.pencils} | {t for p in sights.pencils for t in p.rays}
    used |= set(distances) | set(sights.vectors)
    found = sketch_variants(sights, {name: at for name, at in known.items() if name in used})
    return [{**known, **positions} for positions in found]


def _reduce_slopes(
    observations: Iterable[Observation],
    heights: dict[str, float],
    distances: dict[str, dict[str, float]],
) -> None:
    """Reduce slope distances by heights where no zenith angle has done it."""
    zeniths = {frozenset((o.at, o.to)) for o in observations if o.kind is K.ZENITH}
    level = {frozenset((o.at, o.to)) for o in observations if o.kind is K.DISTANCE}
    for obs in observations:
        pair = frozenset((obs.at, obs.to))
        if obs.kind is not K.SLOPE_DISTANCE or pair in zeniths or pair in level:
            continue
        if obs.at in heights and obs.to in heights:
            rise = heights[obs.to] + obs.ht - heights[obs.at] - obs.hi
            length = math.sqrt(max(obs.value**2 - rise**2, 1e-6))
            distances[obs.at][obs.to] = distances[obs.to][obs.at] = length


def _height_steps(
    observations: Iterable[Observation], plane: Positions, distances: dict[str, dict[str, float]]
) -> dict[str, dict[str, float]]:
    """Height differences between points, both ways."""
    steps: dict[str, dict[str, float]] = {}
    for obs in observations:
        if obs.kind in (K.HEIGHT_DIFFERENCE, K.VECTOR_H):
            rise = obs.value - obs.ht + obs.hi
        elif obs.kind is K.ZENITH and 1e-6 < obs.value < math.pi - 1e-6:
            if obs.at in plane and obs.to in plane:
                length = abs(plane[obs.to] - plane[obs.at])
            else:
                length = distances.get(obs.at, {}).get(obs.to, math.nan)
            rise = length / math.tan(obs.value) + obs.hi - obs.ht
            if math.isnan(rise) or obs.to in steps.get(obs.at, {}):
                continue
        else:
            continue
        steps.setdefault(obs.at, {})[obs.to] = rise
        steps.setdefault(obs.to, {})[obs.at] = -rise
    return steps


def _heights(
    network: Network,
    model: Model,
    plane: Positions,
    distances: dict[str, dict[str, float]],
    *,
    fresh: bool = False,
) -> dict[str, float]:
    observed = _observed_coordinates(model.observations)
    heights: dict[str, float] = {}
    for point in network.points:
        if point.h is not None and _keeps(point.status_h, fresh=fresh):
            heights[point.name] = point.h
        elif point.name in observed and observed[point.name][2] is not None:
            heights[point.name] = float(observed[point.name][2] or 0.0)
    steps = _height_steps(model.observations, plane, distances)
    if not heights and steps:
        heights[next(iter(steps))] = 0.0
    queue = deque(heights)
    while queue:
        name = queue.popleft()
        for other, rise in steps.get(name, {}).items():
            if other not in heights:
                heights[other] = heights[name] + rise
                queue.append(other)
    return heights


def _shared_values(model: Model, values: Floats, network: Network) -> None:
    """Orientations and constants from the positions, medians against gross errors; in place."""
    first = model.coordinate_slots
    given = {item.name: item.value for item in network.constants}
    for i, name in enumerate(model.constants):
        values[first + i] = given.get(name, 0.0)
    known = {item.name for item in network.constants if item.sigma is not None}
    for kind, rows in model.by_kind:
        if kind not in (K.DIRECTION, K.GYRO):
            continue
        slots = model.slots[rows]
        computed = azimuth(values, slots[:, :4], model.constant[rows]).computed
        turns = wrap_pi_array(computed - model.value[rows])
        shared, first_row, group = np.unique(slots[:, 4], return_index=True, return_inverse=True)
        offsets = wrap_pi_array(turns - turns[first_row][group])
        order = np.lexsort((offsets, group))
        counts = np.bincount(group)
        middle = order[np.cumsum(counts) - counts + counts // 2]
        found = turns[first_row] + offsets[middle]
        free = [kind is not K.GYRO or model.constants[s - first] not in known for s in shared]
        values[shared[free]] = found[free]


def approximate(network: Network, model: Model, *, fresh: bool = False) -> Floats:
    """Starting values of all slots: the best of ``approximations``."""
    return next(approximations(network, model, fresh=fresh))


def approximations(network: Network, model: Model, *, fresh: bool = False) -> Iterator[Floats]:
    """Starting values of all slots, the best fitting first.

    Parameters
    ----------
    network : Network
    model : Model
    fresh : bool
        Ignore the given coordinates of free points: they proved too far off.

    Yields
    ------
    float array
        One value a slot; nan only where a slot is not used. Several where the observations so far
        leave a point on either side of a line, or above and below three others.

    Raises
    ------
    SurveyError
        Naming the points that nothing leads to.
    """
    spatial = any(kind is K.SLOPE_DISTANCE for kind, _ in model.by_kind)
    for plane in _planes(network, model, fresh=fresh):
        distances = _horizontal(model.observations)
        heights = _heights(network, model, plane, distances, fresh=fresh)
        for lower in (False, True):
            places, levels, doubtful = plane, heights, False
            if spatial:
                places, levels, doubtful = on_spheres(network, model, plane, heights, lower=lower)
            yield _values(network, model, places, levels)
            if not doubtful:
                break


def _values(network: Network, model: Model, plane: Positions, heights: dict[str, float]) -> Floats:
    values = np.full(len(model.unknown_of) - 1, np.nan)
    for i, point in enumerate(network.points):
        at = plane.get(point.name)
        if at is not None:
            values[3 * i : 3 * i + 2] = (at.real, at.imag)
        values[3 * i + 2] = heights.get(point.name, np.nan)
        for j, (_, given, status) in enumerate(point.components()):
            if given is not None and status is Status.FIXED:
                values[3 * i + j] = given
    _refuse_unplaced(network, model, values)
    _shared_values(model, values, network)
    return values


def _refuse_unplaced(network: Network, model: Model, values: Floats) -> None:
    lost: dict[str, list[str]] = {}
    for slot in model.slot_of[model.slot_of < model.coordinate_slots]:
        if math.isnan(values[slot]):
            name = network.points[slot // 3].name
            lost.setdefault(name, []).append("enh"[slot % 3])
    if not lost:
        return
    placed = sum(1 for point in network.points if point.name not in lost)
    hint = (
        "Are they joined to the rest by enough observations, is a point name mistyped, "
        "or is a fixed point missing?"
    )
    raise SurveyError(
        [
            Problem(
                "No approximate coordinates can be found: nothing determines this point",
                said("point {name}", name=name),
                said(
                    "unknown {names}; {placed} of {size} points placed",
                    names=", ".join(components),
                    placed=placed,
                    size=len(network.points),
                ),
                "observations that determine it",
                hint,
            )
            for name, components in lost.items()
        ]
    )
