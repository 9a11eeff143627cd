"""When a gyro is to be calibrated again: after four months (source 003)."""

from __future__ import annotations

from dataclasses import replace
from datetime import date
from typing import Final

from surveyapp.domain.calibration import Calibration
from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import said
from surveyapp.workflows.calibrating.request import CalibrationRequest

MONTHS: Final = 4


def due_on(calibrated_on: date) -> date:
    """The day four months later; the last of the month where that day does not exist."""
    month = calibrated_on.month - 1 + MONTHS
    year, month = calibrated_on.year + month // 12, month % 12 + 1
    for day in range(calibrated_on.day, 27, -1):
        try:
            return date(year, month, day)
        except ValueError:
            continue
    return date(year, month, min(calibrated_on.day, 28))


def with_due_date(calibration: Calibration, request: CalibrationRequest) -> Calibration:
    """The calibration with a warning where its record is older than four months."""
    day = request.entry.calibrated_on if request.entry is not None else None
    if day is None or request.today is None or request.today <= due_on(day):
        return calibration
    text = said(
        "the record is of {value}: recalibration was due on {value2} (four months, source 003)",
        value=day.isoformat(),
        value2=due_on(day).isoformat(),
    )
    warning = ResultWarning("recalibration_due", text)
    return replace(calibration, warnings=(*calibration.warnings, warning))
