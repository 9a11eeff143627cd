"""Observations that can be made next at a traverse: angles, gyro sides, constants, distances.

Each is an observation with the sigma that its kind has in the network; its value is not known yet.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from surveyapp.domain.observations import Observation, ObservationKind
from surveyapp.domain.traverse import Network
from surveyapp.languages import said

K = ObservationKind
LENGTHS = (K.DISTANCE, K.SLOPE_DISTANCE)


@dataclass(frozen=True, slots=True)
class Offer:
    """An observation that could be made.

    Parameters
    ----------
    id, text : str
    made : Observation
        With its sigma; the value is not used.
    other : bool
        By another instrument: what belongs to one does not recur.
    reversed : bool
        The sights are turned the other way round.
    """

    id: str
    text: str
    made: Observation
    other: bool = False
    reversed: bool = False


def offers_of(network: Network, gyro_sigma: float | None) -> list[Offer]:
    """Everything that can be observed next.

    Parameters
    ----------
    network : Network
    gyro_sigma : float or None
        Standard deviation of a gyro azimuth of this office [rad], for a traverse without any.
    """
    return [*_angles(network), *_gyros(network, gyro_sigma), *_lengths(network)]


def sides_of(network: Network) -> list[tuple[str, str]]:
    """Every side that was sighted, once."""
    found: dict[frozenset[str], tuple[str, str]] = {}
    for obs in network.observations:
        if obs.kind in (K.ANGLE, K.DIRECTION, K.AZIMUTH, K.GYRO, *LENGTHS) and obs.to:
            found.setdefault(frozenset((obs.at, obs.to)), (obs.at, obs.to))
            if obs.kind is K.ANGLE:
                found.setdefault(frozenset((obs.at, obs.back)), (obs.at, obs.back))
    return list(found.values())


def _angles(network: Network) -> Iterator[Offer]:
    """Every angle again: set up anew, turned the other way round, by another instrument."""
    for made in _turned(network):
        told = {"at": made.at, "back": made.back, "to": made.to}
        yield Offer(
            "repeat_angle",
            said("set up anew at {at} and repeat the angle {back}-{to}", **told),
            made,
        )
        yield Offer(
            "opposite_angle",
            said("repeat the angle {back}-{to} at {at}, turned the other way round", **told),
            made,
            reversed=True,
        )
        yield Offer(
            "other_theodolite",
            said("repeat the angle {back}-{to} at {at} with another instrument", **told),
            made,
            other=True,
        )


def _turned(network: Network) -> list[Observation]:
    """Angles as observed, and those between the sights of a set."""
    found: dict[tuple[str, str, str], Observation] = {}
    sets: dict[tuple[str, str], Observation] = {}
    for obs in network.observations:
        if obs.kind is K.ANGLE:
            found.setdefault((obs.at, obs.back, obs.to), replace(obs, value=0.0))
        elif obs.kind is K.DIRECTION:
            first = sets.setdefault((obs.at, obs.set), obs)
            if first.to != obs.to:
                sigma = math.hypot(first.sigma, obs.sigma)
                angle = Observation(K.ANGLE, obs.at, obs.to, 0.0, sigma, back=first.to)
                found.setdefault((obs.at, first.to, obs.to), replace(angle, note=obs.note))
    return list(found.values())


def _gyros(network: Network, gyro_sigma: float | None) -> Iterator[Offer]:
    """Gyro sides, once more or further ones, and the constant again."""
    own = [obs for obs in network.observations if obs.kind is K.GYRO]
    known = {item.name: item for item in network.constants}
    if own:
        typical = sorted(own, key=lambda obs: obs.sigma)[len(own) // 2]
        constant = known.get(typical.constant)
        apart = math.hypot(typical.sigma, (constant.sigma or 0.0) if constant else 0.0)
    elif gyro_sigma is not None:
        typical, apart = None, gyro_sigma
    else:
        return
    done = {frozenset((obs.at, obs.to)) for obs in own}
    for at, to in sides_of(network):
        told = {"at": at, "to": to}
        again = frozenset((at, to)) in done
        if typical is not None:
            made = Observation(K.GYRO, at, to, 0.0, typical.sigma, constant=typical.constant)
            yield Offer("repeat_gyro" if again else "gyro_side", _of_side(told, again=again), made)
        made = Observation(K.AZIMUTH, at, to, 0.0, apart)
        text = said("observe the side {at}-{to} with another gyro of known constant", **told)
        if typical is None:
            text = said("observe the side {at}-{to} with a gyro of known constant", **told)
        yield Offer("other_gyro" if typical else "gyro_side", text, made, other=True)
    for name in dict.fromkeys(obs.constant for obs in own):
        constant = known.get(name)
        if constant is not None and constant.sigma:
            yield Offer(
                "constant_again",
                said("determine the constant {name} again on the known line", name=name),
                Observation(K.GYRO_CONSTANT, name, "", 0.0, constant.sigma),
            )


def _of_side(told: Mapping[str, str], *, again: bool) -> str:
    if again:
        return said("observe the gyro side {at}-{to} once more", **told)
    return said("observe a further gyro side, {at}-{to}", **told)


def _lengths(network: Network) -> Iterator[Offer]:
    """Every distance again, set up anew, and by another instrument with another prism."""
    found: dict[tuple[str, str], Observation] = {}
    for obs in network.observations:
        if obs.kind in LENGTHS:
            found.setdefault((obs.at, obs.to), replace(obs, value=1.0))
    for (at, to), made in found.items():
        told = {"at": at, "to": to}
        text = said("set up anew at {at} and measure the distance to {to} again", **told)
        yield Offer("repeat_distance", text, made)
        text = said("measure the distance {at}-{to} with another instrument and prism", **told)
        yield Offer("other_distance", text, made, other=True)
