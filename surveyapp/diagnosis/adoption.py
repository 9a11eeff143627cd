"""The adopted effects of a diagnosis, with everything that must be kept to use them later."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from surveyapp.diagnosis.compare import Level
from surveyapp.diagnosis.fits import Member
from surveyapp.diagnosis.loop import Search, margin_of
from surveyapp.diagnosis.problem import Array, Problem
from surveyapp.diagnosis.prove import confirm_rms
from surveyapp.diagnosis.result import Adoption, NamedCoefficient
from surveyapp.diagnosis.value import coefficients, rms
from surveyapp.domain.instrument import AdoptedEffect
from surveyapp_models.effects.effect import Effect


def named_level(found: Search, identity: str) -> Level:
    """Level at which an effect first stood in the best set."""
    for level in found.levels[1:]:
        if level.fits and identity in level.fits[0].key:
            return level
    return found.levels[-1]


def p_values(found: Search, identity: str) -> tuple[float | None, float | None]:
    """P and family p where an effect was tested last with the gate open, else at the first gate."""
    chosen: tuple[float | None, float | None] = (None, None)
    for gate in found.gates:
        for test in gate.tests:
            if test.id == identity and (gate.fired or chosen[0] is None) and test.p is not None:
                chosen = (test.p, test.p_family)
    return chosen


def adoptions(
    problem: Problem, found: Search, digest: str, confirm: Problem | None
) -> tuple[Adoption, ...]:
    """Every effect that the engine names, as it is told and as it is written into a project."""
    if not found.adopted:
        return ()
    numbers = coefficients(problem, found.after)
    proof = None if confirm is None else confirm_rms(confirm, found.after)
    shared = AdoptedEffect(
        id="",
        data_sha256=digest,
        before=rms(problem, found.levels[0].fits[0]) / problem.scale,
        after=rms(problem, found.after) / problem.scale,
        confirm=None if proof is None else proof / problem.scale,
        unit=problem.unit,
    )
    result = []
    for identity in found.adopted:
        members = [m for m in found.after.members if m.candidate.id == identity]
        effect = members[0].candidate.effect
        if effect is None:
            continue
        named, covariance = _coefficients(effect, members, numbers[identity])
        grid = _grid(effect, members)
        record = replace(
            shared,
            id=identity,
            coefficients=tuple((c.name, c.value, c.sigma or 0.0, c.unit) for c in named),
            grid=tuple((name, value) for name, value, _ in grid),
            covariance=covariance,
            valid=_valid(problem, [need.name for need in effect.needs]),
        )
        p_family = p_values(found, identity)[1]
        margin = margin_of(named_level(found, identity), identity)
        result.append(Adoption(identity, effect.title, named, grid, p_family, margin, record))
    return tuple(result)


def _coefficients(
    effect: Effect, members: Sequence[Member], numbers: tuple[Array, Array]
) -> tuple[tuple[NamedCoefficient, ...], tuple[tuple[float, ...], ...]]:
    """Coefficients of an effect and their covariance, in the units that they are told in."""
    values, covariance = numbers
    every = [c for m in members for c in effect.coefficients * m.candidate.count]
    scales = np.array([c.scale for c in every])
    sigmas = np.sqrt(np.maximum(np.diag(covariance), 0.0)) / scales
    named = tuple(
        NamedCoefficient(c.name, float(v / c.scale), float(s), c.unit)
        for c, v, s in zip(every, values, sigmas, strict=True)
    )
    scaled = covariance / np.outer(scales, scales)
    return named, tuple(tuple(float(x) for x in row) for row in scaled)


def _grid(effect: Effect, members: Sequence[Member]) -> tuple[tuple[str, float, str], ...]:
    """Non-linear parameters where the effect was found: name, value, unit."""
    units = {g.name: g.unit for g in effect.grid}
    return tuple(
        (name, value, units.get(name, next(iter(units.values()), "")))
        for m in members
        for name, value in m.point.items()
    )


def _valid(problem: Problem, names: Iterable[str]) -> tuple[tuple[str, float, float], ...]:
    ranges = []
    for name in names:
        values = problem.columns.get(name)
        if values is not None and np.isfinite(values).all():
            ranges.append((name, float(values.min()), float(values.max())))
    return tuple(ranges)
