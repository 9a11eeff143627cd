"""What further readings would tell in a linear model with many rivals, whatever the subject.

Every rival has columns beside flat ones; the readings that are there weigh it, every reading that
an action may bring, drawn from the average, moves the weights and narrows what is wanted. The mean
over the draws is what the action is worth before it is made.

Source: prediction.md D; Lindley, D. V. (1956), Ann. Math. Statist. 27, 986; O'Hagan & Forster
(2004), Bayesian Inference, 11.11.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surveyapp.core.statistics.mixture import Mixture, half_widths
from surveyapp.diagnosis.action import Linear
from surveyapp.diagnosis.outlook import ActionResult
from surveyapp_models.arrays import Floats

DRAWS = 48
WIDTH_DRAWS = 24
LEAST_WEIGHT = 1e-3


@dataclass(frozen=True, slots=True)
class Rival:
    """Members of as many columns each, of all units and sizes.

    Parameters
    ----------
    units : tuple of str
        Of each member.
    places : ndarray of int, shape (m,)
        Of each member among those of its unit.
    log_prior : ndarray, shape (m,)
        Of each member.
    columns : ndarray, shape (m, n + k, r)
        What it does to the readings, in its prior standard deviations.
    now, then : ndarray, shape (m, r)
        What it adds to what is wanted, over the record and over record and action (north of a
        run is that of all its points).
    """

    units: tuple[str, ...]
    places: NDArray[np.intp]
    log_prior: Floats
    columns: Floats
    now: Floats
    then: Floats

    def some(self, chosen: NDArray[np.bool_]) -> Rival:
        """Only the chosen members."""
        parts = (part[chosen] for part in (self.log_prior, self.columns, self.now, self.then))
        units = tuple(u for u, keep in zip(self.units, chosen.tolist(), strict=True) if keep)
        return Rival(units, self.places[chosen], *parts)


def joined_rivals(rivals: Sequence[Rival]) -> list[Rival]:
    """Members of as many columns in one: the algebra is done for all of them at once."""
    found = []
    for count in sorted({item.columns.shape[2] for item in rivals}):
        own = [item for item in rivals if item.columns.shape[2] == count]
        found.append(
            Rival(
                tuple(unit for item in own for unit in item.units),
                np.concatenate([item.places for item in own]),
                np.concatenate([item.log_prior for item in own]),
                np.concatenate([item.columns for item in own]),
                np.concatenate([item.now for item in own]),
                np.concatenate([item.then for item in own]),
            )
        )
    return found


@dataclass(frozen=True, slots=True)
class State:
    """Members that count after the record, all in sigmas of a reading.

    Parameters
    ----------
    y : ndarray, shape (n,)
        Residuals of the base model.
    rows : Linear
    groups : sequence of Rival
        Only members that count; log_prior is that of each member of a group.
    weights : sequence of ndarray
        Of the members of each group; they sum to 1 over all groups.
    posterior : sequence of (ndarray, ndarray, ndarray)
        Coefficients (m, r), a root of their covariance (m, r, r), left squares (m,).
    nu0, nu : float
        Degrees of freedom of the stated sigma, and with the record's own.
    quiet : frozenset of str
        Units that are no rivals of anything for what is wanted.
    stands : tuple of float
        Weight of the likeliest cause, and half-width of what is wanted, as they stand.
    """

    y: Floats
    rows: Linear
    groups: Sequence[Rival]
    weights: Sequence[Floats]
    posterior: Sequence[tuple[Floats, Floats, Floats]]
    nu0: float
    nu: float
    quiet: frozenset[str]
    stands: tuple[float, float]

    @classmethod
    def of(
        cls,
        y: Floats,
        rows: Linear,
        groups: Sequence[Rival],
        nu0: float,
        *,
        quiet: frozenset[str] = frozenset(),
        stands: tuple[float, float] | None = None,
    ) -> State:
        """Weigh all members by the record and keep those that count.

        ``stands`` saves computing what is known already.
        """
        n = rows.first
        flat = _kept(rows.flat[:n])
        q, nu = np.linalg.qr(flat)[0], nu0 + n - flat.shape[1]
        parts = [_solved(g.columns[:, :n], q, y[None, :], nu0) for g in groups]
        logs, top, total = _log_weights(groups, parts, nu)
        now = stands or _as_it_stands(rows, groups, parts, (logs, top, total, nu), quiet=quiet)
        kept, weights, posterior = [], [], []
        for group, part, log in zip(groups, parts, logs, strict=True):
            w = np.exp(log - top) / total
            chosen = w > LEAST_WEIGHT / total
            if not chosen.any():
                continue
            kept.append(group.some(chosen))
            weights.append(w[chosen])
            root = np.asarray(np.linalg.cholesky(part.inverse[chosen]), dtype=np.float64)
            posterior.append((part.b[chosen, 0], root, part.rest[chosen, 0]))
        norm = sum(float(w.sum()) for w in weights)
        shares = [w / norm for w in weights]
        return cls(y, rows, kept, shares, posterior, nu0, nu, quiet, now)


def _log_weights(
    groups: Sequence[Rival], parts: Sequence[_Solved], nu: float
) -> tuple[list[Floats], float, float]:
    """Log weights of the members of each group, their largest, and the sum beside it."""
    logs = [
        g.log_prior - 0.5 * p.log_det - 0.5 * nu * np.log(p.rest[:, 0])
        for g, p in zip(groups, parts, strict=True)
    ]
    top = max(float(log.max()) for log in logs)
    return logs, top, sum(float(np.exp(log - top).sum()) for log in logs)


def weighed(y: Floats, flat: Floats, group: Rival, nu0: float) -> tuple[Floats, Floats]:
    """Weights (m,) of the members of one group by the record alone, and their coefficients (m, r).

    The weights are those beside the likeliest member.
    """
    q, nu = np.linalg.qr(flat)[0], nu0 + flat.shape[0] - flat.shape[1]
    part = _solved(group.columns, q, y[None, :], nu0)
    logs, top, _ = _log_weights([group], [part], nu)
    return np.exp(logs[0] - top), np.asarray(part.b[:, 0])


def counting(state: State) -> dict[str, NDArray[np.intp]]:
    """Places of the members that count, by unit."""
    found: dict[str, set[int]] = {}
    for group in state.groups:
        for unit, place in zip(group.units, group.places.tolist(), strict=True):
            found.setdefault(unit, set()).add(place)
    return {unit: np.array(sorted(places), dtype=np.intp) for unit, places in found.items()}


@dataclass(frozen=True, slots=True)
class _Solved:
    """Members beside flat columns: log determinant, coefficients, left squares, covariance."""

    log_det: Floats
    b: Floats
    rest: Floats
    inverse: Floats
    left: Floats


def _kept(flat: Floats) -> Floats:
    """The flat columns that say something in these rows."""
    return np.asarray(flat[:, np.abs(flat).max(axis=0) > 0.0])


def _solved(x: Floats, q: Floats, y: Floats, nu0: float) -> _Solved:
    """X (m, n, r) beside the orthonormal q (n, p) on each row of y (d, n)."""
    left = x - q @ (q.T @ x)
    r = x.shape[2]
    gram = np.swapaxes(left, 1, 2) @ left + np.eye(r)
    inverse = np.linalg.inv(gram)
    free = y - (y @ q) @ q.T
    score = free @ left
    b = np.asarray(score @ inverse)  # the inverse is symmetric
    squares = np.einsum("dn,dn->d", free, free)
    rest = np.maximum(nu0 + squares[None, :] - np.einsum("mdr,mdr->md", b, score), 1e-12)
    return _Solved(np.linalg.slogdet(gram)[1], b, rest, np.asarray(inverse), left)


def _wanted(
    columns: Floats, adds: Floats, rows: Linear, how: tuple[_Solved, Floats]
) -> tuple[Floats, Floats]:
    """What is wanted by each member (m, d) and its variance without the factor (m,).

    ``adds`` is what it takes of the columns, ``how`` the solution for the readings y (d, n).
    """
    solved, y = how
    flat = rows.flat
    q, r = np.linalg.qr(flat)
    row = np.linalg.solve(r.T, rows.wanted)
    takes = adds - np.einsum("n,mnr->mr", q @ row, columns)
    mean = np.einsum("mr,mdr->md", takes, solved.b) + (y @ q @ row)[None, :]
    spread = float(row @ row) + np.einsum("mr,mrs,ms->m", takes, solved.inverse, takes)
    return mean, spread


def _as_it_stands(
    rows: Linear,
    groups: Sequence[Rival],
    parts: Sequence[_Solved],
    how: tuple[Sequence[Floats], float, float, float],
    *,
    quiet: frozenset[str],
) -> tuple[float, float]:
    """Weight of the likeliest cause, and half-width of what is wanted [sigmas]."""
    logs, top, total, nu = how
    n = rows.first
    told = np.abs(rows.flat[:n]).max(axis=0) > 0.0
    own = Linear(rows.flat[:n, told], n, rows.wanted[told])
    share: dict[str, float] = {}
    means, spreads, weights = [], [], []
    for group, part, log in zip(groups, parts, logs, strict=True):
        w = np.exp(log - top) / total
        for unit, weight in zip(group.units, w.tolist(), strict=True):
            share[unit] = share.get(unit, 0.0) + weight
        zero = np.zeros((1, n))
        mean, spread = _wanted(group.columns[:, :n], group.now, own, (part, zero))
        means.append(mean[:, 0])
        spreads.append(part.rest[:, 0] / nu * spread)
        weights.append(w)
    mean, w = np.concatenate(means), np.concatenate(weights)
    mixture = Mixture(w, mean - float(w @ mean), np.concatenate(spreads), nu).main()
    rivals = {unit: v for unit, v in share.items() if unit not in quiet} or share
    return max(rivals.values()) / sum(rivals.values()), mixture.half_width()


def worth(
    state: State, action: tuple[str, str], rng: np.random.Generator, *, sigma: float
) -> ActionResult:
    """Expected separation and interval once an action's readings are there.

    Parameters
    ----------
    state : State
    action : tuple of str
        Its id and its text.
    rng : numpy.random.Generator
    sigma : float
        Of a reading [SI].
    """
    readings = _drawn(state, rng)
    flat = state.rows.flat
    q, nu = np.linalg.qr(flat)[0], state.nu0 + flat.shape[0] - flat.shape[1]
    logs, means, spreads = [], [], []
    units: list[str] = []
    for group in state.groups:
        solved = _solved(group.columns, q, readings, state.nu0)
        log = (group.log_prior - 0.5 * solved.log_det)[:, None] - 0.5 * nu * np.log(solved.rest)
        mean, spread = _wanted(group.columns, group.then, state.rows, (solved, readings))
        logs.append(log)
        means.append(mean)
        spreads.append(solved.rest / nu * spread[:, None])
        units += group.units
    log = np.concatenate(logs)
    w = np.exp(log - log.max(axis=0))
    w /= w.sum(axis=0)
    # the quiet ones alone where they are sure
    names = sorted(set(units) - state.quiet) or sorted(set(units))
    classes = np.array([[float(u == name) for name in names] for u in units])
    before = _shares(np.concatenate(state.weights)[None, :] @ classes)
    after = _shares(w.T @ classes)
    mean, spread = np.concatenate(means), np.concatenate(spreads)
    some = slice(0, WIDTH_DRAWS)
    half = half_widths(w.T[some], mean.T[some], spread.T[some], nu)
    return ActionResult(
        action=action[0],
        text=action[1],
        separation=float(after.max(axis=1).mean()),
        information=max(float(_entropy(before)[0] - _entropy(after).mean()), 0.0),
        interval95=float(np.mean(half)) * sigma,
    )


def _shares(share: Floats) -> Floats:
    return np.asarray(share / np.maximum(share.sum(axis=1, keepdims=True), 1e-300))


def _entropy(share: Floats) -> Floats:
    safe = np.where(share > 0.0, share, 1.0)
    return np.asarray(-(share * np.log(safe)).sum(axis=1))


def _drawn(state: State, rng: np.random.Generator) -> Floats:
    """The readings that are there, and what an action reads if a member drawn by weight is true.

    Returns
    -------
    ndarray, shape (draws, n + k)
    """
    flat, n = state.rows.flat, state.rows.first
    known = np.abs(flat[:n]).max(axis=0) > 0.0
    q, r = np.linalg.qr(flat[:n, known])
    every = np.concatenate(state.weights)
    # evenly through the weights: members are drawn as often as they weigh, not by chance
    places = (rng.random() + np.arange(DRAWS)) / DRAWS
    total = np.cumsum(every)
    chosen = np.minimum(np.searchsorted(total, places * total[-1]), every.size - 1)
    found, start = [], 0
    for group, w, (b, root, rest) in zip(state.groups, state.weights, state.posterior, strict=True):
        own = chosen[(chosen >= start) & (chosen < start + w.size)] - start
        start += w.size
        if not own.size:
            continue
        s = np.sqrt(rest[own] / rng.chisquare(state.nu, own.size))[:, None]
        noise = rng.standard_normal((own.size, b.shape[1]))
        coefficients = b[own] + s * np.einsum("mrs,ms->mr", root[own], noise)
        columns = np.einsum("mnr,mr->mn", group.columns[own], coefficients)
        explained = (state.y - columns[:, :n]) @ q
        level = np.linalg.solve(
            r, (explained + s * rng.standard_normal((own.size, r.shape[0]))).T
        ).T
        new = level @ flat[n:, known].T + columns[:, n:]
        new += s * rng.standard_normal(new.shape)
        found.append(np.hstack([np.tile(state.y, (own.size, 1)), new]))
    return np.asarray(rng.permutation(np.concatenate(found)))
