"""The diagnosis of one record: search, proof, values, and everything that is told about it."""

from __future__ import annotations

import math

import numpy as np

from surveyapp.diagnosis.adoption import adoptions, p_values
from surveyapp.diagnosis.ambiguity import ambiguities
from surveyapp.diagnosis.battery import run_battery
from surveyapp.diagnosis.case import Case, unit_variance
from surveyapp.diagnosis.checks import check_input
from surveyapp.diagnosis.compare import MARGIN, Level, base_level, best_with, charged, spans
from surveyapp.diagnosis.datum import datum_with_rivals
from surveyapp.diagnosis.events import event_notes
from surveyapp.diagnosis.fits import Fit
from surveyapp.diagnosis.held_out import confirm_rms, forecast, leave_one_out
from surveyapp.diagnosis.later_visits import held_out_prediction, is_campaign
from surveyapp.diagnosis.ledger import ledger_entry
from surveyapp.diagnosis.long_records.record import (
    LongRecord,
    is_long,
    reduce_record,
    unnamed,
    with_lines,
)
from surveyapp.diagnosis.loop import DEFAULT_DRAWS, Search, rivals_delta, search
from surveyapp.diagnosis.next_observation import advice, worth_in_words
from surveyapp.diagnosis.next_rows import rows_advice
from surveyapp.diagnosis.next_run import run_advice
from surveyapp.diagnosis.outlook import Outlook
from surveyapp.diagnosis.result import (
    Ambiguity,
    CandidateResult,
    CandidateVerdict,
    DatumValue,
    Diagnosis,
    Estimate,
    ModelResult,
    Verdict,
)
from surveyapp.diagnosis.run_average import is_short, short_average
from surveyapp.diagnosis.run_value import (
    Value,
    averaged_value,
    out_of_range,
    rms,
    value_of,
)
from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import joined, said, term


def diagnose(
    problem: Case,
    *,
    confirm: Case | None = None,
    draws: int = DEFAULT_DRAWS,
    advise: bool = True,
) -> Diagnosis:
    """Find what the model of a record lacks, and prove it.

    Parameters
    ----------
    problem : Case
        Made by ``reversal_run`` or ``campaign``, or by another subject. Of more than 400
        observations in time order the lines are taken out and block means are diagnosed.
    confirm : Case, optional
        A second, independent set of the same subject and instrument.
    draws : int
        Monte Carlo draws of each null distribution.
    advise : bool
        Whether to say what each next observation would be worth.

    Returns
    -------
    Diagnosis

    Raises
    ------
    SurveyError
        If there are too few observations, the second set is of another subject or instrument, or
        a long record cannot be averaged over 50 blocks and more.
    """
    check_input(problem, confirm)
    if confirm is not None and is_long(confirm):
        confirm = reduce_record(confirm).problem
    if not is_long(problem):
        return _diagnosed(problem, confirm, draws, advise=advise)
    record = reduce_record(problem)
    digest = problem.digest()
    found = _diagnosed(record.problem, confirm, draws, record=record, digest=digest)
    return with_lines(found, record)


def _diagnosed(
    problem: Case,
    confirm: Case | None,
    draws: int,
    *,
    record: LongRecord | None = None,
    digest: str | None = None,
    advise: bool = True,
) -> Diagnosis:
    """Diagnose a record that is not too long, or the block means of one that is."""
    digest = problem.digest() if digest is None else digest
    found = search(problem, draws=draws, confirm=confirm)
    if record is not None and not record.white:
        found = unnamed(found)
    base = found.levels[0].fits[0]
    battery = run_battery(problem, base, int(digest[:15], 16))
    adopted = adoptions(problem, found, digest, confirm)
    ambiguous = ambiguities(problem, found)
    verdict = _verdict(problem, found, ambiguous)
    averaged = averaged_value(problem, found.levels[-1].every)
    averaged = _widened(problem, found, averaged, verdict)
    if found.levels[-1].depth > 0 and is_short(problem, named=bool(found.adopted)):
        averaged = short_average(problem, base, named=bool(found.adopted))
    best = found.best if ambiguous else found.after
    models = [_model(problem, fit, confirm, found.near) for fit in (base, found.after, best)]
    outlook = _outlook(problem, base, digest) if advise else None
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
        before=models[0],
        after=models[1],
        after_best=models[2],
        averaged=_quantity(problem, averaged),
        remedy=_remedies(problem, found),
        warnings=(
            *problem.warnings,
            *_warnings(problem, found),
            *event_notes(problem, found, confirm),
        ),
        battery=battery,
        ledger=ledger_entry(problem, found, battery, digest=digest, draws=draws),
        residuals_before=_residuals(problem, base),
        residuals_best=_residuals(problem, best),
        title=term(problem.title or problem.subject.replace("_", " ")),
        value_name=problem.value_name,
        prediction=held_out_prediction(
            problem, before=models[0].forecast_rms, after=models[2].forecast_rms
        ),
        actions=() if outlook is None else outlook.actions,
        advice=()
        if outlook is None
        else tuple(worth_in_words(outlook, scale=problem.scale, unit=problem.unit)),
    )


def base_model(problem: Case) -> ModelResult:
    """Figures of a case's base model alone."""
    return _model(problem, base_level(problem).fits[0], None, ())


def _outlook(problem: Case, base: Fit, digest: str) -> Outlook | None:
    rng = np.random.default_rng(int(digest[:15], 16))
    if problem.has_swing:
        return run_advice(problem, base, rng)
    return advice(problem, rng) if is_campaign(problem) else rows_advice(problem, rng)


def _widened(problem: Case, found: Search, averaged: Value, verdict: Verdict) -> Value:
    """The averaged value, not more certain than what remains without a name allows.

    What no cause explains is not taken out of the sigma: it is the sigma of the named model, with
    the shift. Where stated sigmas serve, the scatter that they deny enters.
    """
    known = unit_variance(problem)
    base = found.levels[0].fits[0]
    dof = problem.size - base.design.shape[1]
    if (
        known is not None
        and dof >= 1
        and not found.adopted
        and (found.levels[-1].depth > 0 or denied(problem, base))
    ):
        scatter = math.sqrt(max(1.0, base.sum_of_squares / dof / known))
        sigma = max(averaged.sigma, scatter * value_of(problem, base).sigma)
        averaged = Value(averaged.value, sigma, dof)
    if verdict == "unattributed" or (found.near and found.near[0].is_generic):
        after = value_of(problem, found.after)
        least = math.hypot(after.sigma, averaged.value - after.value)
        if least > averaged.sigma:
            return Value(averaged.value, least, after.dof)
    return averaged


def _quantity(problem: Case, value: Value) -> Estimate:
    return Estimate(problem.offset + value.value, value.sigma, value.interval95)


def _model(problem: Case, fit: Fit, confirm: Case | None, near: tuple[Fit, ...]) -> ModelResult:
    error = rms(problem, fit)
    dof = problem.size - fit.parameters
    sigma0 = math.sqrt(fit.sum_of_squares / dof) if dof > 0 else None
    states = datum_with_rivals(problem, fit, near)
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
        loo_rms=leave_one_out(
            problem, fit, None if problem.reported is None else 1.0 - problem.reported
        ),
        confirm_rms=None if confirm is None else confirm_rms(confirm, fit),
        forecast_rms=None if fit.noise is not None else forecast(problem, fit),
        value=_quantity(problem, value_of(problem, fit)),
        value_at_datum=datum,
    )


def _residuals(problem: Case, fit: Fit) -> tuple[float, ...]:
    return tuple(float(v) for v in fit.residual / problem.root_weights)


def denied(problem: Case, base: Fit) -> bool:
    """Whether the scatter denies the stated sigmas, where these serve: chi-square at 5 %."""
    from scipy.special import chdtrc

    known = unit_variance(problem)
    dof = problem.size - base.design.shape[1]
    if known is None or dof < 1:
        return False
    return float(chdtrc(dof, base.sum_of_squares / known)) < problem.levels.first


def _verdict(problem: Case, found: Search, ambiguous: tuple[Ambiguity, ...]) -> Verdict:
    """The weakest that applies."""
    if found.levels[-1].depth == 0:
        fired = found.gates[-1].fired or denied(problem, found.levels[0].fits[0])
        return "unattributed" if fired else "adequate"
    named = {m.candidate.id for f in found.near for m in f.members if m.candidate.kind == "named"}
    open_names = named - set(found.adopted)
    if found.unexplained or (ambiguous and not open_names) or (found.refused and not ambiguous):
        return "unattributed"
    return "not_separable" if ambiguous else "explained"


def _candidates(problem: Case, found: Search) -> tuple[CandidateResult, ...]:
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
            verdict, reason = "implausible", said("the coefficient lies outside its physical range")
            if not out_of_range(problem, found.implausible[identity], identity):
                verdict, reason = (
                    "not_separable",
                    said("not determinable: its sigma exceeds its range"),
                )
        elif identity in near or p is None:
            verdict = "not_separable"
        elif family is not None and family <= 0.05:
            verdict = "candidate"
            reason = _why_no_rival(problem, found, level, identity)
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


def _why_no_rival(problem: Case, found: Search, level: Level | None, identity: str) -> str:
    """Why a candidate close behind in BIC is none of the rivals beside what was named."""
    delta = None if level is None else rivals_delta(level, identity)
    if not found.adopted or level is None or delta is None or delta >= MARGIN:
        return ""
    fit = best_with(level, identity)
    if fit is None:
        return ""
    if spans(fit, found.best) or set(found.adopted) <= fit.key:
        return "contains what was named, and explains no more"
    if fit.score - fit.bic > found.best.score - found.best.bic:
        return "its search is paid for by how little of it explains the record"
    odds = problem.levels.shape_odds
    if charged(fit, odds) > fit.score:
        return said("a shape without a cause is charged {odds:.0f} BIC beforehand", odds=odds)
    return ""


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


def _remedies(problem: Case, found: Search) -> tuple[str, ...]:
    wanted = {i for fit in found.near for i in fit.key} | set(found.adopted)
    return tuple(term(e.remedy) for e in problem.effects if e.id in wanted)


def _warnings(problem: Case, found: Search) -> list[ResultWarning]:
    result = []
    if problem.sigma_known:
        result.append(
            ResultWarning(
                "stated_sigmas",
                said(
                    "only {size} observations: the stated sigmas serve for the noise",
                    size=problem.size,
                ),
            )
        )
    if problem.size < 8:
        result.append(
            ResultWarning(
                "no_names", said("no effect is named from {size} observations", size=problem.size)
            )
        )
    if problem.size < 12 and problem.resolution > 0.0:
        result.append(
            ResultWarning(
                "coarse_readings",
                said("from fewer than 12 rounded readings false alarms are more frequent than 5 %"),
            )
        )
    if len(found.levels) - 1 > 2:
        result.append(
            ResultWarning(
                "deep_search",
                said("three and more effects are named only where a second set confirms them"),
            )
        )
    result += [
        ResultWarning("not_adopted", joined(": ", (identity, reason)))
        for identity, reason in found.refused
    ]
    return result
