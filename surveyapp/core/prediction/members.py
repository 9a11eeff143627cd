"""Evidence and prediction of every member of the average: the linear algebra of it.

Members with at most one column beside the noise are done in closed form, all others by one Cholesky
factorization each, many at a time.

Source: prediction.md A, equations 6 to 8; Sherman & Morrison (1950), Ann. Math. Statist. 21, 124.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from surveyapp.core.prediction.kernels import kernels, step_columns
from surveyapp.core.prediction.plans import pairs, singles
from surveyapp.core.prediction.unseen import unseen
from surveyapp.domain.priors import (
    AMPLITUDES,
    BASE,
    GROSS,
    NU0,
    STEP,
    Priors,
)
from surveyapp_models.arrays import Floats

GROSS_VARIANCE = 36.0
"""A gross error is about six standard deviations."""
LEAST_NOISE = 1e-6
"""Bound below the noise of a determination, in squares of the median sigma."""
CHUNK = 64
"""Members that are factored at once: as many as fit into the cache."""


@dataclass(frozen=True, slots=True)
class Determinations:
    """Determinations of a constant and the later visits at which it is wanted.

    Parameters
    ----------
    values : ndarray, shape (n,)
        [rad].
    sigmas : ndarray, shape (n,), or None
        Stated, of what belongs to one determination alone [rad]; None = nobody states any.
    columns : mapping
        Circumstances, n determinations first and then the later visits, each of shape (n + q,); NaN
        = not told, at a later visit only.
    targets : ndarray, shape (t, n + q)
        What is wanted: weights (sum 1) of the constant at these visits.
    carried : ndarray, shape (n, r)
        Error contributions that determinations share, one column for each source [rad].
    scenarios : int
        Equally likely states of what later visits do not tell: the targets are those of the first
        state, then those of the second ...
    """

    values: Floats
    sigmas: Floats | None
    columns: Mapping[str, Floats]
    targets: Floats
    carried: Floats
    scenarios: int = 1

    @property
    def size(self) -> int:
        """Number of determinations."""
        return int(self.values.size)


@dataclass(frozen=True, slots=True)
class _Terms:
    """Sums of products of the members: A^-1 between the ones, y, carried and targets.

    Parameters
    ----------
    log_prior, log_det : ndarray, shape (m,)
    products : ndarray, shape (m, b, b)
    prior_cov : ndarray, shape (m, t, t)
        Of the cause at the targets.
    units : tuple of str
    sizes : tuple of int
        Which of ``AMPLITUDES``; -1 where a member has no size of its own.
    causes : tuple of tuple of str
        What is in it: of a pair both.
    """

    log_prior: Floats
    log_det: Floats
    products: Floats
    prior_cov: Floats
    units: tuple[str, ...]
    sizes: tuple[int, ...]
    causes: tuple[tuple[str, ...], ...]


@dataclass(frozen=True, slots=True)
class Members:
    """Every member with its weight and its prediction, in units of the median sigma.

    Parameters
    ----------
    units : tuple of str
    sizes : tuple of int
        Which of ``AMPLITUDES``; -1 where a member has no size of its own.
    log_evidence : ndarray, shape (m,)
        Without the prior.
    log_prior : ndarray, shape (m,)
    means : ndarray, shape (m, t)
    covariance : ndarray, shape (m, t, t)
    carried : ndarray, shape (m, t, r)
    beyond : ndarray, shape (m, t, t)
        Of the covariance, what lies beyond the range of the determinations adds.
    noise : ndarray, shape (m,)
        Variance factor of the determinations.
    dof, unit : float
        Degrees of freedom; the median sigma [rad].
    """

    units: tuple[str, ...]
    sizes: tuple[int, ...]
    log_evidence: Floats
    log_prior: Floats
    means: Floats
    covariance: Floats
    carried: Floats
    beyond: Floats
    noise: Floats
    dof: float
    unit: float

    @property
    def weights(self) -> Floats:
        """Posterior weights, sum 1."""
        log = self.log_evidence + self.log_prior
        found = np.exp(log - log.max())
        return np.asarray(found / found.sum())


def members(data: Determinations, priors: Priors) -> Members:
    """Evidence and prediction of the base and of every rival."""
    n = data.size
    unit, nu0 = _unit(data)
    centre = float(np.median(data.values))
    y = (data.values - centre) / unit
    d = np.ones(n) if data.sigmas is None else (data.sigmas / unit) ** 2
    fixed = np.column_stack([np.ones(n), y, data.carried / unit])
    terms = _joined([*_low_rank(data, priors, d, fixed), *_dense(data, priors, d, fixed)])
    one, own = terms.products[:, 0, 0], terms.products[:, 0, 1]
    constant = own / one
    squares = np.maximum(terms.products[:, 1, 1] - own * constant, 0.0)
    nu = nu0 + n - 1.0
    spread = np.maximum(nu0 + squares, 1e-12)
    evidence = -0.5 * (terms.log_det + np.log(one) + nu * np.log(spread))
    b = fixed.shape[1]
    to = terms.products[:, b:, :]
    rest = 1.0 - to[:, :, 0]
    means = constant[:, None] * rest + to[:, :, 1]
    inner = (
        terms.prior_cov - to[:, :, b:] + rest[:, :, None] * rest[:, None, :] / one[:, None, None]
    )
    carried = to[:, :, 2:b] + rest[:, :, None] * (
        terms.products[:, None, 0, 2:b] / one[:, None, None]
    )
    extra = np.zeros_like(inner)
    for part in unseen(data.columns, y, d, data.targets, priors=priors):
        without = np.array([part.causes.isdisjoint(own) for own in terms.causes])
        extra[without] += part.covariance
    inner = inner + extra
    found = Members(
        units=terms.units,
        sizes=terms.sizes,
        log_evidence=evidence,
        log_prior=terms.log_prior,
        means=centre / unit + means,
        covariance=(spread / nu)[:, None, None] * inner,
        carried=carried,
        beyond=(spread / nu)[:, None, None] * extra,
        noise=spread / nu,
        dof=nu,
        unit=unit,
    )
    return found if data.scenarios == 1 else _in_every_state(found, data.scenarios)


def _in_every_state(found: Members, count: int) -> Members:
    """Each member once in each state of what is not told."""
    t = found.means.shape[1] // count
    rows = [slice(k * t, (k + 1) * t) for k in range(count)]
    return Members(
        units=found.units * count,
        sizes=found.sizes * count,
        log_evidence=np.tile(found.log_evidence, count),
        log_prior=np.tile(found.log_prior, count) - np.log(count),
        means=np.concatenate([found.means[:, k] for k in rows]),
        covariance=np.concatenate([found.covariance[:, k, k] for k in rows]),
        carried=np.concatenate([found.carried[:, k] for k in rows]),
        beyond=np.concatenate([found.beyond[:, k, k] for k in rows]),
        noise=np.tile(found.noise, count),
        dof=found.dof,
        unit=found.unit,
    )


def _unit(data: Determinations) -> tuple[float, float]:
    """Median stated sigma and what it counts; without one the scatter, which counts nothing."""
    if data.sigmas is not None:
        return float(np.median(data.sigmas)), NU0
    scatter = float(np.std(data.values, ddof=1))
    return (scatter if scatter > 0.0 else 1e-9), 0.0


def _joined(parts: list[_Terms]) -> _Terms:
    return _Terms(
        np.concatenate([p.log_prior for p in parts]),
        np.concatenate([p.log_det for p in parts]),
        np.concatenate([p.products for p in parts]),
        np.concatenate([p.prior_cov for p in parts]),
        tuple(u for p in parts for u in p.units),
        tuple(k for p in parts for k in p.sizes),
        tuple(c for p in parts for c in p.causes),
    )


def _low_rank(data: Determinations, priors: Priors, d: Floats, fixed: Floats) -> Iterator[_Terms]:
    """The base, steps and gross errors: at most one column beside the noise."""
    n, t = data.size, data.targets.shape[0]
    none, nothing = np.zeros((1, n)), np.zeros((1, t))
    yield _rank_one(d, fixed, none, nothing, how=(np.zeros(1), [priors.share(BASE)], BASE, -1))
    steps = step_columns(data.columns, n)
    share = priors.share(STEP)
    if len(steps) and share > 0.0:
        later = steps @ data.targets.T
        for k, (a, size) in enumerate(zip(AMPLITUDES, priors.sizes, strict=True)):
            prior = np.full(len(steps), share * size / len(steps))
            variance = np.full(len(steps), a * a)
            yield _rank_one(d, fixed, steps[:, :n], later, how=(variance, prior, STEP, k))
    share = priors.share(GROSS)
    if share > 0.0:
        prior, variance = np.full(n, share / n), np.full(n, GROSS_VARIANCE)
        yield _rank_one(d, fixed, np.eye(n), np.zeros((n, t)), how=(variance, prior, GROSS, -1))


def _rank_one(
    d: Floats, fixed: Floats, x: Floats, later: Floats, *, how: tuple[Floats, object, str, int]
) -> _Terms:
    """Members with K = variance x x' (Sherman & Morrison), x of shape (m, n), later (m, t)."""
    variance, prior, unit, size = how
    weighted = x / d
    along = weighted @ fixed
    square = np.einsum("mn,mn->m", weighted, x)
    shrink = 1.0 / (1.0 + variance * square)
    b, t = fixed.shape[1], later.shape[1]
    products = np.empty((len(x), b + t, b + t))
    products[:, :b, :b] = (fixed.T / d) @ fixed - (
        (variance * shrink)[:, None, None] * along[:, :, None] * along[:, None, :]
    )
    to = (variance * shrink)[:, None, None] * later[:, :, None] * along[:, None, :]
    products[:, b:, :b] = to
    products[:, :b, b:] = np.swapaxes(to, 1, 2)
    both = later[:, :, None] * later[:, None, :]
    products[:, b:, b:] = (variance**2 * shrink * square)[:, None, None] * both
    with np.errstate(divide="ignore"):
        log_prior = np.log(np.asarray(prior, dtype=np.float64))
    return _Terms(
        log_prior,
        float(np.log(d).sum()) - np.log(shrink),
        products,
        variance[:, None, None] * both,
        (unit,) * len(x),
        (size,) * len(x),
        ((unit,),) * len(x),
    )


def _dense(data: Determinations, priors: Priors, d: Floats, fixed: Floats) -> Iterator[_Terms]:
    """Members whose covariance must be factored, some at a time."""
    n, targets = data.size, data.targets
    found = kernels(data.columns, n)
    own = np.stack([k.matrix[:n, :n] for k in found])
    cross = np.stack([targets @ k.matrix[:, :n] for k in found])
    ends = np.stack([targets @ k.matrix @ targets.T for k in found])
    plan = [*singles(found, priors), *pairs(found, priors)]
    for start in range(0, len(plan), CHUNK):
        part = plan[start : start + CHUNK]
        mix = np.zeros((len(part), len(found)))
        for row, item in enumerate(part):
            for place, variance in item.causes:
                mix[row, place] = variance
        a = np.tensordot(mix, own, axes=1)
        a[:, np.arange(n), np.arange(n)] += d
        k = np.tensordot(mix, cross, axes=1)
        log_det, products = _bordered(a, k, fixed)
        yield _Terms(
            np.log(np.array([item.prior for item in part])),
            log_det,
            products,
            np.tensordot(mix, ends, axes=1),
            tuple(item.unit for item in part),
            tuple(item.size for item in part),
            tuple(tuple(found[place].unit for place, _ in item.causes) for item in part),
        )


def _bordered(a: Floats, k: Floats, fixed: Floats) -> tuple[Floats, Floats]:
    """Log determinants of A and all products under its inverse, from one factorization.

    The Cholesky factor of [[A, B], [B', C]] has L^-1 B below L, whatever large C is.
    """
    m, n = a.shape[:2]
    b, t = fixed.shape[1], k.shape[1]
    whole = np.zeros((m, n + b + t, n + b + t))
    whole[:, :n, :n] = a
    whole[:, n : n + b, :n] = fixed.T
    whole[:, n + b :, :n] = k
    bound = np.einsum("mij,mij->m", whole[:, n:, :n], whole[:, n:, :n])
    corner = np.arange(n, n + b + t)
    whole[:, corner, corner] = (1.0 + 4.0 * bound / LEAST_NOISE)[:, None]
    factor = np.linalg.cholesky(whole)
    below = factor[:, n:, :n]
    log_det = 2.0 * np.log(factor[:, np.arange(n), np.arange(n)]).sum(axis=1)
    return log_det, below @ np.swapaxes(below, 1, 2)
