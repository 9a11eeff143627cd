"""What all runs of one instrument say together that none of them says alone.

An effect of the instrument has about the same coefficient in every run; what happens once (a step,
a slip) is no matter for pooling. The runs are not merged: each gives the likelihood of a
coefficient, and the evidence that they share one is weighed against that of every other effect, of
a north that wanders, of correlated noise and of events (a step, a change of the damping) that have
a place of their own in each run: eight runs whose damping changes would else name the friction.

Source: prediction.md C. The likelihood of a coefficient is taken for normal about its estimate with
the height of the Student one, so that the integrals over sessions and the common coefficient are
closed; Normand (1999), Statist. Med. 18, 321-359 (random-effects model).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from surveyapp.diagnosis.candidates import Candidate
from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.pooled_runs import SIZES, SPREADS, Run, event_evidence, log_mean, run_of
from surveyapp.languages import said
from surveyapp_models.arrays import Floats

LEVEL = 0.05
MARGIN = 2.0
"""Natural logarithm of evidence by which every rival must be worse."""
NULL_DRAWS = 300
WALKS = (0.5, 1.0, 2.0, 4.0, 8.0)
"""Standard deviation of a walk at the end of a run, in sigmas."""
CORRELATIONS = (0.3, 0.6, 0.85)
CORRELATED = (0.7, 1.5, 3.0)
NOISES = ("random_walk", "ar1")


@dataclass(frozen=True, slots=True)
class PooledEffect:
    """One effect over all sessions.

    Parameters
    ----------
    effect, title : str
    evidence : float
        Natural logarithm of how much likelier the sessions are with it than without.
    p : float or None
        Probability of so large an evidence of any effect if nothing is at work; None for noise.
    coefficient, sigma : float or None
        Common coefficient in its printed unit.
    unit : str
    sessions : int
        That can speak of it.
    """

    effect: str
    title: str
    evidence: float
    p: float | None
    coefficient: float | None
    sigma: float | None
    unit: str
    sessions: int


@dataclass(frozen=True, slots=True)
class Pooled:
    """All effects over all sessions, the likeliest first.

    Parameters
    ----------
    sessions : tuple of str
    effects : tuple of PooledEffect
    named : PooledEffect or None
        The one that passes the cut and beats every rival.
    fired : bool
        Whether any effect passes the cut.
    """

    sessions: tuple[str, ...]
    effects: tuple[PooledEffect, ...]
    named: PooledEffect | None
    fired: bool


@dataclass(frozen=True, slots=True)
class _Told:
    """What one session says of each column: row 0 its readings, the others draws of noise.

    Parameters
    ----------
    estimates, variances, heights : ndarray, shape (1 + draws, columns)
        NaN where the session cannot speak.
    sensitivity : ndarray, shape (columns,)
        What a coefficient of 1 does to a reading, in sigmas.
    noises : ndarray, shape (grid of noises,)
    """

    estimates: Floats
    variances: Floats
    heights: Floats
    sensitivity: Floats
    noises: Floats


def poolable(candidate: Candidate) -> bool:
    """Whether a candidate is an effect of the instrument with one coefficient."""
    effect = candidate.effect
    return (
        effect is not None
        and not effect.event
        and candidate.count == 1
        and len(effect.coefficients) == 1
    )


def pool(cases: Sequence[Case], rng: np.random.Generator) -> Pooled:
    """Pool the runs of one instrument.

    Parameters
    ----------
    cases : sequence of Case
        Runs with the same effects.
    rng : numpy.random.Generator
        For the null distribution of the largest evidence.
    """
    runs = [run_of(case) for case in cases]
    columns = _columns(runs)
    told = [_session(run, columns, rng) for run in runs]
    evidence = _evidence(told)
    names = list(dict.fromkeys(name for name, _ in columns))
    found = []
    per_effect = np.column_stack(
        [
            log_mean(np.stack([evidence[:, i] for i, (n, _) in enumerate(columns) if n == name]))
            for name in names
        ]
    )
    null = per_effect[1:].max(axis=1) if names else np.zeros(0)
    for k, name in enumerate(names):
        p = (1.0 + float(np.sum(null >= per_effect[0, k]))) / (null.size + 1.0)
        best = max(
            (i for i, (n, _) in enumerate(columns) if n == name), key=lambda i: evidence[0, i]
        )
        found.append(_effect(cases, told, (name, best), float(per_effect[0, k]), p=p))
    noises = np.sum([item.noises for item in told], axis=0)
    split = len(WALKS)
    for name, values in zip(NOISES, (noises[:split], noises[split:]), strict=True):
        title = {"random_walk": said("a north that wanders"), "ar1": said("correlated noise")}[name]
        found.append(
            PooledEffect(name, title, float(log_mean(values)), None, None, None, "", len(cases))
        )
    found += [
        PooledEffect(event, title, value, None, None, None, "", len(cases))
        for event, title, value in event_evidence(runs)
    ]
    found = [item for item in found if _plausible(cases, item)]
    found.sort(key=lambda item: -item.evidence)
    fired = any(item.p is not None and item.p <= LEVEL for item in found)
    return Pooled(tuple(c.identity for c in cases), tuple(found), _named(found), fired)


def _plausible(cases: Sequence[Case], item: PooledEffect) -> bool:
    """Whether the common coefficient lies in its physical range, two sigmas of grace."""
    if item.coefficient is None or item.sigma is None:
        return True
    effect = next(e for case in cases for e in case.effects if e.id == item.effect)
    limits = effect.coefficients[0]
    low = 0.0 if effect.one_sided else limits.low
    grace = 2.0 * item.sigma
    return low - grace <= item.coefficient <= limits.high + grace


def _named(found: Sequence[PooledEffect]) -> PooledEffect | None:
    first = found[0] if found else None
    if first is None or first.p is None or first.p > LEVEL or first.evidence <= MARGIN:
        return None
    rivals = [item.evidence for item in found[1:]]
    return first if not rivals or first.evidence >= max(rivals) + MARGIN else None


def _columns(runs: Sequence[Run]) -> list[tuple[str, tuple[tuple[str, float], ...]]]:
    """Every effect at every grid point that any session knows."""
    found: dict[tuple[str, tuple[tuple[str, float], ...]], None] = {}
    for run in runs:
        for candidate in run.candidates:
            if poolable(candidate):
                for point in candidate.points:
                    found[candidate.id, tuple(sorted(point.items()))] = None
    return list(found)


def _session(
    run: Run,
    columns: Sequence[tuple[str, tuple[tuple[str, float], ...]]],
    rng: np.random.Generator,
) -> _Told:
    case, q, sigma, n = run.case, run.q, run.sigma, run.case.size
    noise = sigma * rng.standard_normal((NULL_DRAWS, n))
    readings = np.vstack([run.residual, noise])
    readings -= (readings @ q) @ q.T
    total = run.nu0 * sigma**2 + np.sum(readings**2, axis=1)
    size = len(columns)
    estimates = np.full((NULL_DRAWS + 1, size), np.nan)
    variances, heights = estimates.copy(), estimates.copy()
    sensitivity = np.full(size, np.nan)
    place = {name: i for i, name in enumerate(columns)}
    for candidate in run.candidates:
        if not poolable(candidate):
            continue
        for g, point in enumerate(candidate.points):
            i = place[candidate.id, tuple(sorted(point.items()))]
            found = run.likelihood(candidate.columns[g, :, 0], readings, total)
            if found is None:
                continue
            estimates[:, i], variances[:, i], heights[:, i], sensitivity[i] = found
    noises = _noises(case, q, run.residual, (sigma, run.nu0))
    return _Told(estimates, variances, heights, sensitivity, noises)


def _evidence(told: Sequence[_Told]) -> Floats:
    """Log evidence of each column against no effect, shape (1 + draws, columns)."""
    b = np.stack([item.estimates for item in told])
    v = np.stack([item.variances for item in told])
    h = np.stack([item.heights for item in told])
    able = np.isfinite(b)
    sensitivity = np.stack([item.sensitivity for item in told])
    typical = np.nanmedian(np.where(np.isfinite(sensitivity), sensitivity, np.nan), axis=0)
    found = []
    for size in SIZES:
        a = size / np.maximum(typical, 1e-300)
        for spread in SPREADS:
            wide = v + (spread * a) ** 2
            own = np.where(able, h + 0.5 * np.log(v / wide) - 0.5 * b * b / wide, 0.0).sum(axis=0)
            precision = np.where(able, 1.0 / wide, 0.0).sum(axis=0)
            along = np.where(able, b / wide, 0.0).sum(axis=0)
            common = 0.5 * along**2 / (precision + 1.0 / a**2)
            found.append(own + common - 0.5 * np.log1p(a**2 * precision))
    return log_mean(np.stack(found))


def _effect(
    cases: Sequence[Case],
    told: Sequence[_Told],
    which: tuple[str, int],
    evidence: float,
    *,
    p: float,
) -> PooledEffect:
    """The common coefficient at the best grid point: mean over sessions and their differences."""
    name, i = which
    effect = next(e for case in cases for e in case.effects if e.id == name)
    b = np.array([item.estimates[0, i] for item in told])
    v = np.array([item.variances[0, i] for item in told])
    able = np.isfinite(b)
    b, v = b[able], v[able]
    # DerSimonian & Laird (1986): what sessions differ by beyond their own sigma
    w = 1.0 / v
    mean = float(w @ b / w.sum())
    excess = float(w @ (b - mean) ** 2) - (b.size - 1)
    spread = w.sum() - float(w @ w) / w.sum()
    between = max(excess / spread, 0.0) if b.size > 1 and spread > 0.0 else 0.0
    w = 1.0 / (v + between)
    unit = effect.coefficients[0]
    return PooledEffect(
        name,
        effect.title,
        evidence,
        p,
        float(w @ b / w.sum()) / unit.scale,
        float(1.0 / np.sqrt(w.sum())) / unit.scale,
        unit.unit,
        int(able.sum()),
    )


def _noises(case: Case, q: Floats, residual: Floats, how: tuple[float, float]) -> Floats:
    """Log evidence of walks and of correlated noise of each size against white noise."""
    sigma, nu0 = how
    n = case.size
    t = case.position - case.position.min()
    span = max(float(t.max()), 1e-12)
    u = t / span
    kernels: list[tuple[Floats, tuple[float, ...]]] = [(np.minimum(u[:, None], u[None, :]), WALKS)]
    step = np.abs(u[:, None] - u[None, :]) * (n - 1)
    kernels += [(rho**step, CORRELATED) for rho in CORRELATIONS]
    free = np.linalg.svd(np.eye(n) - q @ q.T)[0][:, : n - q.shape[1]]
    nu = nu0 + free.shape[1]
    y = free.T @ residual
    total = nu0 * sigma**2 + float(y @ y)
    found = []
    for kernel, sizes in kernels:
        values, vectors = np.linalg.eigh(free.T @ kernel @ free)
        along = (vectors.T @ y) ** 2
        for size in sizes:
            factor = 1.0 + size**2 * np.maximum(values, 0.0)
            rest = nu0 * sigma**2 + float(np.sum(along / factor))
            found.append(-0.5 * float(np.log(factor).sum()) - 0.5 * nu * np.log(rest / total))
    return np.array(found)
