"""Helmert's variance components: which kind of observation is better or worse than stated.

Source: F. R. Helmert (1907), Ausgleichungsrechnung, 2nd ed., p. 358; iterated in the form of W.
Foerstner (1979), ZfV 104, 149-156, whose fixed point is Helmert's estimate.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from surveyapp.core.network.adjustment import adjust
from surveyapp.domain.adjustment import AdjustedObservation, AdjustmentResult
from surveyapp.domain.traverse import Network
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said

MOST_ITERATIONS = 60
TOLERANCE = 1e-4
"""Relative change of every factor at which the iteration stops: far below its own sigma."""
VANISHING = 0.02
"""A factor below this is on its way to zero: no sigma is stated fifty times too large."""
LEAST_REDUNDANCY = 0.5
"""A group with less redundancy says nothing about its own variance and keeps its factor."""


@dataclass(frozen=True, slots=True)
class VarianceComponent:
    """Factor of the stated sigmas of one group.

    Parameters
    ----------
    group : str
    factor : float
        By which the group's sigmas are to be multiplied.
    sigma : float or None
        Of the factor; None where the group keeps its stated sigmas.
    redundancy : float
    observations : int
    vanishing : bool
        The component goes to zero: nothing can be said of it, the stated sigmas were kept.
    """

    group: str
    factor: float
    sigma: float | None
    redundancy: float
    observations: int
    vanishing: bool = False

    def to_dict(self) -> dict[str, object]:
        """Keys of the JSON."""
        return {
            "group": self.group,
            "factor": self.factor,
            "sigma": self.sigma,
            "redundancy": self.redundancy,
            "observations": self.observations,
            "vanishing": self.vanishing,
        }


def _group(item: AdjustedObservation) -> str:
    return item.group or str(item.kind)


def _scaled(network: Network, factors: dict[str, float]) -> Network:
    """The network with each group's sigmas multiplied by its factor."""
    each = [factors.get(obs.group or str(obs.kind), 1.0) for obs in network.observations]
    observations = tuple(
        replace(obs, sigma=obs.sigma * factor, estimated=None) if factor != 1.0 else obs
        for obs, factor in zip(network.observations, each, strict=True)
    )
    blocks = tuple(
        replace(
            block,
            covariance=tuple(
                tuple(
                    value * each[i] * each[j] for j, value in zip(block.members, row, strict=True)
                )
                for i, row in zip(block.members, block.covariance, strict=True)
            ),
        )
        for block in network.blocks
    )
    return replace(network, observations=observations, blocks=blocks, scaled_by_residuals=False)


def _shares(network: Network, result: AdjustmentResult) -> dict[str, tuple[float, float, int]]:
    """Weighted square sum, redundancy and number of observations of each group."""
    pv: dict[int, float] = {}
    rows = {item.place: item for item in result.observations}
    for block in network.blocks:
        members = [member for member in block.members if member in rows]
        v = np.array([rows[member].residual for member in members])
        index = [block.members.index(member) for member in members]
        covariance = np.asarray(block.covariance)[np.ix_(index, index)]
        pv.update(zip(members, (v * np.linalg.solve(covariance, v)).tolist(), strict=True))
    shares: dict[str, tuple[float, float, int]] = {}
    for item in result.observations:
        if item.place < 0:
            continue
        square = pv.get(item.place, (item.residual / item.sigma) ** 2)
        total, redundancy, count = shares.get(_group(item), (0.0, 0.0, 0))
        shares[_group(item)] = (total + square, redundancy + item.redundancy, count + 1)
    return shares


def variance_components(
    network: Network,
) -> tuple[tuple[VarianceComponent, ...], AdjustmentResult]:
    """Estimate a factor for the sigmas of every group of observations.

    Parameters
    ----------
    network : Network
        Groups are ``Observation.group``, the kind where it is empty.

    Returns
    -------
    components, adjustment
        The adjustment uses the estimated sigmas.

    Raises
    ------
    SurveyError
        If the components do not settle.

    Notes
    -----
    A component that goes to zero (the other groups explain its residuals entirely) keeps its stated
    sigmas, is told by ``vanishing`` and does not hold up the rest.
    """
    factors: dict[str, float] = {}
    vanished: set[str] = set()
    for _ in range(MOST_ITERATIONS):
        scaled = _scaled(network, factors)
        result = adjust(scaled, relative=False)
        shares = _shares(scaled, result)
        change = 0.0
        for group, (squares, redundancy, _) in shares.items():
            if group in vanished or redundancy < LEAST_REDUNDANCY:
                continue
            if squares <= VANISHING**4 * redundancy:  # residuals of rounding only
                vanished.add(group)
                factors.pop(group, None)
                continue
            step = math.sqrt(squares / redundancy)
            factors[group] = factors.get(group, 1.0) * step
            change = max(change, abs(step - 1.0))
            if factors[group] < VANISHING:
                vanished.add(group)
                del factors[group]
                continue
            if not 1e-4 < factors[group] < 1e4:
                raise _unsettled(group, factors[group])
        if change < TOLERANCE:
            components = tuple(
                VarianceComponent(
                    group,
                    factors.get(group, 1.0),
                    factors[group] / math.sqrt(2.0 * redundancy) if group in factors else None,
                    redundancy,
                    count,
                    group in vanished,
                )
                for group, (_, redundancy, count) in shares.items()
            )
            return components, adjust(_scaled(network, factors))
    raise _unsettled(", ".join(factors), max(factors.values(), default=1.0))


def _unsettled(group: str, factor: float) -> SurveyError:
    return SurveyError(
        Problem(
            "The variance components do not settle",
            said("group {group}", group=group),
            said("a factor of {factor:.3g}", factor=factor),
            "factors near 1",
            "Look for gross errors first; join groups with few observations.",
        )
    )
