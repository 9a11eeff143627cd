"""The card of a calibrated sensor: parameters, day, temperatures, source, and how long it holds."""

from __future__ import annotations

from datetime import date, timedelta
from pathlib import Path
from typing import Final, cast

import numpy as np

from surveyapp.domain.calibration import Calibration
from surveyapp.domain.sensor_card import SensorCard
from surveyapp.domain.sensor_entry import SensorKind
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.sensor_cards import write_sensor_card
from surveyapp.languages import said
from surveyapp.workflows.calibrating.request import CalibrationRequest

HOLDS_DAYS: Final = {"compass": 365, "tilt": 365, "rate": 122, "fog-station": 122, "edm": 365}
"""Days that a card holds unless its owner writes another day into it: a year for compass, tilt and
distance meter (the usual recalibration interval of measuring instruments), four months for a gyro
(source 003)."""


def card_of(
    calibration: Calibration, request: CalibrationRequest, *, identity: str, software: str
) -> SensorCard:
    """The card of a calibration.

    Raises
    ------
    SurveyError
        If nothing is determined: there is nothing to put on a card.
    """
    determined = tuple(item for item in calibration.parameters if item.value is not None)
    if not determined or calibration.geometry.verdict == "refused":
        raise SurveyError(
            Problem(
                "no card can be written: the calibration determines nothing",
                f"`card`, {calibration.source}",
                said("geometry {verdict}", verdict=calibration.geometry.verdict),
                "a calibration whose parameters are determined",
            )
        )
    day = _day(request)
    until = day + timedelta(days=HOLDS_DAYS.get(request.kind, 365))
    title = f"{calibration.kind} calibrated from {calibration.source}"
    covariance = None
    if calibration.covariance is not None:
        covariance = np.array(calibration.covariance, dtype=np.float64)
    return SensorCard(
        id=identity,
        title=title,
        kind=cast("SensorKind", request.kind),
        source=f"{calibration.source}, {calibration.n} rows, {software}",
        parameters=determined,
        calibrated_on=day,
        valid_from=day,
        valid_to=until,
        temperature_c=calibration.temperature_c,
        sha256=calibration.sha256,
        covariance=covariance,
        constants=calibration.constants,
        notes={**calibration.notes, **_procedure(request)},
        extra={**_owner(request), **calibration.tables},
    )


def _owner(request: CalibrationRequest) -> dict[str, object]:
    """Whose sensor the card is of, where the project says so."""
    entry = request.entry
    if entry is None:
        return {}
    stated = (("instrument", entry.instrument), ("serial", entry.serial))
    return {key: value for key, value in stated if value is not None}


def _procedure(request: CalibrationRequest) -> dict[str, str]:
    """By which procedure the record was made, where the project says so."""
    note = request.option("note")
    return {"procedure": note} if isinstance(note, str) and note else {}


def _day(request: CalibrationRequest) -> date:
    if request.entry is not None and request.entry.calibrated_on is not None:
        return request.entry.calibrated_on
    if request.today is None:
        raise ValueError("a card needs the day of its calibration")
    return request.today


def write_card(
    path: Path, calibration: Calibration, request: CalibrationRequest, *, software: str
) -> SensorCard:
    """Write the card of a calibration; its id is the name of the file."""
    card = card_of(calibration, request, identity=path.stem, software=software)
    write_sensor_card(path, card)
    return card
