"""Angles, lengths and rises between neighbours as they were measured, without any coordinates.

What the closures and the compass rule are computed from. Means of repeated measurements carry the
sigma of the mean.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass

from surveyapp.domain.observations import Observation, ObservationKind
from surveyapp_models.angles import wrap_pi

K = ObservationKind


@dataclass(frozen=True, slots=True)
class Measured:
    """A measured quantity and its standard deviation, [rad] or [m]; length of a rise [m]."""

    value: float
    sigma: float
    length: float | None = None


@dataclass(frozen=True, slots=True)
class Sighted:
    """What was measured between neighbours.

    Parameters
    ----------
    angles : dict
        By (station, from, to): clockwise angle, both orders.
    lengths : dict
        By (point, point): horizontal length, both orders.
    rises : dict
        By (point, point): height difference, both orders; with the length of the levelled section
        or of the sight.
    """

    angles: dict[tuple[str, str, str], Measured]
    lengths: dict[tuple[str, str], Measured]
    rises: dict[tuple[str, str], Measured]

    def neighbours(self, *, heights: bool) -> dict[str, list[str]]:
        """Points joined by a length (or by a rise), in the order in which they were measured."""
        pairs = self.rises if heights else self.lengths
        joined: dict[str, list[str]] = {}
        for start, end in pairs:
            joined.setdefault(start, []).append(end)
        return joined


def _mean(values: list[Measured], *, angular: bool) -> Measured:
    if len(values) == 1:
        return values[0]
    weights = [1.0 / item.sigma**2 for item in values]
    first = values[0].value
    offsets = [wrap_pi(item.value - first) if angular else item.value - first for item in values]
    total = sum(weights)
    shift = sum(w * x for w, x in zip(weights, offsets, strict=True)) / total
    lengths = [item.length for item in values if item.length is not None]
    length = sum(lengths) / len(lengths) if lengths else None
    return Measured(first + shift, 1.0 / math.sqrt(total), length)


def _angles(observations: Iterable[Observation]) -> dict[tuple[str, str, str], list[Measured]]:
    found: dict[tuple[str, str, str], list[Measured]] = defaultdict(list)
    sets: dict[tuple[str, str], list[Observation]] = defaultdict(list)
    for obs in observations:
        if obs.kind is K.ANGLE:
            found[obs.at, obs.back, obs.to].append(Measured(obs.value, obs.sigma))
            found[obs.at, obs.to, obs.back].append(Measured(-obs.value, obs.sigma))
        elif obs.kind is K.DIRECTION:
            sets[obs.at, obs.set].append(obs)
    for (at, _), rays in sets.items():
        if len(rays) > MOST_RAYS:
            continue
        for i, a in enumerate(rays):
            for b in rays[i + 1 :]:
                if a.to != b.to:
                    turn = b.value - a.value
                    sigma = math.hypot(a.sigma, b.sigma)
                    found[at, a.to, b.to].append(Measured(turn, sigma))
                    found[at, b.to, a.to].append(Measured(-turn, sigma))
    return found


MOST_RAYS = 60
"""A set of more rays is no station of a traverse: its pairs are not formed."""


def sighted(observations: Iterable[Observation]) -> Sighted:
    """Collect angles, lengths and rises.

    Parameters
    ----------
    observations : iterable of Observation

    Returns
    -------
    Sighted
    """
    observations = tuple(observations)
    lengths: dict[tuple[str, str], list[Measured]] = defaultdict(list)
    rises: dict[tuple[str, str], list[Measured]] = defaultdict(list)
    zeniths = {(obs.at, obs.to): obs for obs in observations if obs.kind is K.ZENITH}
    for obs in observations:
        if obs.kind is K.DISTANCE:
            lengths[obs.at, obs.to].append(Measured(obs.value, obs.sigma))
        elif obs.kind is K.HEIGHT_DIFFERENCE:
            rises[obs.at, obs.to].append(
                Measured(obs.value - obs.ht + obs.hi, obs.sigma, obs.length_m)
            )
        elif obs.kind is K.SLOPE_DISTANCE and (obs.at, obs.to) in zeniths:
            steep = zeniths[obs.at, obs.to]
            level, up = obs.value * math.sin(steep.value), obs.value * math.cos(steep.value)
            lengths[obs.at, obs.to].append(
                Measured(level, math.hypot(obs.sigma * math.sin(steep.value), up * steep.sigma))
            )
            rises[obs.at, obs.to].append(
                Measured(
                    up + steep.hi - steep.ht,
                    math.hypot(obs.sigma * math.cos(steep.value), level * steep.sigma),
                    level,
                )
            )
    return Sighted(
        {key: _mean(values, angular=True) for key, values in _angles(observations).items()},
        _both_ways(lengths, 1.0),
        _both_ways(rises, -1.0),
    )


def _both_ways(
    found: dict[tuple[str, str], list[Measured]], sign: float
) -> dict[tuple[str, str], Measured]:
    joined: dict[tuple[str, str], list[Measured]] = {}
    for (a, b), values in found.items():
        joined.setdefault((a, b), []).extend(values)
        joined.setdefault((b, a), []).extend(
            Measured(sign * v.value, v.sigma, v.length) for v in values
        )
    return {key: _mean(values, angular=False) for key, values in joined.items()}
