"""``calibrate rate``: which programme, what it needs of the log and of the options."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Final

from surveyapp.core.sensors.rate.accelerometers import Resting
from surveyapp.core.sensors.rate.multi_position_log import NEEDED as HAND_HELD
from surveyapp.core.sensors.rate.multi_position_log import (
    MultiPositionOptions,
    calibrate_multi_position,
)
from surveyapp.core.sensors.rate.position_log import (
    ACCELEROMETERS,
    GYROS,
    place_problems,
    resting_rows,
)
from surveyapp.core.sensors.rate.six_position_log import (
    SixPositionOptions,
    calibrate_six_positions,
)
from surveyapp.core.sensors.rate.temperature_log import (
    CHAMBER,
    calibrate_temperature,
)
from surveyapp.core.sensors.rate.temperature_nodes import TemperatureOptions
from surveyapp.domain.calibration import Calibration
from surveyapp.domain.sensor_log import STANDARD_GRAVITY_M_S2, SensorLog
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.io.sensor_logs.reading import LogRequest, Need, read_log
from surveyapp.languages import either, said
from surveyapp.workflows.adopted_effects import not_taken_out
from surveyapp.workflows.calibrating.drift import with_drift
from surveyapp.workflows.calibrating.due import with_due_date
from surveyapp.workflows.calibrating.request import CalibrationRequest
from surveyapp_models.angles import ARCSEC

GRAVITY_M_S2: Final = (9.7, 9.9)
"""Free fall on the ground lies between 9.764 (Huascaran) and 9.834 (Arctic Ocean) m/s2 (Hirt et al.
2013, GGMplus), and by 2e-6 a metre of depth above that."""
TABLE_COLUMNS: Final = ("table_rate_deg_s", "table_angle_deg", "round", "temperature_c")


def calibrate(request: CalibrationRequest) -> Calibration:
    """Calibrate a rate sensor by the programme that is asked for."""
    programme = request.option("programme")
    if programme is None and request.entry is not None:
        programme = request.entry.programme
    if not isinstance(programme, str) or programme not in PROGRAMMES:
        raise SurveyError(
            Problem(
                "which programme?" if programme is None else "there is no such programme",
                "programme",
                "" if programme is None else str(programme),
                either(PROGRAMMES),
                "" if programme is None else nearest_names(str(programme), PROGRAMMES),
            )
        )
    found = with_drift(with_due_date(PROGRAMMES[programme](request), request), request)
    return replace(found, warnings=(*found.warnings, *not_taken_out(request.entry)))


def latitude_of(request: CalibrationRequest, problems: list[Problem]) -> float | None:
    """Stated latitude [rad], of the command line or of the log; what is none is a problem."""
    degrees = request.number("latitude")
    if degrees is None and request.entry is not None:
        degrees = request.entry.latitude_deg
    if degrees is None:
        return None
    if not -90.0 <= degrees <= 90.0:
        problems.append(
            Problem("this is no latitude", "latitude", f"{degrees:g}", "-90 to 90 degrees")
        )
        return None
    return math.radians(degrees)


def _positive(request: CalibrationRequest, name: str, problems: list[Problem]) -> float:
    value = request.number(name, 0.0) or 0.0
    if value < 0.0:
        problems.append(Problem("a sigma is negative", name, f"{value:g}", "0 or more"))
    return value


def _gravity(request: CalibrationRequest, problems: list[Problem]) -> float:
    value = request.number("gravity_m_s2")
    if value is None:
        return STANDARD_GRAVITY_M_S2
    low, high = GRAVITY_M_S2
    if not low <= value <= high:
        expected = said("{low:g} to {high:g} m/s2", low=low, high=high)
        problems.append(
            Problem("this is no gravity on the earth", "gravity_m_s2", f"{value:g}", expected)
        )
    return value


def _read(request: CalibrationRequest, need: Need, problems: list[Problem]) -> SensorLog:
    """The log, or what is wrong with it and with the options together.

    Raises
    ------
    SurveyError
    """
    try:
        log = request.read(need)
    except SurveyError as error:
        raise SurveyError([*problems, *error.problems]) from None
    if problems:
        raise SurveyError(problems)
    return log


def _six_positions(request: CalibrationRequest) -> Calibration:
    problems: list[Problem] = []
    options = SixPositionOptions(
        flip_sigma=_positive(request, "flip_sigma_arcsec", problems) * ARCSEC,
        relative_rate_sigma=_positive(request, "table_rate_relative_sigma", problems),
        latitude=latitude_of(request, problems),
    )
    need = Need(
        columns=(*GYROS, "position"),
        varying=GYROS,
        optional=(*TABLE_COLUMNS, *ACCELEROMETERS),
    )
    return calibrate_six_positions(_read(request, need, problems), options)


def _multi_position(request: CalibrationRequest) -> Calibration:
    problems: list[Problem] = []
    options = MultiPositionOptions(latitude_of(request, problems), _gravity(request, problems))
    need = Need(columns=HAND_HELD, varying=HAND_HELD, optional=("temperature_c",), biased=True)
    return calibrate_multi_position(_read(request, need, problems), options)


def _temperature(request: CalibrationRequest) -> Calibration:
    problems: list[Problem] = []
    latitude = latitude_of(request, problems)
    if latitude is None and not problems:
        problems.append(
            Problem(
                "the latitude is not stated",
                "latitude",
                "",
                "degrees",
                "one position per direction holds the vertical earth rate in its bias: up to 15 "
                "deg/h",
            )
        )
    room = request.option("room")
    options = TemperatureOptions(
        latitude=latitude or 0.0,
        predict_at=_temperatures(request, problems),
        room=None if room is None else _room(request, str(room), problems),
        gravity=_gravity(request, problems),
        flip_sigma=_positive(request, "flip_sigma_arcsec", problems) * ARCSEC,
        relative_rate_sigma=_positive(request, "table_rate_relative_sigma", problems),
    )
    need = Need(
        columns=(*GYROS, "position", CHAMBER),
        varying=GYROS,
        optional=(*TABLE_COLUMNS, *ACCELEROMETERS),
    )
    return calibrate_temperature(_read(request, need, problems), options)


def _temperatures(request: CalibrationRequest, problems: list[Problem]) -> tuple[float, ...]:
    text = request.option("predict_at")
    if text is None:
        return ()
    found = []
    for part in str(text).split(","):
        try:
            value = float(part)
        except ValueError:
            value = math.nan
        if math.isfinite(value):
            found.append(value)
        else:
            problems.append(
                Problem("this is no temperature", "predict_at", part, "degrees Celsius: 0,10,25")
            )
    return tuple(found)


def _room(
    request: CalibrationRequest, name: str, problems: list[Problem]
) -> tuple[Resting, ...] | None:
    """Rests of the room-temperature log, position by position."""
    path = Path(name)
    if not path.is_absolute() and not path.exists() and request.folder is not None:
        path = request.folder / name
    try:
        log = read_log(
            LogRequest(path=path, where=name, id=path.name),
            Need(columns=(*ACCELEROMETERS, "position"), optional=TABLE_COLUMNS, timed="optional"),
        )
    except SurveyError as error:
        problems += error.problems
        return None
    wrong = place_problems(log)
    problems += wrong
    return None if wrong else resting_rows(log)


PROGRAMMES: Final[Mapping[str, Callable[[CalibrationRequest], Calibration]]] = {
    "six-position": _six_positions,
    "temperature": _temperature,
    "multi-position": _multi_position,
}
"""Programme to what runs it."""
