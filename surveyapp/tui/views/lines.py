"""Oriented lines as rows of text: the chain from gyro azimuth to grid azimuth, and the budget."""

from __future__ import annotations

from surveyapp.core.improvement import most_helpful
from surveyapp.domain.project import Project
from surveyapp.domain.results import AngleResult, BudgetLine, LineResult, OrientationResult
from surveyapp.languages import translated
from surveyapp.tui import texts
from surveyapp.tui.views.form import (
    angle_text,
    arcsec_text,
    interval_text,
    sigma_text,
    small_text,
)
from surveyapp_models.angles import AngleUnit, format_angle

Row = tuple[str, str, str, str]

LINE_COLUMNS = (
    texts.COL_LINE,
    texts.COL_COUNT,
    texts.COL_GRID,
    texts.COL_SIGMA,
    texts.COL_INTERVAL,
)


def line_rows(result: OrientationResult, unit: AngleUnit) -> list[tuple[str, ...]]:
    """Each oriented line in one row."""
    return [
        (
            f"{line.station}-{line.target}",
            str(line.rounds),
            angle_text(line.grid_azimuth, unit),
            sigma_text(line.grid_azimuth),
            interval_text(line.grid_azimuth),
        )
        for line in result.lines
    ]


def chain_rows(project: Project, line: LineResult) -> list[Row]:
    """The chain, one correction a row: label, value, sigma, where it comes from."""
    unit = project.angle_unit
    rounds = texts.S_ROUNDS.format(count=line.rounds)
    rows = [_angle(texts.D_GYRO, line.gyro_azimuth, unit, rounds)]
    if line.constant is not None:
        value, sigma = small_text(line.constant), arcsec_text(line.constant_sigma)
        rows.append((texts.D_PLUS_CONSTANT, value, sigma, translated(line.constant_choice or "")))
    if line.true_azimuth is not None:
        reference = translated((line.true_azimuth.reference or "").lower())
        rows.append(_angle(texts.D_TRUE.format(reference=reference), line.true_azimuth, unit, ""))
    if line.grid_azimuth is not None:
        known = project.station(line.station).deflection.known
        rows.append(
            _small(
                texts.D_DEFLECTION,
                line.deflection,
                texts.S_DEFLECTION if known else texts.S_NO_DEFLECTION,
            )
        )
        grid = texts.S_GRID.format(station=line.station)
        rows.append(_small(texts.D_CONVERGENCE, line.convergence, grid))
        ends = texts.S_NO_ENDS if line.arc_to_chord is None else texts.S_ENDS
        rows.append(_small(texts.D_ARC_TO_CHORD, line.arc_to_chord, ends))
        rows.append(_angle(texts.D_GRID, line.grid_azimuth, unit, texts.S_CLOCKWISE))
    if line.direction_from_south is not None:
        south = format_angle(line.direction_from_south, unit)
        rows.append((texts.D_SOUTH, south, "", texts.S_AXES))
    if line.existing_azimuth is not None:
        existing = format_angle(line.existing_azimuth, unit)
        rows.append((texts.D_EXISTING, existing, "", texts.S_COMPARE))
    return rows


def _angle(label: str, item: AngleResult, unit: AngleUnit, source: str) -> Row:
    return label, angle_text(item, unit), sigma_text(item), source


def _small(label: str, value: float | None, source: str) -> Row:
    return label, small_text(value), "", source


def budget_rows(line: LineResult) -> list[tuple[str, str, str]]:
    """The budget: source, sigma, share."""
    return [
        (translated(item.source), arcsec_text(item.sigma, 2), f"{item.share:.0%}")
        for item in _counted(line)
    ]


def _counted(line: LineResult) -> list[BudgetLine]:
    """Terms that are not zero."""
    return [item for item in line.budget if item.sigma > 0.0]


def helps_text(line: LineResult) -> str:
    """What would improve an azimuth most, and by how much."""
    found = most_helpful(line.budget)
    if found is None:
        return ""
    advice = texts.IMPROVE.get(found.source, translated(found.source))
    if found.at_calibration:
        advice = texts.R_AT_CALIBRATION.format(advice=advice)
    if len(_counted(line)) == 1:
        return texts.R_HELPS_ALONE.format(advice=advice)
    sigma, without = arcsec_text(found.sigma), arcsec_text(found.without)
    return texts.R_HELPS.format(advice=advice, sigma=sigma, without=without)
