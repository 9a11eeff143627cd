"""``calibrate fog-station``: the rule is asked for, the log is read, the constant estimated."""

from __future__ import annotations

from typing import Final, cast

from surveyapp.core.sensors.rate.fog_station import Rule
from surveyapp.core.sensors.rate.fog_station_log import NEEDED, OPTIONAL, calibrate_fog_station
from surveyapp.domain.calibration import Calibration
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.sensor_logs.reading import Need
from surveyapp.workflows.adopted_effects import without_adopted
from surveyapp.workflows.calibrating.drift import with_drift
from surveyapp.workflows.calibrating.due import with_due_date
from surveyapp.workflows.calibrating.request import CalibrationRequest

RULES: Final = ("increases", "decreases")


def calibrate(request: CalibrationRequest) -> Calibration:
    """Calibrate a gyro on a total station from a table log."""
    problems = []
    rule = request.option("reading_from_elevation")
    if rule not in RULES:
        problems.append(
            Problem(
                "which way the vertical circle reads is not stated",
                "reading_from_elevation",
                "" if rule is None else str(rule),
                "increases or decreases",
                "increases: the reading grows as the gyro goes from its elevation to the "
                "horizontal (rule 1); it is looked up at the instrument, never guessed",
            )
        )
    relative = request.number("table_rate_relative_sigma")
    if relative is not None and not 0.0 <= relative < 1.0:
        problems.append(
            Problem(
                "this is no relative sigma",
                "table_rate_relative_sigma",
                f"{relative:g}",
                "0 to 1, as 1e-4",
            )
        )
    try:
        log = request.read(Need(columns=NEEDED, varying=NEEDED, optional=OPTIONAL))
    except SurveyError as error:
        raise SurveyError([*problems, *error.problems]) from None
    log = without_adopted(log, request.entry)
    found = calibrate_fog_station(
        log, rule=cast("Rule", rule), relative_rate_sigma=relative, problems=problems
    )
    return with_drift(with_due_date(found, request), request)
