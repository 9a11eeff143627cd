"""What is judged of a calibration: each with its value, its limit and a verdict."""

from __future__ import annotations

from typing import Final

from surveyapp.domain.calibration import Calibration
from surveyapp.languages import said, said_each
from surveyapp.report.blocks import Block, Heading, Table
from surveyapp.report.numbers import NOTHING, four_digits

HEADING_LIMIT_DEG: Final = 0.5
"""Limit of a calibration that states no other (levelling.md; --heading-limit-deg)."""

Row = tuple[str, str, str, str]


def check_blocks(
    result: Calibration, *, heading_limit_deg: float = HEADING_LIMIT_DEG
) -> tuple[Block, ...]:
    """A table of what was judged; none where nothing is.

    Parameters
    ----------
    result : Calibration
    heading_limit_deg : float
        Of a compass [degrees].
    """
    rows = [_geometry(result)]
    rows += _heading(result, heading_limit_deg) + _held_out(result)
    rows += _scatter(result) + _repeatability(result)
    head = said_each("check", "value", "limit", "verdict")
    return (Heading(said("Checks of the calibration"), 2), Table(head, tuple(rows), "lrrl"))


def _verdict(met: bool | None) -> str:
    if met is None:
        return said("open")
    return said("met") if met else said("NOT MET")


def _geometry(result: Calibration) -> Row:
    count = len(result.geometry.undetermined)
    return (
        said("every parameter is determined"),
        said("{count} not", count=count) if count else said("all"),
        said("all"),
        _verdict(count == 0),
    )


def _heading(result: Calibration, limit: float) -> list[Row]:
    if result.kind not in ("compass", "swing"):
        return []
    sigma = result.geometry.heading_sigma_deg
    met = None if sigma is None else sigma <= limit
    if sigma is None and result.geometry.verdict == "refused":
        met = False
    text = NOTHING if sigma is None else f"{sigma:.3g}"
    return [(said("sigma of a level heading, degrees"), text, f"{limit:g}", _verdict(met))]


def _held_out(result: Calibration) -> list[Row]:
    held = result.held_out
    if held is None or held.before is None:
        return []
    met = None if held.after is None else held.after <= held.before
    name = said("left-out rows are predicted better than before, {unit}", unit=held.unit)
    return [(name, four_digits(held.after), four_digits(held.before), _verdict(met))]


def _scatter(result: Calibration) -> list[Row]:
    scatter = result.extra.get("scatter")
    if not scatter or scatter.get("sd_arcsec") is None:
        return []
    met = scatter["verdict"] == "agrees"
    value, model = f'{scatter["sd_arcsec"]:.2f}"', f'{scatter["model_sd_arcsec"]:.2f}"'
    name = said("repeats scatter as the model says, p {p:.2g}", p=scatter["p"])
    return [(name, value, model, _verdict(met))]


def _repeatability(result: Calibration) -> list[Row]:
    found = result.extra.get("repeatability")
    if not found:
        return []
    worst = min((row["p"] for row in found["parameters"]), default=1.0)
    name = said("rounds repeat as the sigmas say, {rounds} rounds", rounds=found["rounds"])
    level = 0.05 / max(len(found["parameters"]), 1)
    met = found["verdict"] == "agrees"
    return [(name, f"p {worst:.2g}", f"{level:.2g}", _verdict(met))]
