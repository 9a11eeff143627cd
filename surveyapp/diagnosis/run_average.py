"""North of one short run, averaged over the base model and everything that its points may hide.

The base keeps most of the prior until something is proved: from a dozen points a search finds
whatever it looks for, and the model that it finds narrows the sigma for nothing. The members are
Gaussian: each effect of the catalogue at each of its grid points in two sizes, one and two slips,
one and two shifts, a wandering north; constant, amplitude and damping are flat beneath them.
Noise that is correlated from reading to reading moves no north and is a member too, by its
likelihood with constant, amplitude and damping integrated out, averaged over the correlation: a
dozen such readings look like a drift, a step or nothing, and their mean is known far less well
than their scatter says.

Source: prediction.md B; O'Hagan & Forster (2004), Bayesian Inference, 11.11.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from surveyapp.core.statistics.distributions import student_quantile
from surveyapp.core.statistics.mixture import Mixture
from surveyapp.diagnosis.candidates import all_candidates
from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.fits import Fit, Member
from surveyapp.diagnosis.run_value import Value, functional, midpoint_part, value_of
from surveyapp.domain.priors import NU0
from surveyapp_models.arrays import Floats

BASE_PRIOR = 0.7
"""Fixed: learned from an archive it went to .03, since small amplitude laws hide in the damping,
and clean runs were covered too rarely (prediction.md B)."""
SIZES = (1.5, 5.0, 15.0)
"""Prior standard deviation of an effect at its largest reading, in those of a reading."""
GROSS_SIZES = (6.0, 20.0)
MOST, MOST_UNNAMED = 16, 24
"""Points up to which a run is short, and up to which while no name is proved."""
LEAST_TO_AVERAGE = 8
LEAST_WIDTH = 0.45
"""Of the base's interval, while no name is proved: two slips or a walk may hide in the rest. In
the simulation of ``bench short_runs`` the intervals of fired runs then hold as they say."""
SHARES = {
    "gross_error": 0.18,
    "two gross errors": 0.15,
    "midpoint_step": 0.04,
    "two shifts": 0.03,
    "wandering": 0.04,
    "correlated": 0.33,
}
OTHER_SHARE = 0.02
"""Prior of every other effect, before all are scaled to 1 - BASE_PRIOR. A slip of the pen is the
commonest cause: it counts three times as much here as well (``candidates.GROSS_WEIGHT``), and two
of them look like a step. Correlated readings count as much as both together: what errs in one
reading may err in its neighbour."""
CORRELATIONS = (0.3, 0.5, 0.7, 0.85)
"""Of neighbouring readings: those of ``stochastic`` that a dozen points tell from a constant."""


@dataclass(frozen=True, slots=True)
class _Group:
    """Members of one unit: columns (m, n, r) in units of a reading's sigma, what north takes."""

    unit: str
    columns: Floats
    rows: Floats


def is_short(case: Case, *, named: bool) -> bool:
    """Whether a run is averaged so."""
    return case.has_swing and case.size <= (MOST if named else MOST_UNNAMED)


def short_average(case: Case, base: Fit, *, named: bool) -> Value:
    """Averaged north of a short run in which something was seen, with an honest interval.

    From fewer points than a name needs nothing is taken out: the base stands with its own interval.
    Without a name the interval is not much narrower than the base's.
    """
    central = value_of(case, base)
    if case.size < LEAST_TO_AVERAGE:
        return central
    found, _ = run_average(case, base)
    least = 0.0 if named else LEAST_WIDTH * central.interval95
    if found.interval95 >= least:
        return found
    return Value(found.value, found.sigma * least / found.interval95, found.dof)


def run_average(case: Case, base: Fit) -> tuple[Value, Mixture]:
    """Averaged north [SI] of a short run and how it is spread about it."""
    n, design = case.size, base.design
    central = value_of(case, base)
    free = n - design.shape[1]
    sigma, nu0 = reading_noise(case, base)
    y = base.residual / sigma
    q, r = np.linalg.qr(design)
    row = np.linalg.solve(r.T, functional(case, base))
    nu = nu0 + free
    logs, means, variances = [], [], []
    groups = [g for g in _groups(case, base) if g.columns.size]
    total = sum(SHARES.get(g.unit, OTHER_SHARE) for g in groups)
    start = nu0 + float(y @ y)
    logs.append(np.array([np.log(BASE_PRIOR) - 0.5 * nu * np.log(start)]))
    means.append(np.zeros(1))
    variances.append(np.array([start / nu * float(row @ row)]))
    for group in groups:
        sizes = GROSS_SIZES if "gross" in group.unit else SIZES
        share = (1.0 - BASE_PRIOR) * SHARES.get(group.unit, OTHER_SHARE) / total
        prior = np.log(share / len(sizes) / len(group.columns))
        for size in sizes:
            found = _members(group, size, (q, row, y), (nu0, nu))
            logs.append(prior + found[0])
            means.append(found[1])
            variances.append(found[2])
    log = np.concatenate(logs)
    w = np.exp(log - log.max())
    w /= w.sum()
    mean = np.concatenate(means)
    shift = float(w @ mean)
    mixture = Mixture(w, sigma * (mean - shift), sigma**2 * np.concatenate(variances), max(nu, 1.0))
    half = mixture.half_width()
    value = central.value + sigma * shift
    return Value(value, half / student_quantile(0.975, max(nu, 1.0)), max(nu, 1.0)), mixture


def reading_noise(case: Case, base: Fit) -> tuple[float, float]:
    """Stated sigma of a reading and what it counts; the scatter, which counts nothing."""
    floor = max(case.noise_floor, 1e-12)
    free = case.size - base.design.shape[1]
    if case.sigma is not None:
        return max(float(np.median(case.sigma)), floor), NU0
    return max(float(np.sqrt(base.sum_of_squares / max(free, 1))), floor), 0.0


def _members(
    group: _Group, size: float, model: tuple[Floats, Floats, Floats], dof: tuple[float, float]
) -> tuple[Floats, Floats, Floats]:
    """Log likelihood beside the base, shift of north and its variance, all in sigmas.

    With flat columns Q (orthonormal) and K = size^2 X X' everything follows from the part of X that
    Q leaves: 1 + size^2 X'(1 - QQ')X has the determinant and the inverse (Woodbury).
    """
    q, row, y = model
    nu0, nu = dof
    x = size * group.columns
    along = np.einsum("np,mnr->mpr", q, x)
    left = x - np.einsum("np,mpr->mnr", q, along)
    gram = np.einsum("mnr,mns->mrs", left, left)
    gram[:, np.arange(gram.shape[1]), np.arange(gram.shape[1])] += 1.0
    inverse = np.linalg.inv(gram)
    score = np.einsum("mnr,n->mr", left, y)
    b = np.einsum("mrs,ms->mr", inverse, score)
    rest = np.maximum(nu0 + float(y @ y) - np.einsum("mr,mr->m", b, score), 1e-12)
    log = -0.5 * np.linalg.slogdet(gram)[1] - 0.5 * nu * np.log(rest)
    # north takes rows of X by itself and loses what X takes from the flat columns
    takes = size * group.rows - np.einsum("p,mpr->mr", row, along)
    mean = np.einsum("mr,mr->m", takes, b)
    spread = float(row @ row) + np.einsum("mr,mrs,ms->m", takes, inverse, takes)
    return log, mean, rest / nu * spread


def _groups(case: Case, base: Fit) -> Iterator[_Group]:
    n = case.size
    for candidate in all_candidates(case, base.theta):
        if candidate.kind != "named" or candidate.count > 1 or not candidate.points:
            continue
        if candidate.is_slip:
            yield _gross(n, 1, "gross_error")
            yield _gross(n, 2, "two gross errors")
            continue
        columns = candidate.columns
        rows = np.stack(
            [midpoint_part(case, base, Member(candidate, g)) for g in range(len(columns))]
        )
        scale = np.max(np.abs(columns), axis=1, keepdims=True)
        scale = np.where(scale > 0.0, scale, 1.0)
        yield _Group(candidate.id, columns / scale, rows / scale[:, 0, :])
    yield from _shifts(case)
    yield _wandering(case)
    roots = correlated_roots(case.position)
    yield _Group("correlated", roots, np.zeros((len(roots), case.size)))


def _gross(n: int, count: int, unit: str) -> _Group:
    """So many slips at every place; none of them moves north."""
    places = list(itertools.combinations(range(n), count))
    columns = np.zeros((len(places), n, count))
    for m, chosen in enumerate(places):
        columns[m, chosen, np.arange(count)] = 1.0
    return _Group(unit, columns, np.zeros((len(places), count)))


def _shifts(case: Case) -> Iterator[_Group]:
    """Two shifts of north between any points."""
    places = np.unique(case.position)[1:]
    pairs = list(itertools.combinations(places.tolist(), 2))
    if not pairs:
        return
    columns = np.stack(
        [np.column_stack([case.position >= p, case.position >= q]) for p, q in pairs]
    ).astype(np.float64)
    yield _Group("two shifts", columns, np.einsum("n,mnr->mr", case.value_weights, columns))


def _wandering(case: Case) -> _Group:
    """A random walk of north, as the root of its covariance, 1 at the end of the run."""
    u = (case.position - case.position.min()) / max(float(np.ptp(case.position)), 1e-12)
    walk = np.minimum(u[:, None], u[None, :])
    values, vectors = np.linalg.eigh(walk)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    return _Group("wandering", root[None], (case.value_weights @ root)[None])


def correlated_roots(position: Floats) -> Floats:
    """Roots of the covariances rho^|i - j| of readings at some positions, shape (m, n, n).

    The readings err so beside their own noise; north does not move.
    """
    lag = np.abs(position[:, None] - position[None, :]) / float(
        np.median(np.diff(np.sort(position)))
    )
    return np.asarray(np.linalg.cholesky(np.array([rho**lag for rho in CORRELATIONS])))
