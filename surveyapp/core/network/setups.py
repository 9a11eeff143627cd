"""What the rounds of one set-up share: centring and height of the instrument and of each target.

A set ``S/R`` is round R of set-up S. Between its rounds nobody centred anew: the same millimetre is
in all of them, so that ten rounds do not make it smaller. Directions, angles, distances and zenith
angles of a set-up with the traverse's own sigmas get one covariance matrix; a row with a sigma of
its own is taken as it stands.

Source: direction t of length s: d alpha = (cos alpha de - sin alpha dn) / s, an angle is the
difference of two of them; distance: ds =
sin alpha de + cos alpha dn; zenith angle over the slope S: dz = -sin z dh / S (Ghilani, ch. 7).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from surveyapp.domain.observations import CorrelatedBlock, Observation, ObservationKind
from surveyapp.domain.traverse import Network
from surveyapp.domain.traverse_book import Traverse
from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import said
from surveyapp_models.angles import wrap_pi
from surveyapp_models.arrays import Floats

K = ObservationKind
Lengths = Mapping[tuple[str, str], float]
"""Horizontal lengths of sides by their two stations [m]."""
_KINDS = frozenset({K.DIRECTION, K.ANGLE, K.DISTANCE, K.SLOPE_DISTANCE, K.ZENITH})


@dataclass(frozen=True, slots=True)
class _Target:
    """Direction from the instrument in the set-up's first circle [rad], length and zenith angle."""

    azimuth: float | None
    length: float | None
    zenith: float


def setup_of(text: str) -> str:
    """Set-up of a set ``S/R``; empty where the set names none."""
    return text.rpartition("/")[0]


def setup_blocks(
    traverse: Traverse, known: Mapping[int, Observation], lengths: Lengths
) -> tuple[dict[int, Observation], list[tuple[tuple[int, ...], Floats]]]:
    """Observations with the sigma of their heights, and the covariances of each set-up.

    Parameters
    ----------
    traverse : Traverse
    known : mapping
        Observations by the place of their row, centring in their sigma.
    lengths : mapping
        Horizontal lengths of sides by their two stations [m].

    Returns
    -------
    observations, blocks
        Blocks as places of rows and covariances [rad^2, m^2].
    """
    groups: dict[tuple[str, str, float], list[int]] = {}
    for place, obs in known.items():
        row = traverse.rows[place]
        if obs.kind in _KINDS and row.sigma is None and setup_of(row.set):
            groups.setdefault((row.at, setup_of(row.set), row.hi), []).append(place)
    changed = dict(known)
    blocks: list[tuple[tuple[int, ...], Floats]] = []
    shared = traverse.instrument_m, traverse.target_m, *traverse.height_m
    if not any(shared):
        return changed, blocks
    for places in groups.values():
        if len(places) < 2:
            continue
        found = [known[place] for place in places]
        targets = _targets(found, lengths)
        covariance = _covariance(found, targets, shared)
        flat = _covariance(found, targets, (*shared[:2], 0.0, 0.0))  # centring is in sigma already
        own = np.array([obs.sigma**2 for obs in found])
        for i, obs in enumerate(found):
            if obs.kind in (K.ZENITH, K.SLOPE_DISTANCE):
                own[i] += float((covariance - flat)[i, i])
                changed[places[i]] = replace(obs, sigma=math.sqrt(own[i]))
        np.fill_diagonal(covariance, own)
        blocks.append((tuple(places), covariance))
    return changed, blocks


def _targets(found: Sequence[Observation], lengths: Lengths) -> dict[str, _Target]:
    """Where each target of a set-up lies, from its first readings."""
    azimuths: dict[str, float] = {}
    turns: dict[str, float] = {}
    for obs in found:
        if obs.kind is not K.DIRECTION:
            continue
        if obs.set not in turns:
            fellow = next(
                (
                    o
                    for o in found
                    if o.kind is K.DIRECTION and o.set == obs.set and o.to in azimuths
                ),
                None,
            )
            turns[obs.set] = 0.0 if fellow is None else fellow.value - azimuths[fellow.to]
        azimuths.setdefault(obs.to, wrap_pi(obs.value - turns[obs.set]))
    _by_angles(found, azimuths)
    zeniths = {o.to: o.value for o in reversed(found) if o.kind is K.ZENITH}
    at = found[0].at
    return {
        name: _Target(azimuths.get(name), lengths.get((at, name)), zeniths.get(name, math.pi / 2))
        for name in dict.fromkeys(name for obs in found for name in _sighted(obs))
    }


def _sighted(obs: Observation) -> tuple[str, ...]:
    """Targets of an observation, that of the back sight last."""
    return (obs.to, obs.back) if obs.kind is K.ANGLE else (obs.to,)


def _by_angles(found: Sequence[Observation], azimuths: dict[str, float]) -> None:
    """Directions of the targets that angles tie to known ones; where none is, the first begins.

    Of angles that hang together with no other the common frame is unknown: they stay out.
    """
    angles = [obs for obs in found if obs.kind is K.ANGLE]
    if angles and not azimuths:
        azimuths[angles[0].back] = 0.0
    for _ in angles:
        for obs in angles:
            if obs.back in azimuths:
                azimuths.setdefault(obs.to, wrap_pi(azimuths[obs.back] + obs.value))
            elif obs.to in azimuths:
                azimuths[obs.back] = wrap_pi(azimuths[obs.to] - obs.value)


def _effect(obs: Observation, target: _Target) -> tuple[float, float, float]:
    """Change of an observation by a shift of its target east, north [per m] and up."""
    steep = target.zenith
    if obs.kind is K.ZENITH:
        length = target.length
        return 0.0, 0.0, 0.0 if length is None else -(math.sin(steep) ** 2) / length
    if target.azimuth is None:
        return 0.0, 0.0, 0.0
    sin, cos = math.sin(target.azimuth), math.cos(target.azimuth)
    if obs.kind in (K.DIRECTION, K.ANGLE):
        if target.length is None:
            return 0.0, 0.0, 0.0
        return cos / target.length, -sin / target.length, 0.0
    up = math.cos(steep) if obs.kind is K.SLOPE_DISTANCE else 0.0
    return sin, cos, up


def _covariance(
    found: Sequence[Observation], places: Mapping[str, _Target], shared: Sequence[float]
) -> Floats:
    """Covariance of what the rows of one set-up share."""
    instrument, target, instrument_h, target_h = shared
    names = list(places)
    effects = np.zeros((len(found), len(names), 3))
    for i, obs in enumerate(found):
        seen = _sighted(obs)
        if obs.kind is K.ANGLE and any(places[name].azimuth is None for name in seen):
            continue
        for name, sign in zip(seen, (1.0, -1.0), strict=False):
            effects[i, names.index(name)] = sign * np.array(_effect(obs, places[name]))
    common = effects.sum(axis=1) * np.array([instrument, instrument, instrument_h])
    own = (effects * np.array([target, target, target_h])).reshape(len(found), -1)
    return np.asarray(common @ common.T + own @ own.T, dtype=np.float64)


def as_blocks(
    blocks: Sequence[tuple[tuple[int, ...], Floats]], member_of: Mapping[int, int]
) -> list[CorrelatedBlock]:
    """Blocks by the place of their observations in the network."""
    return [
        CorrelatedBlock(
            tuple(member_of[place] for place in places),
            tuple(tuple(row) for row in matrix.tolist()),
        )
        for places, matrix in blocks
    ]


def without_setup_blocks(network: Network) -> tuple[Network, tuple[ResultWarning, ...]]:
    """The network without the covariances of set-ups, for formats that have no words for them."""
    kept = tuple(
        block
        for block in network.blocks
        if not any(network.observations[member].kind in _KINDS for member in block.members)
    )
    if len(kept) == len(network.blocks):
        return network, ()
    text = said(
        "what the rounds of a set-up share (centring, heights) is written as "
        "independent: the sigmas that others adjust from it are smaller than ours"
    )
    return replace(network, blocks=kept), (ResultWarning("correlation_lost", text),)
