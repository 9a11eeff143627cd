"""What an oriented side answers of a rule book: its length, and the sigma of its direction."""

from __future__ import annotations

import math

from surveyapp.core.orientation.whole_project import Orientation
from surveyapp.core.tolerance.evaluate import Measured
from surveyapp.core.tolerance.quantities import quantity
from surveyapp.domain.subject import Subject
from surveyapp.languages import said
from surveyapp_models.angles import RHO_ARCSEC


def gyro_side_length(orientation: Orientation) -> list[Measured]:
    """Length of every side that a gyro oriented [m]."""
    name = "gyro_side_length"
    found = []
    for line in orientation.lines:
        result = line.result
        subject = Subject.line(result.station, result.target, result.instrument)
        if result.distance_m is None:
            text = said("missing: {needs}", needs=quantity(name).needs)
            found.append(Measured(name, None, subject.text, text, subject=subject))
        else:
            found.append(Measured(name, result.distance_m, subject.text, subject=subject))
    return found


def gyro_side_sigma(orientation: Orientation) -> list[Measured]:
    """Mean square error of the direction of every side that a gyro oriented [arcsec]."""
    name = "gyro_side_sigma"
    found = []
    for line in orientation.lines:
        result = line.result
        subject = Subject.line(result.station, result.target, result.instrument)
        direction = line.grid if line.grid is not None else line.true
        if direction is None or not math.isfinite(direction.sigma):
            text = said("missing: {needs}", needs=quantity(name).needs)
            found.append(Measured(name, None, subject.text, text, subject=subject))
        else:
            kind = said("grid azimuth") if line.grid is not None else said("true azimuth")
            value = direction.sigma * RHO_ARCSEC
            found.append(Measured(name, value, subject.text, kind, subject=subject))
    return found
