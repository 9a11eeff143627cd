"""``calibrate rate|fog-station --against CARD,...``: the drift since older cards of the sensor."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from surveyapp.core.sensors.rate.card_drift import drift_from, told_drift
from surveyapp.domain.calibration import Calibration
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.sensor_cards import read_sensor_card
from surveyapp.workflows.calibrating.request import CalibrationRequest


def with_drift(calibration: Calibration, request: CalibrationRequest) -> Calibration:
    """The calibration with its drift against the cards that are named.

    Raises
    ------
    SurveyError
        If a card cannot be read, or is of another kind of sensor.
    """
    text = request.option("against")
    names = [part.strip() for part in str(text).split(",") if part.strip()] if text else []
    entry = request.entry
    day = entry.calibrated_on if entry is not None and entry.calibrated_on else request.today
    found, told, problems = [], list[ResultWarning](), list[Problem]()
    for name in names:
        path = Path(name)
        if not path.is_absolute() and not path.exists() and request.folder is not None:
            path = request.folder / name
        try:
            card = read_sensor_card(path, where=name)
        except SurveyError as error:
            problems += error.problems
            continue
        if card.kind != request.kind:
            what = "the card is of another kind of sensor"
            problems.append(Problem(what, name, str(card.kind), request.kind))
            continue
        told += card.warnings
        found.append(drift_from(calibration.parameters, card, day))
    if problems:
        raise SurveyError(problems)
    warnings = (*calibration.warnings, *told, *told_drift(found))
    return replace(calibration, warnings=warnings, extra={**calibration.extra, "drift": found})
