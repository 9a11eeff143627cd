"""``calibrate compass``: a swing where headings are known, else an ellipsoid."""

from __future__ import annotations

import datetime as dt
import math
from dataclasses import replace
from typing import Final

from surveyapp.core.sensors.compass_attitude import with_attitude
from surveyapp.core.sensors.compass_axes import check_axes, without_force
from surveyapp.core.sensors.compass_calibration import calibrate_ellipsoid
from surveyapp.core.sensors.declination import model_declination
from surveyapp.core.sensors.swing import calibrate_swing, refuse_swapped
from surveyapp.domain.calibration import Calibration
from surveyapp.domain.sensor_log import QUATERNION
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.sensor_logs.reading import Need
from surveyapp.workflows.calibrating.request import CalibrationRequest

MAG: Final = ("mag_x_uT", "mag_y_uT", "mag_z_uT")
ACC: Final = ("acc_x_m_s2", "acc_y_m_s2", "acc_z_m_s2")
HEADING_LIMIT_DEG: Final = 0.5


def calibrate(request: CalibrationRequest) -> Calibration:
    """Calibrate a compass from its log."""
    limit = request.number("heading_limit_deg", HEADING_LIMIT_DEG)
    if limit is None or not 0.0 < limit <= 45.0:
        found, expected = str(limit), "more than 0, at most 45"
        raise SurveyError(Problem("this is no limit", "heading_limit_deg", found, expected))
    swing = request.file.has("heading_deg")
    acc = ACC if request.file.has(*ACC) else ()
    heading = ("heading_deg",) if swing else ()
    log = request.read_adopted(
        Need(
            columns=(*MAG, *acc, *heading),
            varying=(*MAG, *heading),
            optional=("temperature_c", *QUATERNION),
        ),
        fitted=(*MAG, *acc) if swing else MAG,
    )
    force = log.vector("acc")
    if swing and force is not None:
        refuse_swapped(force, log.path)
    doubts = check_axes(log)
    if swing:
        result = calibrate_swing(log, limit=math.radians(limit))
    else:
        result = calibrate_ellipsoid(
            without_force(log) if doubts else log, limit=math.radians(limit)
        )
        result = with_attitude(result, log, limit=math.radians(limit))
    result = replace(result, warnings=(*result.warnings, *doubts))
    declination = request.option("declination")
    if declination is None:
        return result
    value, sigma = declination_of(str(declination))
    stated = {"deg": value, "sigma_deg": sigma, "reference": "MAGNETIC"}
    return replace(result, extra={**result.extra, "declination": stated})


def declination_of(text: str) -> tuple[float, float | None]:
    """``D`` or ``D,SIGMA`` in degrees, or ``wmm:LATITUDE,LONGITUDE,HEIGHT_M,DAY`` of the model.

    Raises
    ------
    SurveyError
    """
    if text.startswith("wmm:"):
        return _of_model(text)
    try:
        numbers = [float(part) for part in text.split(",")]
    except ValueError:
        numbers = []
    usable = len(numbers) in (1, 2) and all(math.isfinite(n) for n in numbers)
    if not usable or abs(numbers[0]) > 180.0 or (len(numbers) == 2 and numbers[1] < 0.0):
        expected = "D or D,SIGMA in degrees, east positive"
        raise SurveyError(Problem("this is no declination", "declination", text, expected))
    return numbers[0], numbers[1] if len(numbers) == 2 else None


def _of_model(text: str) -> tuple[float, float]:
    """Declination and sigma of the World Magnetic Model [deg]."""
    parts = text.removeprefix("wmm:").split(",")
    try:
        latitude, longitude, height = (float(part) for part in parts[:3])
        (day,) = (dt.date.fromisoformat(part.strip()) for part in parts[3:])
    except ValueError:
        expected = "wmm:LATITUDE,LONGITUDE,HEIGHT_M,DAY as wmm:47.0,9.0,500,2026-03-01"
        raise SurveyError(
            Problem("this is no place and day of a model", "declination", text, expected)
        ) from None
    return model_declination(
        latitude_deg=latitude, longitude_deg=longitude, height_m=height, day=day
    )
