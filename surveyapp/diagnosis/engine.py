"""The diagnosis of one record: search, proof, values, and everything that is told about it."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

import numpy as np

from surveyapp.diagnosis.battery import run_battery
from surveyapp.diagnosis.compare import Level, added_signal
from surveyapp.diagnosis.fits import Fit
from surveyapp.diagnosis.ledger import ledger_entry
from surveyapp.diagnosis.loop import DEFAULT_DRAWS, Search, margin_of, rivals_delta, search
from surveyapp.diagnosis.problem import Problem
from surveyapp.diagnosis.prove import confirm_rms, forecast, leave_one_out
from surveyapp.diagnosis.result import (
    Adoption,
    Ambiguity,
    CandidateResult,
    CandidateVerdict,
    DatumValue,
    Diagnosis,
    ModelResult,
    NamedCoefficient,
    Quantity,
    Verdict,
)
from surveyapp.diagnosis.value import (
    Value,
    averaged_value,
    coefficients,
    datum_values,
    rms,
    value_of,
)
from surveyapp.domain.instrument import AdoptedEffect
from surveyapp.domain.project import ResultWarning
from surveyapp.errors import Problem as InputProblem
from surveyapp.errors import SurveyError

MOST_OPTIONS = 8
"""Sets that are told; the ledger has them all."""
SEPARATING = {
    "quadratic": "a longer record, or the same at another time of day",
    "smooth": "a longer record",
    "long_oscillation": "a record of at least twice that period",
    "periodic": "a record of at least twice that period",
    "step": "a repetition on the first part",
    "amplitude_step": "a second run, followed evenly",
    "amplitude_smooth": "a second run, begun with another amplitude",
    "outlier": "the book itself, or a repetition",
    "random_walk": "more observations, or a second record: a wandering north does not repeat",
    "amplitude_walk": "a second run, followed evenly: irregular following does not repeat",
    "ar1": "more observations, or a second record: correlated noise does not repeat",
}


def diagnose(
    problem: Problem, *, confirm: Problem | None = None, draws: int = DEFAULT_DRAWS
) -> Diagnosis:
    """Find what the model of a record lacks, and prove it.

    Parameters
    ----------
    problem : Problem
        Made by ``reversal_run`` or ``campaign``, or by another subject.
    confirm : Problem, optional
        A second, independent set of the same subject and instrument.
    draws : int
        Monte Carlo draws of each null distribution.

    Returns
    -------
    Diagnosis

    Raises
    ------
    SurveyError
        If there are too few observations, or the second set is of another subject or instrument.
    """
    _check(problem, confirm)
    digest = problem.digest()
    found = search(problem, draws=draws, confirm=confirm)
    base = found.levels[0].fits[0]
    averaged = averaged_value(problem, found.levels[-1].every)
    battery = run_battery(problem, base, int(digest[:15], 16))
    adopted = _adoptions(problem, found, digest, confirm)
    ambiguous = _ambiguities(problem, found)
    verdict = _verdict(found, ambiguous)
    best = found.best if ambiguous else found.after
    return Diagnosis(
        subject=problem.subject,
        identity=problem.identity,
        instrument=problem.instrument,
        unit=problem.unit,
        scale=problem.scale,
        direction=problem.direction,
        verdict=verdict,
        adopted=adopted,
        ambiguous=ambiguous,
        candidates=_candidates(problem, found),
        before=_model(problem, base, confirm),
        after=_model(problem, found.after, confirm),
        after_best=_model(problem, best, confirm),
        averaged=_quantity(problem, averaged),
        remedy=_remedies(problem, found),
        warnings=(*problem.warnings, *_warnings(problem, found)),
        battery=battery,
        ledger=ledger_entry(problem, found, battery, digest=digest, draws=draws),
        residuals_before=_residuals(problem, base),
        residuals_after=_residuals(problem, found.after),
        residuals_best=_residuals(problem, best),
    )


def _check(problem: Problem, confirm: Problem | None) -> None:
    faults = []
    least = problem.base_parameters + 1
    if problem.sigma_known and not problem.has_swing:
        least = 2
    if problem.size < least:
        faults.append(
            InputProblem(
                "too few observations to diagnose anything",
                problem.identity,
                f"{problem.size}",
                f"at least {least}; from 8 on an effect can be named",
                "Observe more, or use the result of orient with its own sigma.",
            )
        )
    if confirm is not None:
        if confirm.subject != problem.subject:
            faults.append(
                InputProblem(
                    "the second set is of another subject",
                    confirm.identity,
                    confirm.subject,
                    problem.subject,
                    "Confirm with an independent record of the same kind.",
                )
            )
        elif confirm.instrument != problem.instrument:
            faults.append(
                InputProblem(
                    "the second set is of another instrument",
                    confirm.identity,
                    confirm.instrument or "no instrument",
                    problem.instrument or "no instrument",
                    "An effect is confirmed by another record of the same instrument.",
                )
            )
        if confirm.size < confirm.base_parameters + 1:
            faults.append(
                InputProblem(
                    "too few observations in the second set",
                    confirm.identity,
                    f"{confirm.size}",
                    f"at least {confirm.base_parameters + 1}",
                )
            )
    if faults:
        raise SurveyError(faults)


def _quantity(problem: Problem, value: Value) -> Quantity:
    return Quantity(problem.offset + value.value, value.sigma, value.interval95)


def _model(problem: Problem, fit: Fit, confirm: Problem | None) -> ModelResult:
    error = rms(problem, fit)
    dof = problem.size - fit.parameters
    sigma0 = math.sqrt(fit.sum_of_squares / dof) if dof > 0 else None
    states = datum_values(problem, fit)
    datum = None
    if states:
        datum = DatumValue(states[0][0], tuple((t, _quantity(problem, v)) for _, t, v in states))
    return ModelResult(
        effects=fit.effects,
        parameters=fit.parameters,
        bic=fit.bic,
        rms=error,
        sigma0=sigma0,
        dof=dof,
        loo_rms=leave_one_out(problem, fit),
        confirm_rms=None if confirm is None else confirm_rms(confirm, fit),
        forecast_rms=None if fit.noise is not None else forecast(problem, fit),
        value=_quantity(problem, value_of(problem, fit)),
        value_at_datum=datum,
    )


def _residuals(problem: Problem, fit: Fit) -> tuple[float, ...]:
    return tuple(float(v) for v in fit.residual / problem.root_weights)


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


def _adoptions(
    problem: Problem, found: Search, digest: str, confirm: Problem | None
) -> tuple[Adoption, ...]:
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


def _ambiguities(problem: Problem, found: Search) -> tuple[Ambiguity, ...]:
    """What is left in the sets within the margin once the adopted names are taken out."""
    if not found.near:
        return ()
    options: dict[str, Fit] = {}
    for fit in found.near:
        rest = [i for i in fit.effects if i not in found.adopted]
        if rest:
            options.setdefault(" + ".join(rest), fit)
    if not options:
        return ()
    best = min(fit.bic for fit in found.near)
    options = dict(list(options.items())[:MOST_OPTIONS])
    fits = list(options.values())
    texts = []
    for fit in fits:
        for identity in fit.effects:
            text = _separating(problem, identity)
            if identity not in found.adopted and text and text not in texts:
                texts.append(text)
    return (
        Ambiguity(
            tuple(options),
            tuple(fit.bic - best for fit in fits),
            _collinearity(fits, found.adopted),
            "; ".join(texts),
        ),
    )


def _separating(problem: Problem, identity: str) -> str:
    for effect in problem.effects:
        if effect.id == identity:
            return effect.separate_by
    return SEPARATING.get(identity, "")


def _collinearity(fits: list[Fit], adopted: tuple[str, ...]) -> float | None:
    """Correlation of what the two best sets add, None where one of them is stochastic."""
    signals = []
    for fit in fits[:2]:
        if fit.noise is not None:
            return None
        signal = added_signal(fit)
        keep = [i for i, m in enumerate(fit.members) if m.candidate.id not in adopted]
        if not keep:
            return None
        signals.append(signal[:, keep].sum(axis=1))
    if len(signals) < 2:
        return None
    size = float(np.linalg.norm(signals[0]) * np.linalg.norm(signals[1]))
    return float(abs(signals[0] @ signals[1]) / size) if size > 0.0 else None


def _verdict(found: Search, ambiguous: tuple[Ambiguity, ...]) -> Verdict:
    """The weakest that applies."""
    if found.levels[-1].depth == 0:
        return "unattributed" if found.gates[-1].fired else "adequate"
    named = {m.candidate.id for f in found.near for m in f.members if m.candidate.kind == "named"}
    open_names = named - set(found.adopted)
    if found.unexplained or (ambiguous and not open_names) or (found.refused and not ambiguous):
        return "unattributed"
    return "not_separable" if ambiguous else "explained"


def _candidates(problem: Problem, found: Search) -> tuple[CandidateResult, ...]:
    result = []
    refused = dict(found.refused)
    near = {i for fit in found.near for i in fit.key}
    unique = {c.id: c for c in found.pool if c.count == 1}
    for identity, candidate in unique.items():
        p, family = p_values(found, identity)
        level = _competing_level(found, identity)
        delta = None if level is None else rivals_delta(level, identity)
        reason = candidate.missing or refused.get(identity, "")
        verdict: CandidateVerdict
        if candidate.missing:
            verdict = "not_applicable"
        elif identity in found.adopted:
            verdict = "adopted"
        elif identity in refused:
            verdict = "candidate"
        elif identity in found.implausible and identity not in near:
            verdict, reason = "implausible", "the coefficient lies outside its physical range"
        elif identity in near or p is None:
            verdict = "not_separable"
        elif family is not None and family <= 0.05:
            verdict = "candidate"
        else:
            verdict = "not_significant"
        result.append(CandidateResult(identity, verdict, p, family, delta, candidate.kind, reason))
    for identity in ("random_walk", "amplitude_walk", "ar1"):
        level = _competing_level(found, identity)
        if level is None:
            continue
        delta = rivals_delta(level, identity)
        kind: CandidateVerdict = "not_separable" if identity in near else "candidate"
        if delta is not None and delta >= 4.0:
            kind = "not_significant"
        result.append(CandidateResult(identity, kind, None, None, delta, "noise"))
    return tuple(result)


def _competing_level(found: Search, identity: str) -> Level | None:
    """Level at which an effect competed after the last gate that tested it and was open."""
    if any(identity in fit.key for fit in found.near):
        return found.levels[-1]
    last = None
    for gate, level in zip(found.gates, found.levels[1:], strict=False):
        tested = any(test.id == identity and test.p is not None for test in gate.tests)
        if any(identity in fit.key for fit in level.every) and (tested or last is None):
            last = level
    return last


def _remedies(problem: Problem, found: Search) -> tuple[str, ...]:
    wanted = {i for fit in found.near for i in fit.key} | set(found.adopted)
    return tuple(e.remedy for e in problem.effects if e.id in wanted)


def _warnings(problem: Problem, found: Search) -> list[ResultWarning]:
    result = []
    if problem.sigma_known:
        result.append(
            ResultWarning(
                "stated_sigmas",
                f"only {problem.size} observations: the stated sigmas serve for the noise",
            )
        )
    if problem.size < 8:
        result.append(
            ResultWarning("no_names", f"no effect is named from {problem.size} observations")
        )
    if problem.size < 12 and problem.resolution > 0.0:
        result.append(
            ResultWarning(
                "coarse_readings",
                "from fewer than 12 rounded readings false alarms are more frequent than 5 %",
            )
        )
    if len(found.levels) - 1 > 2:
        result.append(
            ResultWarning(
                "deep_search",
                "three and more effects are named only where a second set confirms them",
            )
        )
    result += [
        ResultWarning("not_adopted", f"{identity}: {reason}") for identity, reason in found.refused
    ]
    return result


def to_json(diagnosis: Diagnosis) -> dict[str, Any]:
    """Same as ``diagnosis.to_dict()``, for callers that prefer a function."""
    return diagnosis.to_dict()
