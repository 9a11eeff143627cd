"""``north --method fog-station``: a gyro of known constant on a total station."""

from __future__ import annotations

import math

from surveyapp.core.sensors.rate.fog_north_log import (
    NEEDED,
    OPTIONAL,
    FogNorthOptions,
    find_north,
)
from surveyapp.core.sensors.rate.parameters import DEG_H
from surveyapp.domain.north import NorthResult
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.sensor_logs.reading import Need
from surveyapp.workflows.north.request import NorthRequest
from surveyapp_models.angles import ARCSEC


def find(request: NorthRequest) -> NorthResult:
    """Find north from the rows of a log."""
    problems: list[Problem] = []
    latitude = request.latitude(problems)
    approximate = request.needed(
        "approximate_north_deg",
        problems,
        "a gyro that reads nothing points east or west: 180 degrees stay open without it",
    )
    constant = request.number("constant_deg", problems)
    sigma = request.number("constant_sigma_arcsec", problems)
    rate_sigma = request.number("rate_sigma_deg_h", problems)
    if rate_sigma is not None and not rate_sigma > 0.0:
        found = f"{rate_sigma:g}"
        problems.append(Problem("a sigma is not positive", "rate_sigma_deg_h", found, "above 0"))
    if sigma is not None and sigma < 0.0:
        found = f"{sigma:g}"
        where = "constant_sigma_arcsec"
        problems.append(Problem("a sigma is negative", where, found, "0 or more"))
    rule = request.option("reading_from_elevation")
    if rule is not None and rule not in ("increases", "decreases"):
        where = "reading_from_elevation"
        problems.append(
            Problem("there is no such rule", where, str(rule), "increases or decreases")
        )
    try:
        log = request.read(Need(columns=NEEDED, optional=OPTIONAL, timed="optional"))
    except SurveyError as error:
        raise SurveyError([*problems, *error.problems]) from None
    if problems or latitude is None:
        raise SurveyError(problems)
    options = FogNorthOptions(
        latitude=latitude,
        approximate_north=math.radians(approximate),
        constant=None if constant is None else math.radians(constant),
        constant_sigma=None if sigma is None else sigma * ARCSEC,
        rate_sigma=None if rate_sigma is None else rate_sigma * DEG_H,
        rule=None if rule is None else str(rule),
    )
    return find_north(log, options)
