"""What to observe next at a run: two more points, the other side, a run later, another observer.

The members of the average of a short run, weighed by the points that are there, say what each
action would read: what the instrument does recurs with the same coefficient, what happened once
does not recur (north stays where a step left it until the instrument is set up anew), what an
observer does is his own. Every such reading moves the weights and narrows north.

Source: prediction.md D with the members of B; Lindley, D. V. (1956), Ann. Math. Statist. 27, 986.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from surveyapp.core.statistics.mixture import Mixture, half_widths
from surveyapp.diagnosis.candidates import single_effects
from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.fits import Fit
from surveyapp.diagnosis.outlook import ActionResult, Outlook
from surveyapp.diagnosis.run_average import reading_noise
from surveyapp.diagnosis.run_rivals import SLIPS, Design, Rival, RunAction, design_of, rivals_of
from surveyapp.languages import said
from surveyapp_models.arrays import Floats

LEAST, MOST = 6, 60
"""Turning points of a run for which advice is given."""
DRAWS = 48
WIDTH_DRAWS = 24
LEAST_WEIGHT = 1e-3


RUN_ACTIONS = (
    RunAction("two_points", said("read two more turning points"), anew=False),
    RunAction(
        "reversed_start", said("observe a second run now, begun on the other side"), reversed=True
    ),
    RunAction("second_run", said("observe a second run in four hours, set up anew"), later=True),
    RunAction(
        "other_observer", said("let another observer do a second run now"), other_observer=True
    ),
)


def run_advice(case: Case, base: Fit, rng: np.random.Generator) -> Outlook | None:
    """What each action after a run would tell; None where there are too few points to say.

    Parameters
    ----------
    case : Case
        A swing.
    base : Fit
        Its base model.
    rng : numpy.random.Generator
    """
    if not case.has_swing or not LEAST <= case.size <= MOST or base.theta is None:
        return None
    noise, candidates = reading_noise(case, base), single_effects(case, base.theta)
    now: tuple[float, float] | None = None
    results = []
    for action in RUN_ACTIONS:
        design = design_of(case, base, action)
        groups = rivals_of(case, candidates, design, action)
        state = _State.of(base.residual / noise[0], design, groups, noise[1], north=now)
        now = state.north
        results.append(_worth(state, action, rng, noise[0]))
    results.sort(key=lambda item: (-item.information, item.interval95))
    assert now is not None
    return Outlook(now[0], now[1] * noise[0], tuple(results), said("north at"))


@dataclass(frozen=True, slots=True)
class _State:
    """Members that count after the run, all in sigmas of a reading.

    Parameters
    ----------
    y : ndarray, shape (n,)
        Residuals of the base model.
    design : Design
    groups : sequence of Rival
        Only members that count; log_prior is that of each member of a group.
    weights : sequence of ndarray
        Of the members of each group; they sum to 1 over all groups.
    posterior : sequence of (ndarray, ndarray, ndarray)
        Coefficients (m, r), a root of their covariance (m, r, r), left squares (m,).
    nu0, nu : float
        Degrees of freedom of the stated sigma, and with the run's own.
    north : tuple of float
        Weight of the likeliest cause, and half-width of north as they stand.
    """

    y: Floats
    design: Design
    groups: Sequence[Rival]
    weights: Sequence[Floats]
    posterior: Sequence[tuple[Floats, Floats, Floats]]
    nu0: float
    nu: float
    north: tuple[float, float]

    @classmethod
    def of(
        cls,
        y: Floats,
        design: Design,
        groups: Sequence[Rival],
        nu0: float,
        *,
        north: tuple[float, float] | None = None,
    ) -> _State:
        """Weigh all members by the run and keep those that count; north if it is known already."""
        n = design.first
        flat = _kept(design.flat[:n])
        q, nu = np.linalg.qr(flat)[0], nu0 + n - flat.shape[1]
        parts = [_solved(g.columns[:, :n], q, y[None, :], nu0) for g in groups]
        logs = [
            g.log_prior - 0.5 * p.log_det - 0.5 * nu * np.log(p.rest[:, 0])
            for g, p in zip(groups, parts, strict=True)
        ]
        top = max(float(log.max()) for log in logs)
        total = sum(float(np.exp(log - top).sum()) for log in logs)
        now = north or _north_now(design, groups, parts, (logs, top, total, nu))
        kept, weights, posterior = [], [], []
        for group, part, log in zip(groups, parts, logs, strict=True):
            w = np.exp(log - top) / total
            chosen = w > LEAST_WEIGHT / total
            if not chosen.any():
                continue
            kept.append(group.some(chosen))
            weights.append(w[chosen])
            root = np.linalg.cholesky(part.inverse[chosen])
            posterior.append((part.b[chosen, 0], root, part.rest[chosen, 0]))
        norm = sum(float(w.sum()) for w in weights)
        return cls(y, design, kept, [w / norm for w in weights], posterior, nu0, nu, now)


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


def _north(
    columns: Floats, rows: Floats, flat: Floats, how: tuple[_Solved, Floats]
) -> tuple[Floats, Floats]:
    """North of each member (m, d) and its variance without the factor (m,).

    ``rows`` is what north takes of the columns, ``how`` the solution for the readings y (d, n).
    """
    solved, y = how
    q, r = np.linalg.qr(flat)
    wanted = np.zeros(flat.shape[1])
    wanted[0] = 1.0
    row = np.linalg.solve(r.T, wanted)
    takes = rows - np.einsum("n,mnr->mr", q @ row, columns)
    mean = np.einsum("mr,mdr->md", takes, solved.b) + (y @ q @ row)[None, :]
    spread = float(row @ row) + np.einsum("mr,mrs,ms->m", takes, solved.inverse, takes)
    return mean, spread


def _north_now(
    design: Design,
    groups: Sequence[Rival],
    parts: Sequence[_Solved],
    how: tuple[Sequence[Floats], float, float, float],
) -> tuple[float, float]:
    """Weight of the likeliest cause, and half-width of north over the run [sigmas]."""
    logs, top, total, nu = how
    n = design.first
    flat = _kept(design.flat[:n])
    share: dict[str, float] = {}
    means, spreads, weights = [], [], []
    for group, part, log in zip(groups, parts, logs, strict=True):
        w = np.exp(log - top) / total
        for unit, weight in zip(group.units, w.tolist(), strict=True):
            share[unit] = share.get(unit, 0.0) + weight
        zero = np.zeros((1, n))
        mean, spread = _north(group.columns[:, :n], group.run, flat, (part, zero))
        means.append(mean[:, 0])
        spreads.append(part.rest[:, 0] / nu * spread)
        weights.append(w)
    mean, w = np.concatenate(means), np.concatenate(weights)
    mixture = Mixture(w, mean - float(w @ mean), np.concatenate(spreads), nu).main()
    rivals = {unit: v for unit, v in share.items() if unit not in SLIPS} or share
    return max(rivals.values()) / sum(rivals.values()), mixture.half_width()


def _worth(
    state: _State, action: RunAction, rng: np.random.Generator, sigma: float
) -> ActionResult:
    """Expected separation and interval once an action's readings are there."""
    readings = _drawn(state, rng)
    flat = state.design.flat
    q, nu = np.linalg.qr(flat)[0], state.nu0 + flat.shape[0] - flat.shape[1]
    logs, means, spreads = [], [], []
    units: list[str] = []
    for group in state.groups:
        solved = _solved(group.columns, q, readings, state.nu0)
        log = (group.log_prior - 0.5 * solved.log_det)[:, None] - 0.5 * nu * np.log(solved.rest)
        mean, spread = _north(group.columns, group.both, flat, (solved, readings))
        logs.append(log)
        means.append(mean)
        spreads.append(solved.rest / nu * spread[:, None])
        units += group.units
    log = np.concatenate(logs)
    w = np.exp(log - log.max(axis=0))
    w /= w.sum(axis=0)
    names = sorted(set(units) - SLIPS) or sorted(set(units))  # slips alone where they are sure
    classes = np.array([[float(u == name) for name in names] for u in units])
    before = _shares(np.concatenate(state.weights)[None, :] @ classes)
    after = _shares(w.T @ classes)
    mean, spread = np.concatenate(means), np.concatenate(spreads)
    some = slice(0, WIDTH_DRAWS)
    half = half_widths(w.T[some], mean.T[some], spread.T[some], nu)
    return ActionResult(
        action=action.id,
        text=action.text,
        separation=float(after.max(axis=1).mean()),
        information=max(float(_entropy(before)[0] - _entropy(after).mean()), 0.0),
        interval95=float(np.mean(half)) * sigma,
    )


def _shares(share: Floats) -> Floats:
    return np.asarray(share / np.maximum(share.sum(axis=1, keepdims=True), 1e-300))


def _entropy(share: Floats) -> Floats:
    safe = np.where(share > 0.0, share, 1.0)
    return np.asarray(-(share * np.log(safe)).sum(axis=1))


def _drawn(state: _State, rng: np.random.Generator) -> Floats:
    """The readings that are there, and what an action reads if a member drawn by weight is true.

    Returns
    -------
    ndarray, shape (draws, n + k)
    """
    flat, n = state.design.flat, state.design.first
    known = np.abs(flat[:n]).max(axis=0) > 0.0
    q, r = np.linalg.qr(flat[:n, known])
    every = np.concatenate(state.weights)
    chosen = np.sort(rng.choice(every.size, DRAWS, p=every / every.sum()))
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


__all__ = ["RUN_ACTIONS", "RunAction", "run_advice"]
