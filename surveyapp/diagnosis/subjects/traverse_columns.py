"""What the effects of a traverse may depend on: columns of its observations.

Lengths, sights turned, walls, temperatures, prisms and instruments that notes tell, gyro sides, and
what a shift of the station, the target or the back sight does to each observation.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from surveyapp.core.network.model import Model
from surveyapp.core.network.observation_equations import linearised
from surveyapp.domain.observations import Observation, ObservationKind
from surveyapp.domain.traverse import Network, Status
from surveyapp_models.arrays import Floats

K = ObservationKind
_LENGTHS = frozenset({K.DISTANCE, K.SLOPE_DISTANCE})
_SIGHTS = frozenset({K.DIRECTION, K.AZIMUTH, K.GYRO})
_WALL = re.compile(r"\bwall\s*[=: ]\s*(left|right)\b", re.IGNORECASE)
_TEMPERATURE = re.compile(r"\btemp(?:erature)?\s*[=:]\s*([+-]?\d+(?:\.\d+)?)", re.IGNORECASE)
_INSTRUMENT = re.compile(r"\binstrument\s*[=:]\s*([\w.-]+)", re.IGNORECASE)
_PRISM = re.compile(r"\bprism\s*[=:]\s*([\w.-]+)", re.IGNORECASE)
ROLES = ("station", "target", "backsight")


@dataclass(frozen=True, slots=True)
class Told:
    """Columns of the observations, each of shape (n,), and names behind their numbers."""

    columns: dict[str, Floats]
    labels: dict[str, dict[float, str]]


def _positions(network: Network, values: Floats) -> dict[str, Floats]:
    places = values[: 3 * len(network.points)].reshape(-1, 3)
    return {point.name: places[i, :2] for i, point in enumerate(network.points)}


def _walls(observations: Sequence[Observation]) -> dict[tuple[str, str], float]:
    """Side of the wall of every sight whose note names it, + right; the other way round -."""
    found: dict[tuple[str, str], float] = {}
    for obs in observations:
        told = _WALL.search(obs.note)
        if told is not None and obs.to:
            side = 1.0 if told.group(1).lower() == "right" else -1.0
            found[obs.at, obs.to] = side
            found.setdefault((obs.to, obs.at), -side)
    return found


def observation_columns(network: Network, model: Model, values: Floats) -> Told:
    """Columns of the observations, each of shape (n,); 0 where the kind has no such thing.

    Lengths are adjusted ones: where the sides are multiples of the unit length of a cyclic error,
    its sine at the observed length is the error of the observation itself, and noise would explain
    noise; what the adjusted length errs is in the unknowns and drops out.

    Parameters
    ----------
    network : Network
    model : Model
        Of the network.
    values : float array
        Adjusted values of all slots.
    """
    rows, n = model.observations, len(model.observations)
    computed, _ = linearised(model, values)
    number = {point.name: float(i) for i, point in enumerate(network.points, start=1)}
    columns = {name: np.zeros(n) for name in ("distance_m", "sights_turned", "wall_length_m")}
    turned: dict[tuple[str, str], int] = {}
    own = own_instrument(rows)
    places, walls = _positions(network, values), _walls(rows)

    def bent(at: str, to: str) -> float:
        side = walls.get((at, to), 0.0)
        return side * float(np.hypot(*(places[to] - places[at]))) if side else 0.0

    for i, obs in enumerate(rows):
        if obs.kind in _LENGTHS:
            columns["distance_m"][i] = computed[i] if own[i] else 0.0
        elif obs.kind is K.ANGLE:
            columns["sights_turned"][i] = float(own[i])
            columns["wall_length_m"][i] = bent(obs.at, obs.to) - bent(obs.at, obs.back)
        elif obs.kind in _SIGHTS:
            columns["wall_length_m"][i] = bent(obs.at, obs.to)
        if obs.kind is K.DIRECTION:
            columns["sights_turned"][i] = float(own[i] * turned.get((obs.at, obs.set), 0))
            turned[obs.at, obs.set] = turned.get((obs.at, obs.set), 0) + 1
    known = np.array([obs.kind is K.GYRO_CONSTANT for obs in rows])
    columns["gyro_side"], columns["gyro_group"] = gyro_sides(model)
    columns["observation"] = np.arange(1.0, n + 1.0)
    columns["own_sigma"] = np.where(known, 0.0, model.sigma)
    columns |= _points(rows, number, network)
    columns |= _shifts(rows, places, computed)
    more, labels = _noted(rows)
    names = {place: name for name, place in number.items()}
    return Told(columns | more, {"station": names, "point": names, **labels})


def own_instrument(rows: Sequence[Observation]) -> list[bool]:
    """Whether an observation is of the instrument that made the most of them.

    A note names another one: ``instrument=B``. What belongs to an instrument is not in it.
    """
    kinds = (*_LENGTHS, K.ANGLE, K.DIRECTION)
    told = [_INSTRUMENT.search(obs.note) for obs in rows]
    names = [match.group(1) if match else "" for match in told]
    counted = Counter(
        name for name, obs in zip(names, rows, strict=True) if obs.kind in kinds
    ).most_common(1)
    return [not counted or name == counted[0][0] for name in names]


def _points(
    rows: Sequence[Observation], number: Mapping[str, float], network: Network
) -> dict[str, Floats]:
    """Number of the station, target and back sight, and whether each is held fixed."""
    fixed = {p.name for p in network.points if p.status_e is Status.FIXED is p.status_n}
    found = {}
    for role, names in zip(ROLES, _names(rows), strict=True):
        found[role] = np.array([number.get(name, 0.0) for name in names])
        found[f"{role}_fixed"] = np.array([float(name in fixed) for name in names])
    return found


def _names(rows: Sequence[Observation]) -> tuple[list[str], list[str], list[str]]:
    return [obs.at for obs in rows], [obs.to for obs in rows], [obs.back for obs in rows]


def _shifts(
    rows: Sequence[Observation], places: Mapping[str, Floats], computed: Floats
) -> dict[str, Floats]:
    """Change of each observation by a shift of its station, target and back sight.

    Azimuth a, length s: da = (cos a de - sin a dn) / s, ds = sin a de + cos a dn at the target, the
    opposite at the station (Ghilani 2010, 14.2 and 15.2); heights and zenith angles are left out.
    """
    found = {
        f"by_{role}_{axis}": np.zeros(len(rows)) for role in ROLES for axis in ("east", "north")
    }

    def add(role: str, i: int, change: Floats) -> None:
        found[f"by_{role}_east"][i] += change[0]
        found[f"by_{role}_north"][i] += change[1]

    for i, obs in enumerate(rows):
        if obs.at not in places or obs.to not in places:
            continue
        gap = places[obs.to] - places[obs.at]
        length = float(np.hypot(*gap))
        if not length > 0.0:
            continue
        if obs.kind in _LENGTHS:
            # of a slope distance its horizontal part
            along = gap / max(length, float(computed[i]))
            add("target", i, along)
            add("station", i, -along)
        elif obs.kind in _SIGHTS or obs.kind is K.ANGLE:
            turn = _turn(gap)
            add("target", i, turn)
            add("station", i, -turn)
            if obs.kind is K.ANGLE and obs.back in places:
                behind = _turn(places[obs.back] - places[obs.at])
                add("backsight", i, -behind)
                add("station", i, behind)
    return found


def _turn(gap: Floats) -> Floats:
    """Change of an azimuth per metre east and north at its target [rad/m]."""
    square = float(gap @ gap)
    return np.array([gap[1], -gap[0]]) / square if square > 0.0 else np.zeros(2)


def _noted(rows: Sequence[Observation]) -> tuple[dict[str, Floats], dict[str, dict[float, str]]]:
    """Temperatures and prisms of distances as their notes tell them: ``temp=12.5``, ``prism=B``.

    A temperature that one distance lacks is NaN there; without any there is no column.
    """
    columns: dict[str, Floats] = {}
    labels: dict[str, dict[float, str]] = {}
    lengths = [obs.kind in _LENGTHS for obs in rows]
    theta = [
        _TEMPERATURE.search(obs.note) if own else None
        for obs, own in zip(rows, lengths, strict=True)
    ]
    if any(theta):
        columns["distance_temperature_c"] = np.array(
            [
                0.0 if not own else float("nan") if told is None else float(told.group(1))
                for told, own in zip(theta, lengths, strict=True)
            ]
        )
    prism = [
        _PRISM.search(obs.note) if own else None for obs, own in zip(rows, lengths, strict=True)
    ]
    if any(prism):
        names = list(
            dict.fromkeys(
                told.group(1) if told else ""
                for told, own in zip(prism, lengths, strict=True)
                if own
            )
        )
        columns["prism"] = np.array(
            [
                0.0 if not own else 1.0 + names.index(told.group(1) if told else "")
                for told, own in zip(prism, lengths, strict=True)
            ]
        )
        labels["prism"] = {1.0 + i: f"prism {name or 'not named'}" for i, name in enumerate(names)}
    return columns, labels


def gyro_sides(model: Model) -> tuple[Floats, Floats]:
    """Number of each gyro side, constants one after the other, and of its constant."""
    side, group = np.zeros(len(model.observations)), np.zeros(len(model.observations))
    count = 0
    for place, name in enumerate(model.constants, start=1):
        for i, obs in enumerate(model.observations):
            if obs.kind is K.GYRO and obs.constant == name:
                count += 1
                side[i], group[i] = count, place
    return side, group
