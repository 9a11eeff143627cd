"""The adopted effects of a diagnosis, with everything that must be kept to use them later."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from surveyapp.core.checks.adopted_checks import numbered
from surveyapp.core.orientation.campaign_columns import LABELLED
from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.compare import Level
from surveyapp.diagnosis.fits import Member
from surveyapp.diagnosis.held_out import confirm_rms
from surveyapp.diagnosis.loop import Search, margin_of
from surveyapp.diagnosis.result import Adoption, NamedCoefficient
from surveyapp.diagnosis.run_value import coefficients, rms
from surveyapp.domain.instrument import AdoptedEffect
from surveyapp_models.arrays import Floats
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
    problem: Case, found: Search, digest: str, confirm: Case | None
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
            coefficients=_numbered(effect, named),
            grid=_places(effect, members),
            covariance=covariance,
            valid=_valid(problem, effect, members[0].point),
            reference=_reference(problem, effect, members[0].point),
            time=_time(problem, effect),
        )
        p_family = p_values(found, identity)[1]
        margin = margin_of(named_level(found, identity), identity)
        result.append(Adoption(identity, effect.title, named, grid, p_family, margin, record))
    return tuple(result)


def _coefficients(
    effect: Effect, members: Sequence[Member], numbers: tuple[Floats, Floats]
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


def _places(effect: Effect, members: Sequence[Member]) -> tuple[tuple[str, float], ...]:
    """Non-linear parameters of every occurrence, under names that differ like the coefficients."""
    names = [g.name for g in effect.grid]
    values = [
        member.point[name if member.candidate.count == 1 else f"{name}_{k + 1}"]
        for member in members
        for k in range(member.candidate.count)
        for name in names
    ]
    count = sum(member.candidate.count for member in members)
    return tuple(zip(numbered(names, count), values, strict=True))


def _numbered(
    effect: Effect, named: Sequence[NamedCoefficient]
) -> tuple[tuple[str, float, float, str], ...]:
    """Coefficients under names that differ: two gross errors are ``error_1`` and ``error_2``."""
    count = len(named) // len(effect.coefficients)
    names = numbered([c.name for c in effect.coefficients], count)
    return tuple(
        (name, c.value, c.sigma or 0.0, c.unit) for name, c in zip(names, named, strict=True)
    )


def _valid(
    problem: Case, effect: Effect, point: Mapping[str, float]
) -> tuple[tuple[str, float, float], ...]:
    """Range of each column that is a quantity; of a block of days the days."""
    chosen = {n.name: problem.columns[n.name] for n in effect.needs if n.name in problem.columns}
    chosen = {name: values for name, values in chosen.items() if name not in LABELLED}
    if "block" in point and problem.position_unit == "d":
        inside = problem.columns["block"] == point["block"]
        chosen["elapsed_days"] = problem.columns["elapsed_days"][inside]
    ranges = [
        (name, float(values.min()), float(values.max()))
        for name, values in chosen.items()
        if np.isfinite(values).all()
    ]
    return tuple(ranges)


def _reference(
    problem: Case, effect: Effect, point: Mapping[str, float]
) -> tuple[tuple[str, float], ...]:
    if effect.reference is None:
        return ()
    return tuple(effect.reference(problem.columns, problem.references, **point).items())


def _time(problem: Case, effect: Effect) -> Literal["days", "order", ""]:
    """What its column of time counts, where it has one."""
    if all(need.name != "elapsed_days" for need in effect.needs):
        return ""
    return "days" if problem.position_unit == "d" else "order"
