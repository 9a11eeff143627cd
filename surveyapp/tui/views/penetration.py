"""The pages of a breakthrough: blocks of the record, and what is tried in a few words."""

from __future__ import annotations

from surveyapp.api import Trial
from surveyapp.domain.penetration_result import Prediction
from surveyapp.io.decimals import typed_number
from surveyapp.report.blocks import Block
from surveyapp.report.numbers import plain
from surveyapp.report.sections import penetration as section
from surveyapp.tui import texts

CHECKS_STEP = 5
"""The step with readings, recorded again and again."""


def pages(result: Prediction) -> dict[str, tuple[Block, ...]]:
    """Blocks by the id of their page."""
    return {
        "budget": (
            *section.prediction(result),
            *section.budget(result),
            *section.warnings(result),
        ),
        "evaluation": section.evaluation(result),
        "steps": (section.steps(result),),
    }


def state_text(result: Prediction) -> str:
    """The lateral prediction against what is allowed, in a few words."""
    sigma = result.sigma.lateral_m or 0.0
    allowed = ""
    if result.tolerance is not None and result.tolerance.lateral_m is not None:
        limit = result.tolerance.lateral_m
        word = texts.MET if result.factor * sigma <= limit * (1.0 + 1e-12) else texts.NOT_MET
        allowed = texts.P_ALLOWED.format(limit=f"{limit:g}", word=word)
    return texts.P_STATE.format(value=plain(result.factor * sigma, 4), allowed=allowed)


def tried_text(trial: Trial, before: Prediction) -> str:
    """What is tried, and the number without it."""
    tried, parts = trial.tried, []
    if tried.added:
        sides = ", ".join(f"{at}-{to}" for at, to in tried.sides)
        parts.append(texts.P_SIDES.format(sides=sides))
    for on, text in (
        (tried.both_ends, texts.P_BOTH_ENDS),
        (tried.better_angles, texts.P_ANGLES),
        (tried.better_gyro, texts.P_GYRO),
    ):
        if on:
            parts.append(text)
    if tried.more_surveys:
        word = texts.P_SURVEY if tried.more_surveys == 1 else texts.P_SURVEYS
        parts.append(word.format(count=tried.more_surveys))
    if not parts:
        return texts.P_TRIED_NOTHING
    return texts.P_TRIED.format(what="; ".join(parts), before=plain(before.sigma.lateral_m, 4))


def typed_reading(text: str) -> float | None:
    """A reading as typed [mm], with a decimal point or comma; empty is none.

    Raises
    ------
    ValueError
        If it is no number.
    """
    return typed_number(text) if text else None


def step_of_row(result: Prediction, row: int) -> int:
    """Number of the step that stands in a row of the steps."""
    return int(section.steps(result).rows[row][0].split()[0])
