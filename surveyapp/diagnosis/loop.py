"""The loop: test, name, refit, test again; then prove, and say what could not be told apart.

Greedy forward while the gate fires; then the sets of the depth that was reached are compared; a
name must be in every set within the margin, must help to predict what did not choose it and must
be missed when it is removed. Deterministic for a given input. Nothing is ever adopted silently:
diagnosing returns a new value, the model that stands is not touched.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from surveyapp.diagnosis.candidates import Candidate, all_candidates
from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.compare import (
    MARGIN,
    Level,
    base_level,
    best_with,
    most_parameters,
    next_level,
    orthonormal_design,
    spans,
)
from surveyapp.diagnosis.fits import Fit, fit_members, with_noise
from surveyapp.diagnosis.gate import Gate, open_gate
from surveyapp.diagnosis.held_out import confirm_rms, flagged, leave_one_out, unforetold
from surveyapp.diagnosis.rivals import NAMED_DEPTH, heard, standing
from surveyapp.diagnosis.run_value import plausible
from surveyapp.diagnosis.wandering import imitates
from surveyapp.languages import said, term
from surveyapp_models.arrays import Floats

DEFAULT_DRAWS = 4000
DEPTHS = ((45, 4), (20, 3), (12, 2), (8, 1))
"""At most so many effects from so many observations on (diagnosis.md step 6)."""
NOISE_MARGIN = 2.0 * MARGIN
"""BIC by which noise that wanders must be worse: it is no single rival but stands for every shape
that it may take by chance. By simulation of walks and of drifts and steps beside them
(docs/reference/operating-characteristics.md)."""
LEAST_TOGETHER = 3
APART = 3.0
"""Combined sigmas by which coefficients of two sets may differ."""
NOISE_WORDS = {
    "random_walk": said("a north that wanders at random"),
    "amplitude_walk": said("a following that is irregular at random"),
    "ar1": said("correlated noise"),
}


WANDERING_CHANNEL = said("a bias that wanders at random")
"""Of channels side by side, which have no north."""


def noise_words(problem: Case, kind: str) -> str:
    """A noise in words, as it shows in a record of this kind."""
    if kind == "random_walk" and problem.series is not None:
        return WANDERING_CHANNEL
    return NOISE_WORDS[kind]


@dataclass(frozen=True, slots=True)
class Search:
    """What the search found, before it is put into words.

    Parameters
    ----------
    levels : tuple of Level
        From the base model to the depth that was reached.
    gates : tuple of Gate
        One beside the best deterministic set of each level.
    near : tuple of Fit
        Sets of the last depth within the margin, best first; empty at depth 0.
    adopted : tuple of str
        Names.
    refused : tuple of (str, str)
        Names that were in every set but failed a proof, and which.
    implausible : mapping of str to Fit
        Effects whose coefficients lay outside their physical range, and the fit in which.
    after : Fit
        The base model with the adopted effects.
    best : Fit
        The best set of the last depth.
    pool : tuple of Candidate
        Candidates beside the base model.
    """

    levels: tuple[Level, ...]
    gates: tuple[Gate, ...]
    near: tuple[Fit, ...]
    adopted: tuple[str, ...]
    refused: tuple[tuple[str, str], ...]
    implausible: Mapping[str, Fit]
    after: Fit
    best: Fit
    pool: tuple[Candidate, ...]

    @property
    def unexplained(self) -> bool:
        """Whether something is left in the residuals of the best set after the last depth."""
        return self.gates[-1].fired


def deepest(size: int) -> int:
    """How many effects a record of this size can carry."""
    return next((depth for least, depth in DEPTHS if size >= least), 1)


def search(problem: Case, *, draws: int, confirm: Case | None) -> Search:
    """Run steps 2 to 6 of the algorithm."""
    levels = [base_level(problem)]
    base = levels[0].fits[0]
    pool = all_candidates(problem, base.theta)
    gates: list[Gate] = []
    implausible: dict[str, Fit] = {}
    current = pool
    while True:
        fit = levels[-1].preferred or base
        gates.append(open_gate(problem, fit, current, draws))
        done = len(levels) - 1 >= deepest(problem.size)
        wandering = len(levels) > NAMED_DEPTH and levels[-1].stochastic
        if not gates[-1].fired or done or wandering:
            break
        level, dropped = _possible(problem, next_level(problem, levels[-1], current))
        implausible |= {name: fit for name, fit in dropped.items() if name not in implausible}
        if not level.fits:
            break
        levels.append(level)
        theta = (level.preferred or base).theta
        current = pool if theta is None else all_candidates(problem, theta)
    last = levels[-1]
    if last.depth == 0:
        return Search(tuple(levels), tuple(gates), (), (), (), implausible, base, base, pool)
    near, names = heard(problem, levels, confirmed=confirm is not None)
    chosen = standing(last, near) or base
    proofs = Proofs(current, draws, confirm)
    adopted, refused, after = _proved(problem, chosen, names, base, proofs=proofs)
    return Search(
        tuple(levels),
        tuple(gates),
        near,
        adopted,
        refused,
        implausible,
        after,
        chosen,
        pool,
    )


def _possible(problem: Case, level: Level) -> tuple[Level, dict[str, Fit]]:
    """Drop sets with too many parameters or coefficients outside their physical range."""
    kept: list[Fit] = []
    dropped: dict[str, Fit] = {}
    for fit in level.fits:
        if fit.parameters > most_parameters(problem):
            continue
        outside = set(plausible(problem, fit))
        if not outside:
            kept.append(fit)
        elif len(fit.members) == 1 or level.depth > 1:
            dropped |= {name: fit for name in outside if name not in dropped}
    allowed = [f for f in level.noises if f.parameters <= most_parameters(problem)]
    return Level(level.depth, tuple(kept), tuple(allowed)), dropped


@dataclass(frozen=True, slots=True)
class Proofs:
    """What the proofs need beside the fits."""

    pool: tuple[Candidate, ...]
    draws: int
    confirm: Case | None


def _proved(
    problem: Case, best: Fit, names: list[str], base: Fit, *, proofs: Proofs
) -> tuple[tuple[str, ...], tuple[tuple[str, str], ...], Fit]:
    """Keep the names that predict better and are missed when removed; fit them jointly."""
    refused: list[tuple[str, str]] = []
    names = list(names)
    while names:
        after = reduced(problem, best, names)
        failure = _failure(problem, after, names, proofs)
        if failure is None:
            return tuple(names), tuple(refused), after
        refused.append(failure)
        names.remove(failure[0])
    return (), tuple(refused), base


def reduced(problem: Case, fit: Fit, names: Iterable[str]) -> Fit:
    """The same fit with only the members of the given ids."""
    keep = set(names)
    members = [m for m in fit.members if m.candidate.id in keep]
    return fit_members(problem, members, fit.theta if fit.theta is not None else None)


def _failure(problem: Case, after: Fit, names: list[str], proofs: Proofs) -> tuple[str, str] | None:
    """First adopted effect that fails a proof and why, else None."""
    mask = unforetold(after)
    with_all = leave_one_out(problem, after, mask)
    for name in names:
        without = reduced(problem, after, [n for n in names if n != name])
        if without.bic <= after.bic:
            return name, said("the model is as good without it")
        if slips_together(problem, after, name):
            return name, said("shifts of north that came and went would look the same")
        hidden = partly_missing(name, proofs.pool)
        if hidden:
            return name, said("{hidden} could look the same", hidden=hidden)
        if not significant(problem, without, name, proofs):
            return name, said("noise would show as much")
        gross = float(np.sum(flagged(after))) > float(np.sum(flagged(without)))
        if not gross:
            other = leave_one_out(problem, without, mask)
            if with_all is not None and other is not None and with_all >= other:
                return name, said("it does not help to predict observations that were left out")
        kind = imitating_noise(problem, after, without)
        if kind is not None:
            words = noise_words(problem, kind)
            return name, said("{kind} would look like it too often", kind=words)
        if proofs.confirm is not None and not is_event(after, name):
            failure = unconfirmed(proofs.confirm, after, without)
            failure = failure or other_coefficient(proofs.confirm, after, without, name)
            if failure is not None:
                return name, failure
    return None


def slips_together(problem: Case, after: Fit, name: str) -> bool:
    """Whether three and more slips follow each other on one side, which chance does not do.

    Of independent slips among 20 readings three stand so in one case of seventy; a north that
    shifted and came back, with the kicks of it, stands so often.
    """
    rows = [
        int(np.argmax(np.abs(column)))
        for member in after.members
        if member.candidate.id == name and member.candidate.effect is not None
        if member.candidate.effect.acts_on == "observation"
        for column in member.columns.T
    ]
    if len(rows) < LEAST_TOGETHER or problem.side is None:
        return False
    sides = {float(problem.side[row]) for row in rows}
    if len(sides) != 1:
        return False
    own = np.flatnonzero(problem.side == sides.pop())
    places = sorted(np.searchsorted(own, rows).tolist())
    return bool(places[-1] - places[0] == len(rows) - 1)


def partly_missing(name: str, pool: Iterable[Candidate]) -> str:
    """An effect that may look like a named one and lacks values here and there, else empty."""
    every = {c.id: c for c in pool if c.effect is not None}
    named = every.get(name)
    for other in every.values():
        if named is None or named.effect is None or other.effect is None:
            continue
        alike = other.id in named.effect.confusable_with or name in other.effect.confusable_with
        if alike and " missing at " in other.missing:
            return said(
                "{lower} cannot be tested ({missing}) and",
                lower=term(other.effect.title.lower()),
                missing=other.missing,
            )
    return ""


def significant(problem: Case, without: Fit, name: str, proofs: Proofs) -> bool:
    """Whether noise would rarely show an effect as strong, anywhere in its own scan.

    The gate may have been opened by another candidate. One that the model without it cannot be
    told from by its columns alone has no p value and is left to the other proofs.
    """
    gate = open_gate(problem, without, proofs.pool, proofs.draws)
    own = [test.p for test in gate.tests if test.id == name]
    return not own or own[0] is None or own[0] <= gate.level


def unconfirmed(confirm: Case, after: Fit, without: Fit) -> str | None:
    """Why a second set does not confirm an effect, else None."""
    here, there = confirm_rms(confirm, after), confirm_rms(confirm, without)
    if here is None or there is None:
        return said("the second set lacks what is needed to confirm it")
    return said("the second set is predicted no better with it") if here >= there else None


def is_event(fit: Fit, name: str) -> bool:
    """Whether a name stands for what happens once: it cannot recur in a second set."""
    effects = [m.candidate.effect for m in fit.members if m.candidate.id == name]
    return any(effect is not None and effect.event for effect in effects)


def other_coefficient(confirm: Case, after: Fit, without: Fit, name: str) -> str | None:
    """Why the coefficient of an instrument's effect is not that of the second set, else None.

    What belongs to the instrument has the same coefficient in both; a trend that chance made has
    not. Effects of one coefficient are compared, each beside the model without it.
    """
    member = next((m for m in after.members if m.candidate.id == name), None)
    if member is None or member.candidate.size != 1 or member.candidate.count != 1:
        return None
    base = fit_members(confirm, ())
    there = next((c for c in all_candidates(confirm, base.theta) if c.id == name), None)
    if there is None or not there.points:
        return None
    gaps = [sum(abs(p[k] - member.point.get(k, p[k])) for k in p) for p in there.points]
    columns = there.columns[int(np.argmin(gaps))][:, 0]
    first = along(without, member.columns[:, 0])
    second = along(base, columns)
    if first is None or second is None:
        return None
    apart = abs(first[0] - second[0])
    if apart <= APART * float(np.hypot(first[1], second[1])):
        return None
    return said("its coefficient in the second set is another one")


def along(fit: Fit, column: Floats) -> tuple[float, float] | None:
    """Coefficient of a column beside a fit, and its sigma; None where nothing of it is left."""
    q = orthonormal_design(fit)
    left = column - q @ (q.T @ column)
    square = float(left @ left)
    dof = fit.residual.size - q.shape[1] - 1
    if square <= 1e-8 * float(column @ column) or dof < 1:
        return None
    b = float(left @ fit.residual) / square
    rest = max(fit.sum_of_squares - b * b * square, 1e-300)
    return b, float(np.sqrt(rest / dof / square))


def imitating_noise(problem: Case, after: Fit, without: Fit) -> str | None:
    """Kind of noise that explains the record without an effect nearly as well, else None."""
    rivals = [
        fit
        for fit in with_noise(problem, without)
        if imitates(problem, after, fit, margin=NOISE_MARGIN)
    ]
    best = min(rivals, key=lambda fit: fit.bic, default=None)
    return None if best is None or best.noise is None else best.noise.kind


def rivals_delta(level: Level, identity: str) -> float | None:
    """How much worse (positive) the best set with an effect is than the best of its depth."""
    fit = best_with(level, identity)
    every = level.every
    return None if fit is None or not every else fit.bic - every[0].bic


def margin_of(level: Level, identity: str) -> float | None:
    """How much worse the best other explanation is than the best set with an effect.

    A set that merely contains it (more gross errors, a shape that spans it) is no other one.
    """
    fit = best_with(level, identity)
    if fit is None:
        return None
    others = [f for f in level.every if identity not in f.key and not spans(f, fit)]
    return min(f.score for f in others) - fit.score if others else None


__all__ = ["DEFAULT_DRAWS", "MARGIN", "Search", "deepest", "margin_of", "rivals_delta", "search"]
