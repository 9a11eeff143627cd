"""The result of one session as sections of text: the chain, the checks, the budget."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.text import Text

from surveyapp.domain.project import Project
from surveyapp.domain.results import (
    AngleResult,
    ConstantResult,
    LineResult,
    OrientationResult,
    SessionResult,
)
from surveyapp.languages import shown, translated
from surveyapp.tui import texts
from surveyapp.tui.cells import columns, padded
from surveyapp.tui.views.checks import ordered_checks, quantity_text
from surveyapp.tui.views.constants import constant_told
from surveyapp.tui.views.form import (
    angle_text,
    arcsec_text,
    interval_text,
    number_text,
    sigma_text,
)
from surveyapp.tui.views.lines import Row, budget_rows, chain_rows, helps_text
from surveyapp.tui.views.session import session_details
from surveyapp.tui.widgets.constants import draw_constant
from surveyapp.tui.widgets.records import pairs_text, table_text
from surveyapp_models.angles import AngleUnit, format_angle

if TYPE_CHECKING:
    from surveyapp.core.practice.simulated_instrument import PracticeOutcome

Section = tuple[str, Text]
CONSTANT_HEIGHT = 11
"""Rows of the drawing of the constant among the other sections."""


def result_headline(result: OrientationResult, session: str, unit: AngleUnit) -> str:
    """The one number that the session was made for, as far as it goes."""
    for line in result.lines:
        name = f"{line.station}-{line.target}"
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
        name = f"{own.station}-{own.main.target}"
        return _headline(name, texts.COL_AZIMUTH, own.main.gyro_azimuth, unit)
    return texts.R_NO_LINE


def _headline(name: str, label: str, angle: AngleResult, unit: AngleUnit) -> str:
    sigma, interval = sigma_text(angle), interval_text(angle)
    return f'{name}  {label} {angle_text(angle, unit)}  ±{sigma}"  (95 % ±{interval}")'


def result_sections(
    project: Project, result: OrientationResult, session: str, width: int
) -> list[Section]:
    """Headings with what stands below them, in the order in which they are read."""
    unit = project.angle_unit
    own = next(item for item in result.sessions if item.id == session)
    sections: list[Section] = []
    for line in result.lines:
        sections.append((texts.R_CHAIN, table_text(_chain(project, own, line), left=(0, 3))))
        budget = table_text(budget_rows(line))
        sections.append((texts.R_BUDGET, budget.append(helps_text(line))))
    if not result.lines:
        sections.append((texts.R_CHAIN, pairs_text(session_details(own, unit))))
    sections.append((texts.R_CHECKS, _checks(result)))
    sections += [
        (texts.R_CONSTANTS, _constant(result, constant, width))
        for constant in result.constants
        if constant.value is not None
    ]
    warnings = "\n".join(shown(warning.text) for warning in result.warnings)
    sections.append((texts.R_WARNINGS, Text(warnings)))
    sections.append((texts.R_POINTS, table_text(_points(own, unit))))
    return [section for section in sections if section[1]]


def _constant(result: OrientationResult, constant: ConstantResult, width: int) -> Text:
    """The drawing where there is one, and in words what is in force and how it was tested."""
    drawing = draw_constant(constant, width, CONSTANT_HEIGHT)
    if drawing:
        drawing.append("\n")
    return drawing.append("\n".join(constant_told(result, constant)))


def _checks(result: OrientationResult) -> Text:
    """Each check with its verdict, value and limit, and below it what it says and its clause."""
    checks = ordered_checks(result)
    width = max((columns(translated(check.verdict)) for check in checks), default=0)
    rows = [
        (
            f"{padded(translated(check.verdict), width)} {check.rule}",
            quantity_text(check.value, check.unit),
            texts.R_LIMIT.format(limit=quantity_text(check.limit, check.unit)),
        )
        for check in checks
    ]
    text = Text()
    for check, line in zip(checks, table_text(rows).plain.splitlines(), strict=True):
        text.append(f"{line}\n", style="bold" if check.passed is False else "")
        words = f"{shown(check.text)}\n" if check.passed is False and check.text else ""
        text.append(f"{words}[{shown(check.clause)}]\n" if check.clause else words)
    return text


def _chain(project: Project, own: SessionResult, line: LineResult) -> list[Row]:
    unit = project.angle_unit
    rows: list[Row] = []
    for target in own.targets:
        if target.target == line.target and target.line_reading is not None:
            label = texts.D_READING.format(target=target.target)
            value, sigma = angle_text(target.line_reading, unit), sigma_text(target.line_reading)
            rows.append((label, value, sigma, texts.S_POINTINGS.format(count=target.pointings)))
    if own.gyro_north is not None:
        value, sigma = angle_text(own.gyro_north, unit), sigma_text(own.gyro_north)
        rows.append((texts.COL_NORTH, value, sigma, texts.S_POINTS.format(count=own.points_used)))
    return rows + chain_rows(project, line)


def _points(own: SessionResult, unit: AngleUnit) -> list[tuple[str, ...]]:
    """Readings with their residuals, on the circle or on the scale."""
    rows: list[tuple[str, ...]] = []
    for point in own.points:
        name = f"{point.index + 1} {point.side}"
        if own.method in ("tracking", "automatic"):
            residual = arcsec_text(point.residual, sign=True)
            rows.append((name, format_angle(point.observed, unit), residual))
        else:
            observed = number_text(point.observed, 2, sign=True)
            residual = number_text(point.residual, 3, sign=True)
            rows.append((name, texts.R_DIVISIONS.format(value=observed), residual))
    return rows


def truth_text(outcome: PracticeOutcome | None, unit: AngleUnit) -> str:
    """Truth against the result of a practice session."""
    if outcome is None:
        return ""
    verdict = texts.PRACTICE_HOLDS if outcome.inside else texts.PRACTICE_MISSES
    truth = texts.PRACTICE_TRUTH.format(
        truth=format_angle(outcome.truth, unit),
        error=arcsec_text(outcome.error, sign=True),
        interval=arcsec_text(outcome.interval95),
        verdict=verdict,
    )
    hidden = texts.PRACTICE_HIDDEN.format(effect=translated(outcome.effect.replace("_", " ")))
    return f"{truth}\n{hidden if outcome.effect else texts.PRACTICE_CLEAN}"
