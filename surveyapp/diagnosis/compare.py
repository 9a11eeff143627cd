"""Which sets of effects explain the record about equally well.

Sets of one depth are compared by BIC, never a deeper set with a shallower one: letting BIC decide
the depth overfits badly. All gross errors together count as one effect. The stochastic rivals
compete at every depth.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from surveyapp.diagnosis.candidates import Candidate
from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.drawn import drawn_gain, is_drawn
from surveyapp.diagnosis.fits import (
    Fit,
    Member,
    bic_of,
    fit_members,
    is_spoilt,
    odds_against,
    scan_exact,
    scan_law,
    with_noise,
)
from surveyapp.diagnosis.nulls import reductions
from surveyapp.diagnosis.projection import project
from surveyapp_models.arrays import Floats

MARGIN = 4.0
"""BIC by which every rival must be worse (diagnosis.md step 4), where no simulation of the subject
says how much will do."""
BETTER = 3.0
"""BIC by which a set that spans the simpler one must be better to be heard beside it."""
FULL_SIZE = 12
"""Observations from which the margin is the specification's own."""
ANCHORS = 8
"""Best sets of one depth from which those of the next are built."""
REFINED = 12.0
"""Sets whose approximate BIC lies within this of the best are fitted exactly."""
COUNT_LEVEL = 0.05
"""Probability of taking a sound reading for one more gross error."""
GROSS_SHARE = 6
"""At most one observation in so many is taken for a gross error."""
SPANNED = 0.05
"""Share of a fitted effect that may be left beside a rival that spans it."""


def margin(fit: Fit, asked: float = MARGIN) -> float:
    """BIC by which every rival must be worse than a fit.

    From few observations BIC overrates a difference: it counts all n, and n - p are free.
    """
    n = fit.residual.size
    if n >= FULL_SIZE:
        return asked
    base = fit.design.shape[1] - sum(m.candidate.size for m in fit.members)
    return float(asked * n / max(n - base, 1))


@dataclass(frozen=True, slots=True)
class Level:
    """All sets of one depth.

    Parameters
    ----------
    depth : int
    fits : tuple of Fit
        The best exact fit of each set, best first; deterministic ones only.
    noises : tuple of Fit
        Those with a stochastic rival that compete at this depth, best first.
    """

    depth: int
    fits: tuple[Fit, ...]
    noises: tuple[Fit, ...]

    @property
    def every(self) -> tuple[Fit, ...]:
        """Deterministic and stochastic sets, best first."""
        return tuple(sorted((*self.fits, *self.noises), key=lambda fit: fit.bic))

    @property
    def stochastic(self) -> bool:
        """Whether correlated noise alone beats every deterministic set by the margin."""
        pure = [fit.score for fit in self.noises if not fit.members]
        sets = [fit.score for fit in self.fits]
        return bool(pure) and bool(sets) and min(pure) + MARGIN <= min(sets)

    @property
    def preferred(self) -> Fit | None:
        """The best deterministic set, or a simpler one within the margin that it merely spans."""
        if not self.fits:
            return None
        best = self.fits[0]
        simpler = [f for f in self.fits[1:] if f.bic < best.bic + MARGIN and spans(best, f)]
        return min(simpler, key=lambda fit: (fit.parameters, fit.bic)) if simpler else best


def base_level(problem: Case) -> Level:
    """The model that stands, alone."""
    fit = fit_members(problem, ())
    return Level(0, (fit,), with_noise(problem, fit))


def orthonormal_design(fit: Fit) -> Floats:
    """Orthonormal basis of the columns of a fit and of its own errors, dependent ones dropped."""
    design = fit.design if fit.hidden is None else np.hstack([fit.design, fit.hidden])
    norms = np.sqrt((design**2).sum(axis=0))
    unit = design / np.where(norms > 0.0, norms, 1.0)
    u, s, _ = np.linalg.svd(unit, full_matrices=False)
    return np.asarray(u[:, s > 1e-9 * s[0]])


def most_parameters(problem: Case) -> float:
    """Parameters beyond which a set is not considered: half the observations, five at least.

    Nuisance unknowns take as many observations with them and count on neither side.
    """
    return max(5.0, 0.5 * (problem.size - problem.nuisance)) + problem.nuisance


def may_join(candidate: Candidate, fit: Fit, *, most: float) -> bool:
    """Whether a candidate can be added: one description of the amplitude, every effect once."""
    if candidate.columns.shape[0] == 0:
        return False
    least = fit.parameters + float(candidate.charge.min())
    if least > most:
        return False
    if candidate.describes_amplitude and any(m.candidate.describes_amplitude for m in fit.members):
        return False
    if candidate.effect is not None and candidate.effect.acts_on == "observation":
        return may_join_gross(candidate, fit)
    return candidate.id not in fit.key


def may_join_gross(candidate: Candidate, fit: Fit) -> bool:
    """All gross errors together are one effect: single ones may follow while they stay few."""
    known = sum(m.candidate.count for m in fit.members if m.candidate.id == candidate.id)
    few = known + candidate.count <= max(1, fit.residual.size // GROSS_SHARE)
    return few and (known == 0 or candidate.count == 1)


Draft = tuple[float, tuple[Member, ...], Fit]
"""Approximate BIC, members, and the set that was added to."""


def next_level(problem: Case, level: Level, candidates: Iterable[Candidate]) -> Level:
    """Best fit of every set that has one candidate more than the best sets of a level."""
    drafts = _drafts(problem, level, tuple(candidates))
    if not drafts:
        return Level(level.depth + 1, (), ())
    best = min(bic for bic, _, _ in drafts.values())
    exact: dict[frozenset[str], dict[int, Fit]] = {}
    for (names, count), (bic, members, anchor) in drafts.items():
        if level.depth == 0 or bic <= best + REFINED:
            fit = _refined(problem, members, anchor, every=level.depth > 0)
            exact.setdefault(names, {})[count] = fit
    fits = [settled_count(problem, counts) for counts in exact.values()]
    fits.sort(key=lambda fit: fit.bic)
    least = min(fit.bic for fit in fits)
    fits = [scored(problem, fit) if fit.bic < least + REFINED else fit for fit in fits]
    noises = [*level.noises]
    for fit in level.fits[:ANCHORS]:
        noises += with_noise(problem, fit)
    unique = {fit.key: fit for fit in sorted(noises, key=lambda f: -f.bic)}
    ordered = sorted(unique.values(), key=lambda fit: fit.bic)
    return Level(level.depth + 1, tuple(fits), tuple(ordered))


def _drafts(
    problem: Case, level: Level, pool: tuple[Candidate, ...]
) -> dict[tuple[frozenset[str], int], Draft]:
    """Best addition for each set of names and each number of gross errors in it."""
    drafts: dict[tuple[frozenset[str], int], Draft] = {}
    for anchor in level.fits[:ANCHORS]:
        q = orthonormal_design(anchor)
        for candidate in pool:
            if not may_join(candidate, anchor, most=most_parameters(problem)):
                continue
            found = _best_addition(problem, anchor, candidate, q)
            if found is None:
                continue
            bic, members = found
            key = (anchor.key | {candidate.id}, sum(m.candidate.count for m in members))
            if key not in drafts or bic < drafts[key][0]:
                drafts[key] = (bic, members, anchor)
    return drafts


def settled_count(problem: Case, counts: Mapping[int, Fit]) -> Fit:
    """As many gross errors as each prove themselves beside the others.

    Fits of the same effects with more and more gross errors. A further one is taken for real when
    chance shows as large a reduction among all the places it could lie at less often than the
    gate allows: F test, Bonferroni over the places. BIC would take every tenth record of 20 for one
    with two. Several at once may prove themselves where one alone does not: they hide each other.
    """
    order = sorted(counts)
    chosen = order[0]
    for count in order[1:]:
        fewer, more = counts[chosen], counts[count]
        added = count - chosen
        dof = problem.size - more.design.shape[1]
        if dof < 1:
            break
        places = math.comb(max(problem.size - chosen, added), added)
        left = max(more.sum_of_squares, problem.size * problem.noise_floor**2, 1e-300)
        f = (fewer.sum_of_squares - more.sum_of_squares) / added / (left / dof)
        if f > f_limit(COUNT_LEVEL / places, added, dof):
            chosen = count
    return counts[chosen]


def f_limit(p: float, upper: int, lower: int) -> float:
    """Value of F that chance exceeds with probability p."""
    from scipy.special import fdtri

    return float(fdtri(upper, lower, 1.0 - p))


def _best_addition(
    problem: Case, anchor: Fit, candidate: Candidate, q: Floats
) -> tuple[float, tuple[Member, ...]] | None:
    """Best grid point of a candidate beside an anchor and the approximate BIC there."""
    item = project(candidate, q)
    if item.index.size == 0:
        return None
    if anchor.theta is not None and not anchor.members and candidate.is_law:
        rss = scan_law(problem, candidate, anchor.members, anchor.theta)[item.index]
    elif anchor.theta is not None and not anchor.members and slip_bends(candidate, anchor):
        rss = scan_exact(problem, candidate, anchor.members, anchor.theta)[item.index]
    else:
        rss = anchor.sum_of_squares - reductions(item, anchor.residual)
    total = anchor.parameters + candidate.charge[item.index]
    bics = bic_of(problem, rss, total)
    g = int(np.argmin(bics))
    members = (*anchor.members, Member(candidate, int(item.index[g])))
    if is_drawn(problem, candidate):
        gain = drawn_gain(problem, anchor.design, [members[-1].columns], anchor.residual)
        searched = (members[-1].charge - candidate.size) * math.log(problem.size)
        return anchor.bic - gain + searched + candidate.odds, members
    return float(bics[g]) + odds_against(members), members


def slip_bends(candidate: Candidate, fit: Fit) -> bool:
    """Whether gross errors must be fitted one by one beside a fit."""
    return candidate.is_slip and is_spoilt(fit)


def _refined(problem: Case, members: tuple[Member, ...], anchor: Fit, *, every: bool) -> Fit:
    """Exact fit; the grid of every member is searched again beside the others."""
    start = anchor.theta
    fit = fit_members(problem, members, start)
    if not every:
        return fit
    for position, member in enumerate(members):
        others = tuple(m for i, m in enumerate(members) if i != position)
        if len(member.candidate.points) < 2:
            continue
        if member.candidate.is_law and fit.theta is not None:
            rss = scan_law(problem, member.candidate, others, fit.theta)
            bics = bic_of(problem, rss, fit.parameters)
            g = int(np.argmin(bics))
        else:
            without = fit_members(problem, others, fit.theta)
            draft = _best_addition(problem, without, member.candidate, orthonormal_design(without))
            if draft is None:
                continue
            g = draft[1][-1].g
        if g == member.g:
            continue
        changed = tuple(
            Member(m.candidate, g) if i == position else m for i, m in enumerate(members)
        )
        trial = fit_members(problem, changed, fit.theta)
        if trial.bic < fit.bic:
            fit, members = trial, changed
    return fit


def charged(fit: Fit, odds: float) -> float:
    """Score of a fit with ``odds`` BIC for each generic shape in it."""
    shapes = {m.candidate.id for m in fit.members if m.candidate.kind == "shape"}
    return fit.score + odds * len(shapes)


def within_margin(level: Level, asked: float = MARGIN, odds: float = 0.0) -> tuple[Fit, ...]:
    """The best set and every rival that is not worse by the margin, nested supersets dropped.

    Parameters
    ----------
    level : Level
    asked : float
        The margin.
    odds : float
        BIC that each generic shape is charged beforehand.
    """
    best = level.preferred
    if best is None:
        return level.every[:1]
    score = {id(fit): charged(fit, odds) for fit in level.every}
    own = score[id(best)]
    limit = min(score.values()) + margin(best, asked)
    # A shape says that something is there, not that no cause would do: causes are heard longer.
    patience = asked if best.is_generic else 0.0
    near = [
        f
        for f in level.every
        if f.key != best.key and score[id(f)] < limit + (0.0 if f.is_generic else patience)
    ]
    rivals = [f for f in near if score[id(f)] <= own - BETTER or not spans(f, best)]
    # What a smaller set within the margin explains needs no more.
    rivals = [f for f in rivals if not any(g.key < f.key for g in rivals)]
    chosen = (best,) if own < limit or not rivals else ()
    return tuple(sorted((*chosen, *rivals), key=lambda fit: (fit.bic, fit is not best)))


def scored(problem: Case, fit: Fit) -> Fit:
    """The fit with its scans paid for by the evidence.

    A scan over G points of which only one explains the record costs 2 log G; one of which many do
    costs little. The sum over the grid, each point with the same prior, is what BIC replaces by
    one parameter.
    """
    if problem.sigma_known:
        return fit
    score = fit.bic
    for position, member in enumerate(fit.members):
        if len(member.candidate.points) < 2:
            continue
        others = tuple(m for i, m in enumerate(fit.members) if i != position)
        rss = np.append(_profile(problem, fit, member, others), fit.sum_of_squares)
        bics = bic_of(problem, rss, 0.0)
        weight = float(np.exp(-0.5 * (bics[:-1] - bics.min())).sum())
        searched = member.charge - member.candidate.size
        score += 2.0 * float(np.log(len(member.candidate.points) / max(weight, 1.0)))
        score -= searched * float(np.log(problem.size))
    return replace(fit, score=score)


def _profile(problem: Case, fit: Fit, member: Member, others: tuple[Member, ...]) -> Floats:
    """Sum of squares at each separable grid point of a member beside the others."""
    if member.candidate.is_law and fit.theta is not None:
        return scan_law(problem, member.candidate, others, fit.theta)
    without = fit_members(problem, others, fit.theta)
    item = project(member.candidate, orthonormal_design(without))
    return np.asarray(without.sum_of_squares - reductions(item, without.residual))


def spans(rival: Fit, fit: Fit) -> bool:
    """Whether a rival is a superset: it spans what the fit adds to the base and pays more.

    Only a generic shape, or the same effects with more gross errors, can be one: another named
    effect is another explanation, however flexible it is.
    """
    if rival.noise is not None or fit.noise is not None:
        return False
    generic = any(m.candidate.kind == "shape" for m in rival.members)
    if rival.parameters <= fit.parameters or not (generic or rival.key == fit.key):
        return False
    q = orthonormal_design(rival)
    signal = added_signal(fit)
    left = signal - q @ (q.T @ signal)
    norms = np.sqrt((signal**2).sum(axis=0))
    allowed = SPANNED * norms
    if generic:
        # A generic shape that imitates the effect to within the noise is no other explanation.
        dof = max(fit.residual.size - fit.parameters, 1.0)
        allowed = np.maximum(allowed, np.sqrt(fit.sum_of_squares / dof))
    return bool(np.all(np.sqrt((left**2).sum(axis=0)) <= allowed))


def added_signal(fit: Fit) -> Floats:
    """Fitted contribution of each member, beside the base (weighted), shape (n, members)."""
    laws = 1 if fit.law is not None else 0
    swing = 0 if fit.theta is None else 2 + laws
    additive = sum(m.candidate.size for m in fit.members if not m.candidate.is_law)
    first = fit.design.shape[1] - swing - additive
    base = [*range(first), *range(first + additive, fit.design.shape[1] - laws)]
    q, _ = np.linalg.qr(fit.design[:, base])
    signals, at = [], first
    for member in fit.members:
        if member.candidate.is_law and fit.theta is not None:
            part = fit.design[:, -1] * fit.theta[2]
        else:
            size = member.candidate.size
            part = fit.design[:, at : at + size] @ fit.linear[at : at + size]
            at += size
        signals.append(part - q @ (q.T @ part))
    return np.column_stack(signals) if signals else np.zeros((fit.design.shape[0], 0))


def best_with(level: Level, identity: str) -> Fit | None:
    """Best set of a level that contains an effect."""
    return next((fit for fit in level.every if identity in fit.key), None)
