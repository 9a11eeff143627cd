"""Slope distance and zenith angle of one sight to a point without height: a horizontal distance.

s sin z needs no height of any point. Where the network does not deal with the height of an end, the
slope distance itself cannot be used and would be lost; its horizontal projection is an observation
like any other. All distances and zenith angles of a sight enter by their means.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from surveyapp.domain.observations import Observation, ObservationKind
from surveyapp.domain.traverse import Network, Status
from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import said

K = ObservationKind
NOTE = said("horizontal, from slope distance and zenith angle")


def _mean(observations: Sequence[Observation]) -> tuple[float, float]:
    """Weighted mean and its standard deviation."""
    weights = [1.0 / obs.sigma**2 for obs in observations]
    total = sum(weights)
    pairs = zip(weights, observations, strict=True)
    return sum(w * obs.value for w, obs in pairs) / total, 1.0 / math.sqrt(total)


def _level(distances: Sequence[Observation], zeniths: Sequence[Observation]) -> Observation:
    """Horizontal distance of one sight; sigma by propagation of both."""
    slope, slope_sigma = _mean(distances)
    steep, steep_sigma = _mean(zeniths)
    sigma = math.hypot(math.sin(steep) * slope_sigma, slope * math.cos(steep) * steep_sigma)
    return replace(
        distances[0],
        kind=K.DISTANCE,
        value=slope * math.sin(steep),
        sigma=sigma,
        hi=0.0,
        ht=0.0,
        note=NOTE,
    )


def with_level_distances(network: Network) -> tuple[Network, frozenset[int]]:
    """Replace slope distances that lack a height by horizontal distances.

    Parameters
    ----------
    network : Network

    Returns
    -------
    network, places
        Places of the observations that went into them; the first distance of a sight is replaced.
        A network in which nothing of the kind stands is returned as it is.
    """
    flat = {point.name for point in network.points if point.status_h is Status.UNUSED}
    plane = {p.name for p in network.points if p.status_e is not Status.UNUSED}
    correlated = {member for block in network.blocks for member in block.members}
    sights: dict[tuple[str, str], dict[ObservationKind, list[int]]] = {}
    for place, obs in enumerate(network.observations):
        if (
            obs.kind in (K.SLOPE_DISTANCE, K.ZENITH)
            and (obs.at in flat or obs.to in flat)
            and {obs.at, obs.to} <= plane
            and place not in correlated
        ):
            kinds = sights.setdefault((obs.at, obs.to), {K.SLOPE_DISTANCE: [], K.ZENITH: []})
            kinds[obs.kind].append(place)
    observations = list(network.observations)
    used: set[int] = set()
    for kinds in sights.values():
        if not (kinds[K.SLOPE_DISTANCE] and kinds[K.ZENITH]):
            continue
        chosen = [[network.observations[i] for i in places] for places in kinds.values()]
        observations[kinds[K.SLOPE_DISTANCE][0]] = _level(*chosen)
        used |= {*kinds[K.SLOPE_DISTANCE], *kinds[K.ZENITH]}
    if not used:
        return network, frozenset()
    names = [f"{at}-{to}" for (at, to), kinds in sights.items() if used & set(kinds[K.ZENITH])]
    shown = ", ".join(names[:5]) + (
        said(" and {number} more", number=len(names) - 5) if len(names) > 5 else ""
    )
    text = said(
        "no height is known at an end of {shown}: slope distance and zenith angle "
        "of the sight are used as a horizontal distance",
        shown=shown,
    )
    warnings = (*network.warnings, ResultWarning("level_distances", text))
    return replace(network, observations=tuple(observations), warnings=warnings), frozenset(used)
