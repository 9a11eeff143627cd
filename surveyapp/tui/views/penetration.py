"""A prediction as rows of text; the numbers are those of the result."""

from __future__ import annotations

import math

from surveyapp.api import Trial
from surveyapp.domain.penetration import STEP_TITLES, ProcedureStep
from surveyapp.domain.penetration_result import Prediction
from surveyapp.languages import shown, translated
from surveyapp.tui import texts

BUDGET_COLUMNS = (
    texts.COL_CAUSE,
    texts.COL_HEADING,
    texts.COL_LATERAL,
    texts.COL_ALONG,
    texts.COL_VERTICAL,
)
EVALUATION_COLUMNS = (
    texts.COL_CAUSE,
    texts.COL_COMPONENT,
    texts.COL_WOULD_BE,
    texts.COL_SIGMAS,
)
STEP_COLUMNS = (texts.COL_STEP, texts.COL_DONE, texts.COL_BY)


def number(value: float | None, decimals: int = 4) -> str:
    """A number, - where it is not determined."""
    return "-" if value is None else f"{value:.{decimals}f}"


def state_text(result: Prediction) -> str:
    """The lateral prediction against what is allowed, in a few words."""
    sigma = result.sigma.lateral_m or 0.0
    allowed = ""
    if result.tolerance is not None and result.tolerance.lateral_m is not None:
        limit = result.tolerance.lateral_m
        word = texts.MET if result.factor * sigma <= limit * (1.0 + 1e-12) else texts.NOT_MET
        allowed = texts.P_ALLOWED.format(limit=f"{limit:g}", word=word)
    return texts.P_STATE.format(
        factor=f"{result.factor:g}",
        sigma=number(sigma),
        value=number(result.factor * sigma),
        allowed=allowed,
    )


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
    return texts.P_TRIED.format(what="; ".join(parts), before=number(before.sigma.lateral_m))


def budget_rows(result: Prediction) -> list[tuple[str, ...]]:
    """Every cause, the total last."""
    rows = [
        (
            translated(cause.source.replace("_", " ")),
            cause.heading or texts.P_COMMON,
            number(cause.lateral_m),
            number(cause.longitudinal_m),
            number(cause.vertical_m),
        )
        for cause in result.budget
    ]
    return [*rows, (texts.P_TOTAL, "", *(number(value) for value in result.sigma.components()))]


def evaluation_rows(result: Prediction) -> list[tuple[str, ...]]:
    """What each cause alone would have to be."""
    if result.measured is None:
        return []
    return [
        (
            f"{translated(item.effect.replace('_', ' '))} {item.subject}".strip(),
            translated(item.component),
            f"{item.needed:+.4g} {item.unit}",
            number(item.sigmas, 1),
        )
        for item in result.measured.candidates
    ]


def evaluation_text(result: Prediction) -> str:
    """The test of the measured miss."""
    test = result.measured
    if test is None:
        return texts.P_NOT_MEASURED
    t = " ".join("-" if value is None else f"{value:+.2f}" for value in test.t)
    verdict = translated(test.verdict.replace("_", " "))
    return texts.P_MISS.format(
        t=t, chi2=f"{test.chi2:.2f}", p=f"{test.p:.4f}", verdict=verdict, text=shown(test.text)
    )


CHECKS_STEP = 5
"""The step with readings, recorded again and again."""


def typed_reading(text: str) -> float | None:
    """A reading as typed [mm]; empty is none.

    Raises
    ------
    ValueError
        If it is no number.
    """
    if not text:
        return None
    value = float(text)
    if not math.isfinite(value):
        raise ValueError(text)
    return value


def step_of_row(result: Prediction, row: int) -> int:
    """Number of the step that stands in a row."""
    return int(step_rows(result)[row][0].split()[0])


def step_rows(result: Prediction) -> list[tuple[str, ...]]:
    """The six steps with every entry that is recorded of them."""
    rows: list[tuple[str, ...]] = []
    for number_, title in enumerate(STEP_TITLES, start=1):
        name = f"{number_} {title}"
        entries = [step for step in result.steps if step.id == number_]
        rows += [(name, step.done_at or texts.P_OPEN, step.by) for step in entries]
        if not entries:
            rows.append((name, texts.P_OPEN, ""))
    return rows


def step_notes(result: Prediction) -> list[str]:
    """Readings, file and note of each row of the steps."""
    notes: list[str] = []
    for number_ in range(1, len(STEP_TITLES) + 1):
        entries = [step for step in result.steps if step.id == number_]
        notes += [_note(step) for step in entries] or [""]
    return notes


def _note(step: ProcedureStep) -> str:
    parts = [
        text.format(value=value)
        for text, value in (
            (texts.P_CENTRE, step.centre_line_mm),
            (texts.P_WAIST, step.waist_line_mm),
        )
        if value is not None
    ]
    return "; ".join(part for part in (*parts, step.file, step.note) if part)
