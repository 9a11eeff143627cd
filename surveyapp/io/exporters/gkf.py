"""A network as GNU Gama's XML (.gkf).

Writes axes and direction of angles as the network's source had them, so that what was read comes
back. What the format cannot say is refused, not left out: gyro sides are written as azimuths with
the variance of their shared constant, which is the same adjustment.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from xml.sax.saxutils import escape, quoteattr

import numpy as np

from surveyapp.domain.observations import CorrelatedBlock, Observation, ObservationKind
from surveyapp.domain.traverse import Network, NetworkPoint, Status
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.importers.gkf_document import CC, GON, KINDS, MM, NEVER_MM, Axes
from surveyapp.io.tomltext import atomic_write
from surveyapp.languages import said

ELEMENTS = {kind: name for name, kind in KINDS.items()}
K = ObservationKind
_TURNING = (K.DIRECTION, K.ANGLE, K.AZIMUTH)
_ANGULAR = (*_TURNING, K.ZENITH)
_COORDINATES = (K.COORDINATE_E, K.COORDINATE_N, K.COORDINATE_H)
_VECTORS = (K.VECTOR_E, K.VECTOR_N, K.VECTOR_H)


@dataclass(frozen=True, slots=True)
class _Cluster:
    """Observations that stand in one element, with their covariances if any."""

    element: str
    station: str
    members: tuple[int, ...]
    covariance: np.ndarray | None


def write_gkf(network: Network, path: Path | str) -> None:
    """Write a network to a .gkf file.

    Raises
    ------
    SurveyError
        If the format has no words for something, or the file cannot be written.
    """
    atomic_write(Path(path), gkf_text(network).encode("utf-8"))


def gkf_text(network: Network) -> str:
    """Text of the .gkf file of a network.

    Parameters
    ----------
    network : Network

    Returns
    -------
    str

    Raises
    ------
    SurveyError
        If the format has no words for something.
    """
    network = _with_azimuths(network)
    axes = Axes(network.axes, network.left_handed)
    limit = NEVER_MM if network.tolerance_m is None else network.tolerance_m / MM
    tolerance = f' tol-abs="{limit!r}"'
    hand = "left-handed" if network.left_handed else "right-handed"
    actual = "aposteriori" if network.scaled_by_residuals else "apriori"
    lines = [
        '<?xml version="1.0" encoding="utf-8"?>',
        '<gama-local xmlns="http://www.gnu.org/software/gama/gama-local">',
        f'<network axes-xy="{network.axes}" angles="{hand}">',
        f"<description>{escape(network.description)}</description>",
        f'<parameters sigma-apr="{network.sigma_apriori!r}" conf-pr="{network.confidence!r}"'
        f'{tolerance} sigma-act="{actual}"/>',
        "<points-observations>",
    ]
    lines += [_point(point, axes) for point in network.points]
    for cluster in _clusters(network):
        lines += _cluster_lines(network, cluster, axes)
    lines += ["</points-observations>", "</network>", "</gama-local>", ""]
    return "\n".join(lines)


def _with_azimuths(network: Network) -> Network:
    """Gyro sides as azimuths: their constant is eliminated, its variance stays."""
    sides = [i for i, obs in enumerate(network.observations) if obs.kind is K.GYRO]
    if not sides:
        return network
    covariance, blocks = _covariance_of_sides(network, sides)
    constants = {item.name: item for item in network.constants}
    observations = list(network.observations)
    for row, i in enumerate(sides):
        obs = observations[i]
        observations[i] = replace(
            obs,
            kind=K.AZIMUTH,
            value=obs.value + constants[obs.constant].value - obs.convergence,
            sigma=math.sqrt(float(covariance[row, row])),
            constant="",
            convergence=0.0,
        )
    if np.count_nonzero(covariance) > len(sides):
        rows = tuple(tuple(row) for row in covariance.tolist())
        blocks.append(CorrelatedBlock(tuple(sides), rows))
    return replace(network, observations=tuple(observations), blocks=tuple(blocks), constants=())


def _covariance_of_sides(
    network: Network, sides: Sequence[int]
) -> tuple[np.ndarray, list[CorrelatedBlock]]:
    """Covariance of the gyro sides, what they share included, and the blocks of the others."""
    names = [network.observations[i].constant for i in sides]
    constants = {item.name: item for item in network.constants}
    problems = [
        Problem(
            "A .gkf file cannot hold an instrument constant that the network is to find",
            said("constant {name}", name=name),
            "no standard deviation",
            "a constant known beforehand",
        )
        for name in dict.fromkeys(names)
        if constants[name].sigma is None
    ]
    places = {place: i for i, place in enumerate(sides)}
    covariance = np.diag([network.observations[i].sigma ** 2 for i in sides])
    others = []
    for block in network.blocks:
        inside = [member in places for member in block.members]
        if not any(inside):
            others.append(block)
        elif all(inside):
            index = [places[member] for member in block.members]
            covariance[np.ix_(index, index)] = np.asarray(block.covariance)
        else:
            problems.append(
                Problem("A .gkf file cannot correlate gyro sides with others", "covariances")
            )
    if problems:
        raise SurveyError(problems)
    same = np.array([[a == b for b in names] for a in names], dtype=np.float64)
    shared = np.array([constants[name].sigma or 0.0 for name in names])
    return covariance + same * np.outer(shared, shared), others


def _point(point: NetworkPoint, axes: Axes) -> str:
    plane = {"e": point.e, "n": point.n}
    parts = [f"<point id={quoteattr(point.name)}"]
    for axis, key in enumerate("xy"):
        component, sign = axes.component(axis)
        value = plane[component]
        if value is not None:
            parts.append(f'{key}="{sign * value!r}"')
    if point.h is not None:
        parts.append(f'z="{point.h!r}"')
    if point.status_e is not point.status_n:
        raise SurveyError(
            Problem(
                "A .gkf file cannot treat east and north differently",
                said("point {name}", name=point.name),
                f"e {point.status_e}, n {point.status_n}",
                "one status for both",
            )
        )
    words = {Status.FIXED: ("fix", str.lower), Status.FREE: ("adj", str.lower)}
    words[Status.CONSTRAINED] = ("adj", str.upper)
    found = {"fix": "", "adj": ""}
    for letters, status in (("xy", point.status_e), ("z", point.status_h)):
        if status in words:
            key, case = words[status]
            found[key] += case(letters)
    parts += [f'{key}="{value}"' for key, value in found.items() if value]
    return " ".join(parts) + "/>"


def _element(obs: Observation) -> str:
    if obs.kind in _COORDINATES:
        return "coordinates"
    if obs.kind in _VECTORS:
        return "vectors"
    return "height-differences" if obs.kind is K.HEIGHT_DIFFERENCE else "obs"


def _clusters(network: Network) -> list[_Cluster]:
    """Blocks, sets of directions and the rest, in the order of their first observation."""
    observations = network.observations
    block_of = {member: i for i, block in enumerate(network.blocks) for member in block.members}
    gathered: dict[tuple[object, ...], list[int]] = {}
    for i, obs in enumerate(observations):
        if i in block_of:
            key: tuple[object, ...] = ("block", block_of[i])
        elif obs.kind is K.DIRECTION:
            key = ("set", obs.at, obs.set)
        else:
            element = _element(obs)
            key = (element, obs.at if element == "obs" else "")
        gathered.setdefault(key, []).append(i)
    _check_sets(network, gathered)
    clusters = []
    for key, members in gathered.items():
        first = observations[members[0]]
        covariance = None
        if key[0] == "block":
            block = network.blocks[block_of[members[0]]]
            members = list(block.members)
            covariance = np.asarray(block.covariance)
        element = _element(observations[members[0]])
        clusters.append(_Cluster(element, first.at, tuple(members), covariance))
    return clusters


def _check_sets(network: Network, gathered: dict[tuple[object, ...], list[int]]) -> None:
    problems = []
    homes: dict[tuple[str, str], set[tuple[object, ...]]] = {}
    for key, members in gathered.items():
        kinds = {_element(network.observations[i]) for i in members}
        sets = {
            (network.observations[i].at, network.observations[i].set)
            for i in members
            if network.observations[i].kind is K.DIRECTION
        }
        for item in sets:
            homes.setdefault(item, set()).add(key)
        if len(kinds) > 1 or len(sets) > 1:
            where = network.observations[members[0]].where
            problems.append(
                Problem(
                    "A .gkf file cannot correlate these observations",
                    where,
                    ", ".join(sorted(kinds)),
                    "",
                )
            )
    text = "A .gkf file needs one covariance matrix for a whole set"
    problems += [
        Problem(text, said("station {at}", at=at), name)
        for (at, name), keys in homes.items()
        if len(keys) > 1
    ]
    if problems:
        raise SurveyError(problems)


def _cluster_lines(network: Network, cluster: _Cluster, axes: Axes) -> list[str]:
    members = [network.observations[i] for i in cluster.members]
    if cluster.element == "vectors":
        return _wrapped(cluster, _vector_lines(members, axes), members, axes)
    if cluster.element == "coordinates":
        return _wrapped(cluster, _coordinate_lines(members, axes), members, axes)
    bare = cluster.covariance is not None
    rows = [_observation(obs, axes, bare=bare, station=cluster.station) for obs in members]
    return _wrapped(cluster, rows, members, axes)


def _wrapped(
    cluster: _Cluster, rows: list[str], members: Sequence[Observation], axes: Axes
) -> list[str]:
    covariance = cluster.covariance
    if covariance is None and cluster.element in ("vectors", "coordinates"):
        covariance = np.diag([obs.sigma**2 for obs in members])
    opening = f"<{cluster.element}>"
    if cluster.element == "obs":
        opening = f"<obs from={quoteattr(cluster.station)}>"
    elif cluster.element == "coordinates" and members[0].extern:
        opening = f"<coordinates extern={quoteattr(members[0].extern)}>"
    lines = [opening, *rows]
    if covariance is not None:
        units = np.array([_unit(obs, axes) for obs in members])
        if cluster.element in ("vectors", "coordinates"):
            order = _source_order(members, axes)
            covariance, units = covariance[np.ix_(order, order)], units[order]
        lines += _covariance_lines(covariance / np.outer(units, units))
    return [*lines, f"</{cluster.element}>"]


def _unit(obs: Observation, axes: Axes) -> float:
    """Unit of a standard deviation with the sign of the value's conversion."""
    if obs.kind in _ANGULAR:
        return CC * (axes.turn if obs.kind in _TURNING else 1.0)
    return MM * _axis(obs, axes)[1]


def _axis(obs: Observation, axes: Axes) -> tuple[int, float]:
    """Axis x, y or z (0, 1, 2) and sign of a coordinate or vector component."""
    letter = {K.COORDINATE_E: "e", K.VECTOR_E: "e", K.COORDINATE_N: "n", K.VECTOR_N: "n"}
    if obs.kind not in letter:
        return 2, 1.0
    for axis in (0, 1):
        component, sign = axes.component(axis)
        if component == letter[obs.kind]:
            return axis, sign
    return 2, 1.0


def _groups(members: Sequence[Observation]) -> list[list[int]]:
    """Consecutive components of one point or vector."""
    groups: list[list[int]] = []
    for i, obs in enumerate(members):
        last = members[groups[-1][-1]] if groups else None
        kinds = [members[j].kind for j in groups[-1]] if groups else []
        if last is None or (last.at, last.to) != (obs.at, obs.to) or obs.kind in kinds:
            groups.append([])
        groups[-1].append(i)
    return groups


def _source_order(members: Sequence[Observation], axes: Axes) -> list[int]:
    return [
        i
        for group in _groups(members)
        for i in sorted(group, key=lambda j: _axis(members[j], axes)[0])
    ]


def _vector_lines(members: Sequence[Observation], axes: Axes) -> list[str]:
    lines = []
    for group in _groups(members):
        first = members[group[0]]
        found = {_axis(members[i], axes)[0]: members[i] for i in group}
        if len(found) != 3:
            raise SurveyError(
                Problem("A .gkf file needs all components of a vector", first.where, "", "three")
            )
        values = " ".join(
            f'd{"xyz"[axis]}="{_axis(found[axis], axes)[1] * found[axis].value!r}"'
            for axis in range(3)
        )
        ends = f"from={quoteattr(first.at)} to={quoteattr(first.to)}"
        lines.append(f"<vec {ends} {values}{_heights(found[2])}{_extern(first)}/>")
    return lines


def _coordinate_lines(members: Sequence[Observation], axes: Axes) -> list[str]:
    lines = []
    for group in _groups(members):
        values = " ".join(
            f'{"xyz"[axis]}="{sign * members[i].value!r}"'
            for i in group
            for axis, sign in (_axis(members[i], axes),)
        )
        lines.append(f"<point id={quoteattr(members[group[0]].at)} {values}/>")
    return lines


def _heights(obs: Observation) -> str:
    text = f' from_dh="{obs.hi!r}"' if obs.hi else ""
    return text + (f' to_dh="{obs.ht!r}"' if obs.ht else "")


def _extern(obs: Observation) -> str:
    return f" extern={quoteattr(obs.extern)}" if obs.extern else ""


def _observation(obs: Observation, axes: Axes, *, bare: bool, station: str) -> str:
    name = ELEMENTS.get(obs.kind)
    if name is None:
        raise SurveyError(Problem("A .gkf file has no such observation", obs.where, str(obs.kind)))
    if obs.kind in _ANGULAR:
        turn = axes.turn if obs.kind in _TURNING else 1.0
        value, sigma = math.fmod(turn * obs.value / GON, 400.0), obs.sigma / CC
        value += 400.0 if value < 0.0 else 0.0
    else:
        value, sigma = obs.value, obs.sigma / MM
    ends = f" to={quoteattr(obs.to)}"
    if obs.kind is K.ANGLE:
        ends = f" bs={quoteattr(obs.back)} fs={quoteattr(obs.to)}"
    if obs.kind is not K.DIRECTION and (obs.at != station or obs.kind is K.HEIGHT_DIFFERENCE):
        ends = f" from={quoteattr(obs.at)}" + ends
    spread = "" if bare else f' stdev="{sigma!r}"'
    heights = "" if obs.kind is K.HEIGHT_DIFFERENCE else _heights(obs)
    if obs.length_m is not None:
        spread += f' dist="{obs.length_m / 1000.0!r}"'
    if obs.kind is K.ANGLE:
        heights = heights.replace("to_dh", "fs_dh")
    return f'<{name}{ends} val="{value!r}"{spread}{heights}{_extern(obs)}/>'


def _covariance_lines(matrix: np.ndarray) -> Iterable[str]:
    size = len(matrix)
    rows, columns = np.nonzero(matrix)
    band = int(np.abs(rows - columns).max(initial=0))
    lines = [f'<cov-mat dim="{size}" band="{band}">']
    lines += [
        " ".join(repr(float(x)) for x in matrix[i, i : min(i + band + 1, size)])
        for i in range(size)
    ]
    return [*lines, "</cov-mat>"]
