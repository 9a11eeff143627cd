"""The result of one session as sections of text: the chain, the checks, the budget."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.text import Text

from surveyapp.domain.project import Project
from surveyapp.domain.results import AngleResult, OrientationResult
from surveyapp.languages import translated
from surveyapp.report.numbers import line_name, seconds, with_sigma
from surveyapp.report.sections import azimuths, checks, constants, reduction
from surveyapp.tui import texts
from surveyapp.tui.views.blocks import blocks_as_text
from surveyapp.tui.widgets.constants import draw_constant
from surveyapp_models.angles import AngleUnit, format_angle

if TYPE_CHECKING:
    from surveyapp.core.practice.simulated_instrument import PracticeOutcome

CONSTANT_HEIGHT = 11
"""Rows of the drawing of the constant among the other sections."""


def result_headline(result: OrientationResult, session: str, unit: AngleUnit) -> str:
    """The one number that the session was made for, as far as it goes."""
    for line in result.lines:
        name = line_name(line.station, line.target)
        if line.grid_azimuth is not None:
            return _headline(name, texts.COL_GRID, line.grid_azimuth, unit)
        if line.true_azimuth is not None:
            label = texts.R_TRUE.format(
                reference=translated((line.true_azimuth.reference or "").lower())
            )
            return _headline(name, label, line.true_azimuth, unit)
        return _headline(name, texts.COL_AZIMUTH, line.gyro_azimuth, unit)
    own = next(item for item in result.sessions if item.id == session)
    if own.gyro_north is not None:
        return _headline(own.station, texts.COL_NORTH, own.gyro_north, unit)
    if own.main is not None and own.main.gyro_azimuth is not None:
        name = line_name(own.station, own.main.target)
        return _headline(name, texts.COL_AZIMUTH, own.main.gyro_azimuth, unit)
    return texts.R_NO_LINE


def _headline(name: str, label: str, angle: AngleResult, unit: AngleUnit) -> str:
    value, sigma, interval = with_sigma(angle, unit)
    return f'{name}  {label} {value}  ±{sigma}"  (95 % ±{interval}")'


def result_text(project: Project, result: OrientationResult, session: str, width: int) -> Text:
    """The blocks of the record on one session and its lines, with the constant drawn."""
    own = next(item for item in result.sessions if item.id == session)
    parts = [blocks_as_text(azimuths.line_blocks(project, line), width) for line in result.lines]
    parts.append(blocks_as_text(reduction.session_blocks(project, own), width))
    parts.append(blocks_as_text(constants.blocks(result), width))
    parts += [
        drawing
        for constant in result.constants
        if constant.value is not None
        and (drawing := draw_constant(constant, width, CONSTANT_HEIGHT))
    ]
    parts.append(blocks_as_text(checks.blocks(result.checks, result.warnings), width))
    return Text("\n\n").join(part for part in parts if part)


def truth_text(outcome: PracticeOutcome | None, unit: AngleUnit) -> str:
    """Truth against the result of a practice session."""
    if outcome is None:
        return ""
    verdict = texts.PRACTICE_HOLDS if outcome.inside else texts.PRACTICE_MISSES
    truth = texts.PRACTICE_TRUTH.format(
        truth=format_angle(outcome.truth, unit),
        error=seconds(outcome.error, 1, sign=True),
        interval=seconds(outcome.interval95, 1),
        verdict=verdict,
    )
    hidden = texts.PRACTICE_HIDDEN.format(effect=translated(outcome.effect.replace("_", " ")))
    return f"{truth}\n{hidden if outcome.effect else texts.PRACTICE_CLEAN}"
