"""Oriented lines as rows of text: the chain from gyro azimuth to grid azimuth, and the budget."""

from __future__ import annotations

from surveyapp.domain.results import LineResult, OrientationResult
from surveyapp.tui import texts
from surveyapp.tui.views.form import (
    angle_text,
    arcsec_text,
    interval_text,
    sigma_text,
    small_text,
)
from surveyapp_models.angles import AngleUnit, format_angle

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


def chain_rows(line: LineResult, unit: AngleUnit) -> list[tuple[str, str, str]]:
    """The chain, one correction a row: label, value, sigma."""
    rows = [(texts.D_GYRO, angle_text(line.gyro_azimuth, unit), sigma_text(line.gyro_azimuth))]
    if line.constant is not None:
        label = texts.D_PLUS_CONSTANT.format(choice=line.constant_choice)
        rows.append((label, small_text(line.constant), arcsec_text(line.constant_sigma)))
    if line.true_azimuth is not None:
        reference = (line.true_azimuth.reference or "").lower()
        label = texts.D_TRUE.format(reference=reference)
        rows.append((label, angle_text(line.true_azimuth, unit), sigma_text(line.true_azimuth)))
    if line.grid_azimuth is not None:
        rows.append((texts.D_DEFLECTION, small_text(line.deflection), ""))
        rows.append((texts.D_CONVERGENCE, small_text(line.convergence), ""))
        rows.append((texts.D_ARC_TO_CHORD, small_text(line.arc_to_chord), ""))
        rows.append(
            (texts.D_GRID, angle_text(line.grid_azimuth, unit), sigma_text(line.grid_azimuth))
        )
    if line.direction_from_south is not None:
        rows.append((texts.D_SOUTH, format_angle(line.direction_from_south, unit), ""))
    if line.existing_azimuth is not None:
        rows.append((texts.D_EXISTING, format_angle(line.existing_azimuth, unit), ""))
    return rows


def budget_rows(line: LineResult) -> list[tuple[str, str, str]]:
    """The budget: source, sigma, share."""
    return [(item.source, arcsec_text(item.sigma, 2), f"{item.share:.0%}") for item in line.budget]
