"""Magnetic declination of the World Magnetic Model, through the extra ``pygeomag``.

A model knows nothing of the iron of a mine: its sigma of 0.3 to 0.5 degrees never passes a
pre-orientation of 10 minutes and 60 minutes barely; that needs the declination from a known line,
found with the same compass.
"""

from __future__ import annotations

import datetime as dt
import math
from typing import Final

import numpy as np

from surveyapp.domain.sensor_log import SensorLog
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said

LEAST_DEG: Final = 0.31
LARGEST_DEG: Final = 0.50
"""Sigma of a model declination where the horizontal field is strongest and weakest."""


def model_declination(
    *, latitude_deg: float, longitude_deg: float, height_m: float, day: dt.date
) -> tuple[float, float]:
    """Declination, east positive, and its sigma [deg].

    Parameters
    ----------
    latitude_deg, longitude_deg : float
        North and east positive [deg].
    height_m : float
        Above the ellipsoid [m]; the library takes kilometres.
    day : datetime.date
        Within the five years of the model.

    Returns
    -------
    tuple of float

    Raises
    ------
    SurveyError
        If the extra is not installed, a value is out of range, the day lies outside the model's
        life, or the horizontal field is too weak there.
    """
    problems = [
        Problem(
            said("{name} is out of range", name=name),
            "declination",
            f"{value:g}",
            said("{low:g} to {high:g}", low=low, high=high),
        )
        for name, value, low, high in (
            ("latitude", latitude_deg, -90.0, 90.0),
            ("longitude", longitude_deg, -180.0, 360.0),
            ("height in metres", height_m, -10_000.0, 20_000.0),
        )
        if not low <= value <= high
    ]
    if problems:
        raise SurveyError(problems)
    try:
        from pygeomag import GeoMag
    except ImportError:
        hint = "pip install 'surveyapp[mag]', or state `declination` D,SIGMA"
        what = "the World Magnetic Model is not installed"
        raise SurveyError(Problem(what, "declination", "", "the extra mag", hint)) from None
    first = dt.date(day.year, 1, 1)
    year = day.year + (day - first).days / (dt.date(day.year + 1, 1, 1) - first).days
    try:
        found = GeoMag().calculate(
            glat=latitude_deg, glon=longitude_deg, alt=height_m / 1000.0, time=year
        )
    except ValueError as error:
        expected = "a day within the five years of the model"
        hint = "update pygeomag: a new model comes every five years"
        raise SurveyError(
            Problem(
                said("the model does not hold: {error}", error=error),
                "declination",
                str(day),
                expected,
                hint,
            )
        ) from None
    if found.in_blackout_zone:
        found_text = f"{found.h:.0f} nT"
        raise SurveyError(
            Problem("the horizontal field is too weak for a compass", "declination", found_text)
        )
    sigma = float(found.calculate_uncertainty().d)
    if not math.isfinite(sigma):
        raise SurveyError(Problem("the model has no uncertainty here", "declination"))
    return float(found.d), sigma


def unstated_sigma(log: SensorLog) -> float:
    """Sigma of a declination of which none is stated: that of a model [rad], .31 to .50 degrees.

    sqrt(0.26^2 + (5625 nT / H)^2), WMM2020 technical report (NOAA), H the horizontal field; .50
    where the log does not tell its horizontal part.
    """
    field, up = log.vector("mag"), log.vector("acc")
    if field is None or up is None:
        return math.radians(LARGEST_DEG)
    unit = up / np.linalg.norm(up, axis=1)[:, None]
    level = field - np.sum(field * unit, axis=1)[:, None] * unit
    size = 1000.0 * float(np.median(np.linalg.norm(level, axis=1)))
    known = math.hypot(0.26, 5625.0 / size) if size > 0.0 else LARGEST_DEG
    return math.radians(min(LARGEST_DEG, max(LEAST_DEG, known)))


def told_unstated(sigma: float) -> ResultWarning:
    """That a declination without a sigma has been given this one [rad]."""
    text = said(
        "the declination has no sigma: that of a model, {sigma:.2f} degrees, is in the sigma of "
        "the heading (--declination D,SIGMA)",
        sigma=math.degrees(sigma),
    )
    return ResultWarning("no_declination_sigma", text)
