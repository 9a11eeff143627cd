"""Repeated readings of one pointing are one observation.

A distance read again at once has the same centring, the same air and the same prism: five readings
do not know more than one. They enter as their mean with the sigma of one. Rounds of a set-up whose
book says so (``S/R``) have a covariance matrix instead and stay.
"""

from __future__ import annotations

from dataclasses import replace

from surveyapp.domain.observations import CorrelatedBlock, Observation, ObservationKind
from surveyapp.domain.traverse import Network
from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import said

_KINDS = frozenset({ObservationKind.DISTANCE, ObservationKind.SLOPE_DISTANCE})


def one_a_pointing(network: Network) -> tuple[Network, tuple[ResultWarning, ...]]:
    """The network with the readings of each pointing to their mean, and what is told of it."""
    tied = {member for block in network.blocks for member in block.members}
    groups: list[list[int]] = []
    for i, obs in enumerate(network.observations):
        last = groups[-1][-1] if groups else -1
        if groups and not tied & {i, last} and _same(network.observations[last], obs):
            groups[-1].append(i)
        else:
            groups.append([i])
    if len(groups) == len(network.observations):
        return network, ()
    place = {i: k for k, group in enumerate(groups) for i in group}
    blocks = tuple(
        CorrelatedBlock(tuple(place[m] for m in block.members), block.covariance)
        for block in network.blocks
    )
    found = tuple(_mean([network.observations[i] for i in group]) for group in groups)
    many = [group for group in groups if len(group) > 1]
    text = said(
        "{value} readings of distances that follow each other are {size} "
        "pointings: each counts once, with the sigma of one reading",
        value=sum(len(group) for group in many),
        size=len(many),
    )
    changed = replace(network, observations=found, blocks=blocks)
    return changed, (ResultWarning("repeated_pointings", text),)


def _same(a: Observation, b: Observation) -> bool:
    return a.kind in _KINDS and (a.kind, a.at, a.to, a.hi, a.ht) == (b.kind, b.at, b.to, b.hi, b.ht)


def _mean(group: list[Observation]) -> Observation:
    if len(group) == 1:
        return group[0]
    value = sum(obs.value for obs in group) / len(group)
    return replace(group[0], value=value, sigma=max(obs.sigma for obs in group))
