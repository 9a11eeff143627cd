"""The result of one session as sections of text: the chain, the checks, the budget."""

from __future__ import annotations

from surveyapp.core.practice import PracticeOutcome
from surveyapp.domain.results import (
    AngleResult,
    Check,
    LineResult,
    OrientationResult,
    SessionResult,
)
from surveyapp.tui import texts
from surveyapp.tui.views.checks import ordered_checks, quantity_text, verdict_word
from surveyapp.tui.views.constants import constant_rows
from surveyapp.tui.views.form import angle_text, arcsec_text, interval_text, sigma_text
from surveyapp.tui.views.lines import budget_rows, chain_rows
from surveyapp.tui.views.session import session_details
from surveyapp_models.angles import AngleUnit, format_angle

Section = tuple[str, list[tuple[str, ...]]]


def result_headline(result: OrientationResult, session: str, unit: AngleUnit) -> str:
    """The one number that the session was made for, as far as it goes."""
    for line in result.lines:
        name = f"{line.station}-{line.target}"
        if line.grid_azimuth is not None:
            return _headline(name, texts.COL_GRID, line.grid_azimuth, unit)
        if line.true_azimuth is not None:
            label = texts.R_TRUE.format(reference=(line.true_azimuth.reference or "").lower())
            return _headline(name, label, line.true_azimuth, unit)
        return _headline(name, texts.COL_AZIMUTH, line.gyro_azimuth, unit)
    own = next(item for item in result.sessions if item.id == session)
    if own.gyro_north is not None:
        return _headline(own.station, texts.COL_NORTH, own.gyro_north, unit)
    return texts.R_NO_LINE


def _headline(name: str, label: str, angle: AngleResult, unit: AngleUnit) -> str:
    sigma, interval = sigma_text(angle), interval_text(angle)
    return f'{name}  {label} {angle_text(angle, unit)}  ±{sigma}"  (95 % ±{interval}")'


def result_sections(result: OrientationResult, session: str, unit: AngleUnit) -> list[Section]:
    """Headings with their rows, in the order in which they are read."""
    own = next(item for item in result.sessions if item.id == session)
    sections: list[Section] = []
    sections += [(texts.R_CHAIN, _chain(own, line, unit)) for line in result.lines]
    if not result.lines:
        sections.append((texts.R_CHAIN, [(a, b, "") for a, b in session_details(own, unit)]))
    sections += [
        (texts.R_BUDGET, [tuple(row) for row in budget_rows(line)]) for line in result.lines
    ]
    sections.append((texts.R_CHECKS, [_check(check) for check in ordered_checks(result)]))
    failed = [check for check in ordered_checks(result) if check.passed is False]
    sections.append((texts.R_NOT_MET, [(f"{c.text} ({c.clause})",) for c in failed]))
    constants = [(row[1], row[2], f"±{row[3]}") for row in constant_rows(result)]
    sections.append((texts.R_CONSTANTS, list(constants)))
    sections.append((texts.R_WARNINGS, [(warning.text,) for warning in result.warnings]))
    sections.append((texts.R_POINTS, _points(own, unit)))
    return [section for section in sections if section[1]]


def _check(check: Check) -> tuple[str, ...]:
    limit = quantity_text(check.limit, check.unit)
    value = quantity_text(check.value, check.unit)
    return (f"{verdict_word(check):<8}{check.rule}", value, texts.R_LIMIT.format(limit=limit))


def _chain(own: SessionResult, line: LineResult, unit: AngleUnit) -> list[tuple[str, ...]]:
    rows: list[tuple[str, ...]] = []
    for target in own.targets:
        if target.target == line.target and target.line_reading is not None:
            label = texts.D_READING.format(target=target.target)
            sigma = sigma_text(target.line_reading)
            rows.append((label, angle_text(target.line_reading, unit), sigma))
    if own.gyro_north is not None:
        rows.append((texts.COL_NORTH, angle_text(own.gyro_north, unit), sigma_text(own.gyro_north)))
    rows += chain_rows(line, unit)
    return rows


def _points(own: SessionResult, unit: AngleUnit) -> list[tuple[str, ...]]:
    rows: list[tuple[str, ...]] = []
    for point in own.points:
        if own.method in ("tracking", "automatic"):
            reading = format_angle(point.observed, unit)
            rows.append(
                (f"{point.index + 1} {point.side}", reading, arcsec_text(point.residual, sign=True))
            )
    return rows


def truth_text(outcome: PracticeOutcome | None, unit: AngleUnit) -> str:
    """Truth against the result of a practice session."""
    if outcome is None:
        return ""
    verdict = texts.PRACTICE_HOLDS if outcome.inside else texts.PRACTICE_MISSES
    truth = texts.PRACTICE_TRUTH.format(
        north=format_angle(outcome.north, unit),
        error=arcsec_text(outcome.error, sign=True),
        interval=arcsec_text(outcome.interval95),
        verdict=verdict,
    )
    hidden = texts.PRACTICE_HIDDEN.format(effect=outcome.effect.replace("_", " "))
    return f"{truth}\n{hidden if outcome.effect else texts.PRACTICE_CLEAN}"
