"""Which rivals of the last depth are heard, and which names all of them have.

Source: diagnosis.md step 4.
"""

from __future__ import annotations

from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.compare import Level, within_margin
from surveyapp.diagnosis.fits import Fit
from surveyapp.diagnosis.wandering import refuted

NAMED_DEPTH = 2
"""Effects that enter later are named only when a second set confirms them. Noise that wanders does
not end the search before: two effects at once look like it."""
LEAST_TO_NAME = 8


def heard(
    problem: Case, levels: list[Level], *, confirmed: bool
) -> tuple[tuple[Fit, ...], list[str]]:
    """The rivals that are told, and the names that all of them have.

    A generic shape keeps a first name off only against its odds; beside a first effect it is heard
    like any other, since what that effect describes badly is left as a shape. Where there is no
    name it is told as what it is.
    """
    last, asked = levels[-1], problem.levels
    first = asked.shape_odds if last.depth == 1 else 0.0
    for odds in sorted({first, 0.0}, reverse=True):
        near = within_margin(last, asked.margin, odds)
        chosen = standing(last, near)
        near = tuple(
            f for f in near if f is chosen or chosen is None or not refuted(problem, chosen, f)
        )
        names = names_in(problem, levels, near, confirmed=confirmed)
        if names:
            break
    return near, names


def standing(level: Level, near: tuple[Fit, ...]) -> Fit | None:
    """The set that stands for those that are told: the preferred one, if it is among them."""
    if level.preferred is not None and any(fit is level.preferred for fit in near):
        return level.preferred
    return next((fit for fit in near if fit.noise is None), near[0] if near else None)


def names_in(
    problem: Case, levels: list[Level], near: tuple[Fit, ...], *, confirmed: bool
) -> list[str]:
    """Ids of named effects that are in every set within the margin."""
    if problem.size < LEAST_TO_NAME:
        return []
    common = frozenset.intersection(*[fit.key for fit in near])
    named = {m.candidate.id for f in near for m in f.members if m.candidate.kind == "named"}
    found = [i for i in near[0].effects if i in common & named]
    if confirmed or len(levels) - 1 <= NAMED_DEPTH:
        return found
    early = levels[NAMED_DEPTH].preferred
    return [i for i in found if early is not None and i in early.key]
