"""The adopted effects of a diagnosis, with everything that must be kept to use them later."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from surveyapp.diagnosis.compare import Level
from surveyapp.diagnosis.loop import Search, margin_of
from surveyapp.diagnosis.problem import Problem
from surveyapp.diagnosis.prove import confirm_rms
from surveyapp.diagnosis.result import Adoption, NamedCoefficient
from surveyapp.diagnosis.value import coefficients, rms
from surveyapp.domain.instrument import AdoptedEffect


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
    base = found.levels[0].fits[0]
    numbers = coefficients(problem, found.after)
    before, after = rms(problem, base), rms(problem, found.after)
    proof = None if confirm is None else confirm_rms(confirm, found.after)
    result = []
    for identity in found.adopted:
        members = [m for m in found.after.members if m.candidate.id == identity]
        effect = members[0].candidate.effect
        if effect is None:
            continue
        values, covariance = numbers[identity]
        every = [c for m in members for c in effect.coefficients * m.candidate.count]
        scales = np.array([c.scale for c in every])
        sigmas = np.sqrt(np.maximum(np.diag(covariance), 0.0)) / scales
        named = tuple(
            NamedCoefficient(c.name, float(v / c.scale), float(s), c.unit)
            for c, v, s in zip(every, values, sigmas, strict=True)
        )
        units = {g.name: g.unit for g in effect.grid}
        grid = tuple(
            (name, value, units.get(name, next(iter(units.values()), "")))
            for m in members
            for name, value in m.point.items()
        )
        scaled = covariance / np.outer(scales, scales)
        record = AdoptedEffect(
            id=identity,
            coefficients=tuple((c.name, c.value, c.sigma or 0.0, c.unit) for c in named),
            grid=tuple((name, value) for name, value, _ in grid),
            covariance=tuple(tuple(float(x) for x in row) for row in scaled),
            valid=_valid(problem, [need.name for need in effect.needs]),
            data_sha256=digest,
            before=before / problem.scale,
            after=after / problem.scale,
            confirm=None if proof is None else proof / problem.scale,
            unit=problem.unit,
        )
        level = named_level(found, identity)
        result.append(
            Adoption(
                identity,
                effect.title,
                named,
                grid,
                p_values(found, identity)[1],
                margin_of(level, identity),
                record,
            )
        )
    return tuple(result)


def _valid(problem: Problem, names: Iterable[str]) -> tuple[tuple[str, float, float], ...]:
    ranges = []
    for name in names:
        values = problem.columns.get(name)
        if values is not None and np.isfinite(values).all():
            ranges.append((name, float(values.min()), float(values.max())))
    return tuple(ranges)
