"""What a diagnosis refuses to begin with."""

from __future__ import annotations

import numpy as np

from surveyapp.diagnosis.case import Case
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said
from surveyapp_models.angles import wrap_pi_array

LEAST_CONFIRMING_RUN = 6
"""Turning points of a second run: fewer leave its own fit so free that it confirms anything."""
REPEATED = 0.8
"""Share of equal readings from which one run is a copy of the other and not a second one."""
SHARED_STRETCH = 0.75
"""Share of the shorter run over which they are compared."""
EQUAL = 1e-9
"""Readings [rad], and other observations in printed units, that differ by less are the same."""


def check_input(problem: Case, confirm: Case | None) -> None:
    """Raise a SurveyError with everything that is wrong with a problem and its second set."""
    faults = []
    least = problem.base_parameters + 1
    if problem.sigma_known and not problem.has_swing:
        least = 2
    if problem.size < least:
        faults.append(
            Problem(
                "too few observations to diagnose anything",
                problem.identity,
                f"{problem.size}",
                said("at least {least}; from 8 on an effect can be named", least=least),
                "Observe more, or use the result of orient with its own sigma.",
            )
        )
    if confirm is not None:
        faults += _second_set(problem, confirm)
    if faults:
        raise SurveyError(faults)


def _second_set(problem: Case, confirm: Case) -> list[Problem]:
    """What is wrong with a second set: it must be of the same thing, and another record of it."""
    if confirm.subject != problem.subject:
        return [
            Problem(
                "the second set is of another subject",
                confirm.identity,
                confirm.subject,
                problem.subject,
                "Confirm with an independent record of the same kind.",
            )
        ]
    faults = []
    if confirm.instrument != problem.instrument:
        faults.append(
            Problem(
                "the second set is of another instrument",
                confirm.identity,
                confirm.instrument or "no instrument",
                problem.instrument or "no instrument",
                "An effect is confirmed by another record of the same instrument.",
            )
        )
    # sessions bear names of their own; parts of a campaign and unnamed traverses do not
    same = bool(confirm.identity) and confirm.identity == problem.identity
    if same and problem.has_swing:
        faults.append(_no_second(confirm, "the record itself"))
    elif repeats(problem, confirm):
        faults.append(
            _no_second(
                confirm,
                said("the observations of {identity}", identity=problem.identity or "the first"),
            )
        )
    least = confirm.base_parameters + 1
    if confirm.has_swing:
        least = max(least, LEAST_CONFIRMING_RUN)
    if confirm.size < least:
        faults.append(
            Problem(
                "too few observations in the second set",
                confirm.identity,
                f"{confirm.size}",
                said("at least {least}", least=least),
                "Confirm with a longer record.",
            )
        )
    return faults


def _no_second(confirm: Case, found: str) -> Problem:
    return Problem(
        "the second set is no second set: it would confirm whatever it chose",
        said("confirm, {identity}", identity=confirm.identity),
        found,
        "another record of the same instrument, observed independently",
        "Confirm with a run that had no part in the diagnosis.",
    )


def repeats(problem: Case, confirm: Case) -> bool:
    """Whether a second set holds the observations of the first, of a run also in part.

    Independent turning points differ by the noise of their readings and by their amplitude; a book
    that was copied and cut, or changed in a row or two, agrees in most of them exactly.
    """
    first = problem.observations + problem.offset
    second = confirm.observations + confirm.offset
    if not problem.has_swing:
        apart = EQUAL * problem.scale
        return first.shape == second.shape and bool(np.all(np.abs(first - second) < apart))
    shorter, longer = sorted((first, second), key=len)
    least = max(2, int(np.ceil(SHARED_STRETCH * shorter.size)))
    for shift in range(least - shorter.size, longer.size - least + 1):
        a = shorter[max(0, -shift) : longer.size - shift]
        b = longer[max(0, shift) : max(0, shift) + a.size]
        if a.size < least:
            continue
        # the drift of the tape zero is taken out about its mean, which a cut shifts
        offset = wrap_pi_array(a - b)
        if np.mean(np.abs(offset - np.median(offset)) < EQUAL) >= REPEATED:
            return True
    return False
