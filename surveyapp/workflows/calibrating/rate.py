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
from surveyapp.domain.sensor_log import STANDARD_GRAVITY_M_S2
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.io.sensor_logs.reading import LogRequest, Need, read_log
from surveyapp.languages import either
from surveyapp.workflows.adopted_effects import not_taken_out
from surveyapp.workflows.calibrating.drift import with_drift
from surveyapp.workflows.calibrating.due import with_due_date
from surveyapp.workflows.calibrating.request import CalibrationRequest
from surveyapp_models.angles import ARCSEC

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


def latitude_of(request: CalibrationRequest) -> float | None:
    """Stated latitude [rad], of the command line or of the log's entry.

    Raises
    ------
    SurveyError
        If it is none.
    """
    degrees = request.number("latitude")
    if degrees is None and request.entry is not None:
        degrees = request.entry.latitude_deg
    if degrees is None:
        return None
    if not -90.0 <= degrees <= 90.0:
        raise SurveyError(
            Problem("this is no latitude", "latitude", f"{degrees:g}", "-90 to 90 degrees")
        )
    return math.radians(degrees)


def _positive(request: CalibrationRequest, name: str, option: str) -> float:
    value = request.number(name, 0.0) or 0.0
    if value < 0.0:
        raise SurveyError(Problem("a sigma is negative", option, f"{value:g}", "0 or more"))
    return value


def _six_positions(request: CalibrationRequest) -> Calibration:
    options = SixPositionOptions(
        flip_sigma=_positive(request, "flip_sigma_arcsec", "flip_sigma_arcsec") * ARCSEC,
        relative_rate_sigma=_positive(
            request, "table_rate_relative_sigma", "table_rate_relative_sigma"
        ),
        latitude=latitude_of(request),
    )
    need = Need(
        columns=(*GYROS, "position"),
        varying=GYROS,
        optional=(*TABLE_COLUMNS, *ACCELEROMETERS),
    )
    return calibrate_six_positions(request.read(need), options)


def _multi_position(request: CalibrationRequest) -> Calibration:
    gravity = request.number("gravity_m_s2", STANDARD_GRAVITY_M_S2) or STANDARD_GRAVITY_M_S2
    log = request.read(
        Need(columns=HAND_HELD, varying=HAND_HELD, optional=("temperature_c",), biased=True)
    )
    return calibrate_multi_position(log, MultiPositionOptions(latitude_of(request), gravity))


def _temperature(request: CalibrationRequest) -> Calibration:
    problems: list[Problem] = []
    latitude = latitude_of(request)
    if latitude is None:
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
    wanted = _temperatures(request, problems)
    room = request.option("room")
    log = None
    try:
        log = request.read(
            Need(
                columns=(*GYROS, "position", CHAMBER),
                varying=GYROS,
                optional=(*TABLE_COLUMNS, *ACCELEROMETERS),
            )
        )
    except SurveyError as error:
        problems += error.problems
    if problems or log is None or latitude is None:
        raise SurveyError(problems)
    gravity = request.number("gravity_m_s2", STANDARD_GRAVITY_M_S2) or STANDARD_GRAVITY_M_S2
    options = TemperatureOptions(
        latitude=latitude,
        predict_at=wanted,
        room=None if room is None else _room(request, str(room)),
        gravity=gravity,
        flip_sigma=_positive(request, "flip_sigma_arcsec", "flip_sigma_arcsec") * ARCSEC,
        relative_rate_sigma=_positive(
            request, "table_rate_relative_sigma", "table_rate_relative_sigma"
        ),
    )
    return calibrate_temperature(log, options)


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


def _room(request: CalibrationRequest, name: str) -> tuple[Resting, ...]:
    """Rests of the room-temperature log, position by position."""
    path = Path(name)
    if not path.is_absolute() and not path.exists() and request.folder is not None:
        path = request.folder / name
    log = read_log(
        LogRequest(path=path, where=name, id=path.name),
        Need(columns=(*ACCELEROMETERS, "position"), optional=TABLE_COLUMNS, timed="optional"),
    )
    problems = place_problems(log)
    if problems:
        raise SurveyError(problems)
    return resting_rows(log)


PROGRAMMES: Final[Mapping[str, Callable[[CalibrationRequest], Calibration]]] = {
    "six-position": _six_positions,
    "temperature": _temperature,
    "multi-position": _multi_position,
}
"""Programme to what runs it."""
