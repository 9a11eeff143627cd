"""What a diagnosis refuses to begin with."""

from __future__ import annotations

from surveyapp.diagnosis.problem import Problem
from surveyapp.errors import Problem as InputProblem
from surveyapp.errors import SurveyError


def check_input(problem: Problem, confirm: Problem | None) -> None:
    """Raise a SurveyError with everything that is wrong with a problem and its second set."""
    faults = []
    least = problem.base_parameters + 1
    if problem.sigma_known and not problem.has_swing:
        least = 2
    if problem.size < least:
        faults.append(
            InputProblem(
                "too few observations to diagnose anything",
                problem.identity,
                f"{problem.size}",
                f"at least {least}; from 8 on an effect can be named",
                "Observe more, or use the result of orient with its own sigma.",
            )
        )
    if confirm is not None:
        if confirm.subject != problem.subject:
            faults.append(
                InputProblem(
                    "the second set is of another subject",
                    confirm.identity,
                    confirm.subject,
                    problem.subject,
                    "Confirm with an independent record of the same kind.",
                )
            )
        elif confirm.instrument != problem.instrument:
            faults.append(
                InputProblem(
                    "the second set is of another instrument",
                    confirm.identity,
                    confirm.instrument or "no instrument",
                    problem.instrument or "no instrument",
                    "An effect is confirmed by another record of the same instrument.",
                )
            )
        if confirm.size < confirm.base_parameters + 1:
            faults.append(
                InputProblem(
                    "too few observations in the second set",
                    confirm.identity,
                    f"{confirm.size}",
                    f"at least {confirm.base_parameters + 1}",
                )
            )
    if faults:
        raise SurveyError(faults)
