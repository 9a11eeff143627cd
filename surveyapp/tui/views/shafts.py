"""The pages of an orientation through shafts: blocks of the record."""

from __future__ import annotations

from surveyapp.domain.shaft_result import ShaftOrientation, ShaftResult
from surveyapp.report.blocks import Block
from surveyapp.report.numbers import direction, plain, seconds
from surveyapp.report.sections import shafts as section
from surveyapp.tui import texts
from surveyapp_models.angles import AngleUnit


def pages(
    result: ShaftResult, shaft: ShaftOrientation, unit: AngleUnit
) -> dict[str, tuple[Block, ...]]:
    """Blocks by the id of their page, of one shaft."""
    return {
        "azimuth": (
            *section.orientation(shaft, unit),
            *section.wires(shaft),
            *section.budget(shaft),
            *section.warnings(result),
        ),
        "plumbing": section.plumbing(shaft),
    }


def state_text(shaft: ShaftOrientation, unit: AngleUnit) -> str:
    """The azimuth of the oriented side."""
    best = shaft.combined.azimuth
    if best is None:
        return texts.S_CONTRADICTION.format(id=shaft.id)
    return texts.S_STATE.format(
        id=shaft.id,
        at=shaft.at,
        to=shaft.to,
        azimuth=direction(best.value, unit),
        sigma=f'{seconds(best.sigma, 1)}"',
    )


def swing_title(shaft: ShaftOrientation, wire: str, axis: str) -> str:
    """Rest of one wire on one scale."""
    rest = next(item for item in shaft.wires if item.name == wire)
    value = rest.x_mm if axis == "x" else rest.y_mm
    sigma = rest.sigma_x_mm if axis == "x" else rest.sigma_y_mm
    return texts.S_SWING.format(
        wire=wire,
        axis=axis,
        rest=plain(value, 3),
        sigma=plain(sigma, 3),
        period=plain(rest.period_s, 1),
    )
