"""The result of one session as sections of text: the chain, the checks, the budget."""

from __future__ import annotations

from surveyapp.domain.results import LineResult, OrientationResult, SessionResult
from surveyapp.tui import texts
from surveyapp.tui.views.checks import check_rows, check_texts
from surveyapp.tui.views.constants import constant_rows
from surveyapp.tui.views.form import angle_text, arcsec_text, sigma_text
from surveyapp.tui.views.lines import budget_rows, chain_rows
from surveyapp.tui.views.session import session_details
from surveyapp_models.angles import AngleUnit, format_angle

Section = tuple[str, list[tuple[str, ...]]]


def result_headline(result: OrientationResult, unit: AngleUnit) -> str:
    """The one number that the session was made for."""
    for line in result.lines:
        if line.grid_azimuth is not None:
            azimuth = angle_text(line.grid_azimuth, unit)
            return f'{line.station}-{line.target}  {azimuth}  ±{sigma_text(line.grid_azimuth)}"'
    return texts.R_NO_LINE


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
    checks = [
        (row[0], f"{row[1]} {row[3]}", f"{texts.R_LIMIT.format(limit=row[4])}; {text}")
        for row, text in zip(
            check_rows(result), (t.replace("\n", "; ") for t in check_texts(result)), strict=True
        )
    ]
    sections.append((texts.R_CHECKS, list(checks)))
    constants = [(row[1], row[2], f"±{row[3]}") for row in constant_rows(result)]
    sections.append((texts.R_CONSTANTS, list(constants)))
    warnings = [(warning.text, "", "") for warning in result.warnings]
    sections.append((texts.R_WARNINGS, list(warnings)))
    sections.append((texts.R_POINTS, _points(own, unit)))
    return [section for section in sections if section[1]]


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
