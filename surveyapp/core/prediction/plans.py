"""Which members there are: causes by themselves and two at a time, with their priors.

Source: prediction.md A.2, A.5 and A.9.
"""

from __future__ import annotations

from dataclasses import dataclass

from surveyapp.core.prediction.kernels import PAIRED, Kernel
from surveyapp.domain.priors import AMPLITUDES, PAIR_AMPLITUDES, PAIRS, Priors

ALIKE = frozenset({("temperature", "curve")})
"""Pairs that would be one cause twice."""


@dataclass(frozen=True, slots=True)
class Plan:
    """A member to be factored: its unit, prior and size, and (kernel, variance) of its causes."""

    unit: str
    prior: float
    size: int
    causes: tuple[tuple[int, float], ...]


def singles(found: tuple[Kernel, ...], priors: Priors) -> list[Plan]:
    """Every cause by itself in every size; the shapes of a unit share its prior."""
    total: dict[str, float] = {}
    for kernel in found:
        total[kernel.unit] = total.get(kernel.unit, 0.0) + kernel.share
    return [
        Plan(
            kernel.unit,
            priors.share(kernel.unit) * size * kernel.share / total[kernel.unit],
            k,
            ((place, a * a),),
        )
        for place, kernel in enumerate(found)
        for k, (a, size) in enumerate(zip(AMPLITUDES, priors.sizes, strict=True))
        if priors.share(kernel.unit) * size > 0.0
    ]


def pairs(found: tuple[Kernel, ...], priors: Priors) -> list[Plan]:
    """Two causes at once; all pairs of units share their prior equally."""
    by_pair: dict[tuple[str, str], list[tuple[int, int]]] = {}
    usable = [i for i, k in enumerate(found) if k.unit in PAIRED and priors.share(k.unit) > 0.0]
    for i in usable:
        for j in usable:
            pair = (found[i].unit, found[j].unit)
            if i < j and pair[0] != pair[1] and pair not in ALIKE and pair[::-1] not in ALIKE:
                by_pair.setdefault(min(pair, pair[::-1]), []).append((i, j))
    share = priors.share(PAIRS)
    if not by_pair or share <= 0.0:
        return []
    each = share / len(by_pair) / len(PAIR_AMPLITUDES) ** 2
    total = {
        pair: sum(found[i].share * found[j].share for i, j in shapes)
        for pair, shapes in by_pair.items()
    }
    return [
        Plan(
            PAIRS,
            each * found[i].share * found[j].share / total[pair],
            -1,
            ((i, a * a), (j, b * b)),
        )
        for pair, shapes in by_pair.items()
        for i, j in shapes
        for a in PAIR_AMPLITUDES
        for b in PAIR_AMPLITUDES
    ]
