"""A record too long to be diagnosed whole: its lines are taken out, then blocks are averaged.

Every candidate is compared under correlated noise with matrices of all observations, which costs a
gigabyte at 400 of them. A longer record holds less than its number of samples anyhow: neighbours
share their noise. Blocks are made longer until their means are independent as far as they tell;
where they are not even as the fewest that are allowed, nothing is named.
"""

from __future__ import annotations

import dataclasses
from typing import Any, NoReturn

import numpy as np

from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.long_records.blocks import (
    LEAST_BLOCKS,
    Blocks,
    block_means,
    finer_than_blocks,
    runs_of,
    split,
)
from surveyapp.diagnosis.long_records.lines import (
    LineSearch,
    SpectralLine,
    find_lines,
    judges_lines,
)
from surveyapp.diagnosis.long_records.whiteness import Whiteness, whiteness
from surveyapp.diagnosis.loop import Search
from surveyapp.diagnosis.result import CandidateResult, CandidateVerdict, Diagnosis
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said
from surveyapp_models.arrays import Floats

LONG = 400
"""Observations up to which a record is diagnosed as it is: 0.7 GB, of a swing 1 GB."""
COUNTS = (200, 160, 125, 100, 80, 63, LEAST_BLOCKS)
"""Blocks that are tried in turn, each about a quarter longer than before."""
NOT_WHITE = "the means of blocks are correlated, and correlated noise looks like it"

FINER = "{} changes more often than there are blocks: whether one of them stands off is not judged"
LINE_REASON = "looked for among the spectral lines"
FREQUENCY_UNITS = {"s": "Hz", "d": "1/d"}


@dataclasses.dataclass(frozen=True, slots=True)
class LongRecord:
    """What a long record was reduced to.

    Parameters
    ----------
    problem : Case
        Of block means.
    lines : tuple of SpectralLine
    white : bool
        Whether the block means may be taken for independent; else nothing is to be named.
    left_out : tuple of (str, str)
        Effects that block means cannot judge, and why.
    ledger : mapping
        Entry of the ledger under ``blocks``.
    """

    problem: Case
    lines: tuple[SpectralLine, ...]
    white: bool
    left_out: tuple[tuple[str, str], ...]
    ledger: dict[str, Any]


def is_long(problem: Case) -> bool:
    """Whether a record must be reduced before it is diagnosed.

    Channels that were observed side by side are means of stops already.
    """
    if problem.size <= LONG or problem.series is not None:
        return False
    known = problem.position[np.isfinite(problem.position)]
    return known.size == 0 or float(np.ptp(known)) > 0.0


def reduce_record(problem: Case) -> LongRecord:
    """Take the lines out of a long record and average it over blocks.

    Parameters
    ----------
    problem : Case

    Returns
    -------
    LongRecord

    Raises
    ------
    SurveyError
        If it is a swing, does not vary, has too few finite samples or times, or if its numbered
        columns change too often for blocks.
    """
    if problem.has_swing:
        _refuse(
            problem,
            "too many turning points for one run",
            found=f"{problem.size}",
            expected=said("at most {long}", long=LONG),
            hint="Divide the run and diagnose its parts.",
        )
    clean = _sorted_and_finite(problem)
    missing = problem.size - clean.size
    fine = finer_than_blocks(clean, COUNTS[0])
    columns = {name: values for name, values in clean.columns.items() if name not in fine}
    clean = dataclasses.replace(clean, columns=columns)
    residual = _residual(clean)
    _need_variation(clean, residual)
    seconds = clean.position_unit == "s"
    search = find_lines(
        clean.position,
        residual,
        columns={n: v for n, v in clean.columns.items() if n in _used(clean)},
        effects=[e for e in clean.effects if judges_lines(e)] if seconds else [],
    )
    # the lines' own mean stays in the record: the value is the mean of what was observed
    total = float(np.sum(clean.value_weights))
    own = float(clean.value_weights @ search.signal) / total if total != 0.0 else 0.0
    signal = search.signal - own
    quiet = dataclasses.replace(clean, observations=clean.observations - signal)
    reduced, blocks, tests = _until_white(quiet)
    warnings = _warnings(clean, search, blocks, tests, missing=missing)
    warnings += [ResultWarning("finer_than_blocks", FINER.format(name)) for name in fine]
    return LongRecord(
        dataclasses.replace(reduced, warnings=(*problem.warnings, *warnings)),
        search.lines,
        tests[-1].white,
        _left_out(clean, reduced),
        _ledger(clean, search, blocks, tests, missing=missing),
    )


def _refuse(problem: Case, what: str, *, found: str, expected: str, hint: str) -> NoReturn:
    raise SurveyError(Problem(what, problem.identity, found, expected, hint))


def _used(problem: Case) -> set[str]:
    """Covariates that some effect of the record itself uses."""
    return {n.name for e in problem.effects if not judges_lines(e) for n in e.needs}


def _sorted_and_finite(problem: Case) -> Case:
    """Samples with a value, a time and a base, in their order; the value's weights as before."""
    good = np.isfinite(problem.observations) & np.isfinite(problem.position)
    good &= np.isfinite(problem.base).all(axis=1) & np.isfinite(problem.value_weights)
    if problem.sigma is not None:
        good &= np.isfinite(problem.sigma) & (problem.sigma > 0.0)
    rows = np.flatnonzero(good)
    rows = rows[np.argsort(problem.position[rows], kind="stable")]
    if rows.size < 2 * LEAST_BLOCKS:
        _refuse(
            problem,
            "too few samples that are numbers",
            found=f"{rows.size} of {problem.size}",
            expected=said("at least {least}", least=2 * LEAST_BLOCKS),
            hint="Look for what interrupted the record.",
        )
    weights = problem.value_weights[rows]
    before, kept = float(np.nansum(problem.value_weights)), float(np.sum(weights))
    return dataclasses.replace(
        problem,
        observations=problem.observations[rows],
        base=problem.base[rows],
        value_weights=weights * (before / kept if kept != 0.0 else 1.0),
        position=problem.position[rows],
        columns={name: values[rows] for name, values in problem.columns.items()},
        sigma=None if problem.sigma is None else problem.sigma[rows],
        labels=(),
    )


def _residual(problem: Case) -> Floats:
    """Residuals of the base model, not weighted (n,) [SI]."""
    root = problem.root_weights
    q, r = np.linalg.qr(problem.base * root[:, None])
    along = np.linalg.lstsq(r, q.T @ (problem.observations * root), rcond=1e-12)[0]
    return np.asarray(problem.observations - problem.base @ along)


def _need_variation(problem: Case, residual: Floats) -> None:
    size = float(np.abs(problem.observations).max(initial=0.0))
    if float(np.std(residual)) <= 1e-12 * max(size, problem.resolution):
        _refuse(
            problem,
            "the record does not vary",
            found=said("{size} samples without any noise", size=problem.size),
            expected="samples that scatter",
            hint="Look for a sensor that stands still or a range that is exceeded.",
        )


def _until_white(problem: Case) -> tuple[Case, Blocks, tuple[Whiteness, ...]]:
    """Ever longer blocks until their means do not show any correlation, 50 at least."""
    runs = runs_of(problem)
    if runs.size > LONG:
        names = ", ".join(n for n in problem.grid_labels if n in problem.columns)
        _refuse(
            problem,
            "numbered columns change too often to average over blocks",
            found=said(
                "{size} runs of equal {names} in {size2} observations",
                size=runs.size,
                names=names,
                size2=problem.size,
            ),
            expected=said("at most {long} runs", long=LONG),
            hint=said(
                "Diagnose parts of at most {long} observations, or one line or set-up at a time.",
                long=LONG,
            ),
        )
    seed = int(problem.digest()[:15], 16)
    tests: list[Whiteness] = []
    for count in COUNTS:
        blocks = split(problem.position, runs, count)
        if tests and blocks.first.size < LEAST_BLOCKS:
            break
        reduced = block_means(problem, blocks)
        tests.append(
            whiteness(reduced.observations, _explained(reduced), reduced.root_weights, seed)
        )
        best = reduced, blocks
        if tests[-1].white:
            break
    return (*best, tuple(tests))


def _explained(problem: Case) -> Floats:
    """Columns of the base and of every effect without a scan, shape (m, p), not weighted."""
    parts = [problem.base]
    for effect in problem.effects:
        columns = [problem.columns.get(need.name) for need in effect.needs]
        known = all(c is not None and np.isfinite(c).all() for c in columns)
        if known and not effect.grid and effect.acts_on == "midpoint":
            parts.append(effect.basis(problem.columns))
    joined = np.hstack(parts)
    return joined if joined.shape[1] <= problem.size // 4 else problem.base


def _left_out(raw: Case, reduced: Case) -> tuple[tuple[str, str], ...]:
    kept = {effect.id for effect in reduced.effects}
    return tuple(
        (
            effect.id,
            LINE_REASON if judges_lines(effect) else "what it depends on varies within a block",
        )
        for effect in raw.effects
        if effect.id not in kept
    )


def _warnings(
    problem: Case,
    search: LineSearch,
    blocks: Blocks,
    tests: tuple[Whiteness, ...],
    *,
    missing: int,
) -> list[ResultWarning]:
    found = []
    test, samples = tests[-1], int(np.median(blocks.counts))
    unit = f" {problem.position_unit}" if problem.position_unit else ""
    text = said(
        "{size} samples: the means of {blocks} blocks of {duration:.4g}{unit} "
        "(about {samples} samples each) are judged, not the samples",
        size=problem.size,
        blocks=test.blocks,
        duration=blocks.duration,
        unit=unit,
        samples=samples,
    )
    found.append(ResultWarning("block_means", text))
    if not test.white:
        text = said(
            "neighbouring means of {blocks} blocks are still correlated (p = "
            "{p:.4f}; independent ones were expected): the noise wanders as slowly "
            "as an effect, and nothing is named; record several times as long, or "
            "shield what makes it wander",
            blocks=test.blocks,
            p=test.p,
        )
        found.append(ResultWarning("blocks_not_white", text))
    if missing:
        text = said("{missing} samples without a value or time are left out", missing=missing)
        found.append(ResultWarning("missing_samples", text))
    if search.unsearched:
        text = said("no spectral lines were looked for: {unsearched}", unsearched=search.unsearched)
        found.append(ResultWarning("no_spectrum", text))
    if search.crowded:
        text = "more peaks stand out than can be lines: only the strongest are listed"
        found.append(ResultWarning("crowded_spectrum", text))
    return found


def _ledger(
    problem: Case,
    search: LineSearch,
    blocks: Blocks,
    tests: tuple[Whiteness, ...],
    *,
    missing: int,
) -> dict[str, Any]:
    return {
        "samples": problem.size,
        "missing": missing,
        "count": tests[-1].blocks,
        "duration": blocks.duration,
        "unit": problem.position_unit,
        "samples_per_block": int(np.median(blocks.counts)),
        "white": tests[-1].white,
        "whiteness": [
            {"blocks": t.blocks, "ratio": round(t.ratio, 6), "p": round(t.p, 6)} for t in tests
        ],
        "lines": [line.to_dict(problem.scale) for line in search.lines],
        "unsearched": search.unsearched,
    }


def unnamed(found: Search) -> Search:
    """A search whose names are taken back, because block means are not independent."""
    if not found.adopted:
        return found
    taken = tuple((name, NOT_WHITE) for name in found.adopted)
    base = found.levels[0].fits[0]
    return dataclasses.replace(found, adopted=(), refused=(*found.refused, *taken), after=base)


def with_lines(found: Diagnosis, record: LongRecord) -> Diagnosis:
    """A diagnosis of block means with the lines of the record and what blocks cannot judge."""
    verdict = found.verdict
    open_line = any(not line.effect for line in record.lines)
    if verdict == "adequate" and record.lines and not open_line:
        verdict = "explained"
    if open_line or (not record.white and verdict != "not_separable"):
        verdict = "unattributed"
    return dataclasses.replace(
        found,
        verdict=verdict,
        candidates=(*found.candidates, *_candidates_left_out(record)),
        ledger={**found.ledger, "blocks": record.ledger},
        lines=record.lines,
        frequency_unit=FREQUENCY_UNITS.get(record.problem.position_unit, "1/position"),
    )


def _candidates_left_out(record: LongRecord) -> list[CandidateResult]:
    alarms = {line.effect: line.false_alarm for line in reversed(record.lines)}
    result = []
    for identity, reason in record.left_out:
        p = alarms.get(identity)
        kind: CandidateVerdict = "not_applicable"
        if reason == LINE_REASON:
            kind = "not_significant" if p is None else "candidate"
        result.append(CandidateResult(identity, kind, p, p, None, "named", reason))
    return result
