"""Whether a log can be one that a card corrects: its axes, its field, its range.

A card and a log that do not belong together give headings and tilts that look like any other. What
a log shows by itself is asked here, before anything is corrected.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from surveyapp.core.sensors.compass_axes import check_axes
from surveyapp.core.sensors.compensation import BODY, beyond_tilt, corrected_field
from surveyapp.core.sensors.swing import refuse_swapped
from surveyapp.domain.columns import pieces
from surveyapp.domain.sensor_card import SensorCard
from surveyapp.domain.sensor_log import SensorLog
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import counted, said

FIELD_DIFFERS: Final = 0.05
"""Share of the field by which its corrected size may differ or scatter: places of one country
differ by less, and a foreign card leaves iron of several microtesla."""


def field_doubt(log: SensorLog, card: SensorCard, *, where: str) -> str | None:
    """What speaks against the card being of this compass; None if nothing does.

    The corrected field has one size in every attitude, and about that of the calibration.
    """
    expected = card.constants.get("used_field")
    if expected is None:
        return None
    part = log.every(max(log.size // LOOKED_AT, 1))
    points = np.column_stack([part.columns[f"mag_{axis}_uT"] for axis in BODY])
    size = np.linalg.norm(corrected_field(points, card, where), axis=1)
    low, middle, high = np.quantile(size, (0.16, 0.5, 0.84))
    scatter = 0.5 * float(high - low)
    noise = card.constants.get("reading_sigma_uT", 0.0)
    if abs(float(middle) - expected) <= FIELD_DIFFERS * expected and scatter <= max(
        FIELD_DIFFERS * expected, 3.0 * noise
    ):
        return None
    return said(
        "the corrected field is {middle:.1f} uT +- {scatter:.1f}, that of the calibration "
        "{expected:.1f}: a log of another compass or mounting, iron near, or another country",
        middle=float(middle),
        scatter=scatter,
        expected=expected,
    )


LOOKED_AT: Final = 2000
"""Rows that tell what a log is, evenly taken."""

FEWEST_ROWS: Final = 20
"""Rows in which an axis that never changes is a dead one."""

RANGE: Final = 1.1
"""Readings may leave the range of the calibration by a tenth of it."""


def compass_doubts(log: SensorLog, card: SensorCard, *, where: str) -> list[ResultWarning]:
    """What speaks against a compass log under this card.

    Raises
    ------
    SurveyError
        If its axes are exchanged, or one of them is dead.
    """
    part = log.every(max(log.size // LOOKED_AT, 1))
    _refuse_dead(part, [f"mag_{axis}_uT" for axis in BODY])
    force = part.vector("acc")
    if force is not None and card.get("deviation_A") is not None:
        refuse_swapped(force, log.path)
    return [*check_axes(part), *resting_doubts(log, card, where=where)]


def resting_doubts(log: SensorLog, card: SensorCard, *, where: str) -> list[ResultWarning]:
    """The same of a compass that stands still: its axes may well never change."""
    found = []
    doubt = field_doubt(log, card, where=where)
    if doubt is not None:
        found.append(ResultWarning("field_differs", doubt))
    beyond = sum(int(np.count_nonzero(beyond_tilt(part, card))) for part in log.pieces())
    if beyond:
        text = counted(
            "{count} row is tilted by more than the {tilt:.1f} degrees of the calibration: its "
            "heading is left empty",
            "{count} rows are tilted by more than the {tilt:.1f} degrees of the calibration: their "
            "headings are left empty",
            count=beyond,
            tilt=card.constants["largest_tilt_deg"],
        )
        found.append(ResultWarning("beyond_tilt", text))
    return found


def tilt_doubts(log: SensorLog, card: SensorCard) -> list[ResultWarning]:
    """Readings beyond those of the calibration, and an axis that never changes."""
    found = range_doubts(log, card)
    for name in _readings(card):
        values = log.columns[name]
        if log.size >= FEWEST_ROWS and not any(np.any(p != values[0]) for p in pieces(values)):
            text = said("{name} never changes: is the sensor connected?", name=name)
            found.append(ResultWarning("never_changes", text))
    return found


def _readings(card: SensorCard) -> list[str]:
    head = card.get("sensitivity") is not None
    return ["output"] if head else ["tilt_along_arcsec", "tilt_across_arcsec"]


def range_doubts(log: SensorLog, card: SensorCard) -> list[ResultWarning]:
    """Readings beyond those of the calibration.

    A card written before cards held a range is used, and that it is not judged is told.
    """
    found: list[ResultWarning] = []
    if card.get("sensitivity") is not None:
        centre, span = card.get("zero") or 0.0, abs(card.get("sensitivity") or 0)
    else:
        centre = 0.0
        largest = card.constants.get("largest_reading_arcsec")
        span = np.inf if largest is None else RANGE * largest
        if largest is None:
            text = said(
                "the card holds no range of its calibration: whether these tilts lie within it "
                "is not judged; a new calibration from its log writes it"
            )
            found.append(ResultWarning("range_unknown", text))
    for name in _readings(card):
        values = log.columns[name]
        beyond = sum(int(np.count_nonzero(np.abs(p - centre) > span)) for p in pieces(values))
        if beyond:
            text = counted(
                "{name} is beyond the range of the calibration in {count} row",
                "{name} is beyond the range of the calibration in {count} rows",
                name=name,
                count=beyond,
            )
            text += said(": another unit, or a tilt at which nothing was tried")
            found.append(ResultWarning("beyond_range", text))
    return found


def _refuse_dead(log: SensorLog, names: list[str]) -> None:
    """An axis that never changes while another one does.

    Raises
    ------
    SurveyError
    """
    still = [name for name in names if not bool(np.any(log.columns[name] != log.columns[name][0]))]
    if log.size < FEWEST_ROWS or not still or len(still) == len(names):
        return
    raise SurveyError(
        [
            Problem(
                said("{name} is constant", name=name),
                log.path,
                f"{log.columns[name][0]:g}",
                "a column that varies with the others",
                "is the sensor connected, and is it the right column?",
            )
            for name in still
        ]
    )
