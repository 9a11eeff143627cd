"""Calibrating a sensor from its log: find the subject, read what it needs, estimate.

One line of ``SUBJECTS`` a kind; the module behind it holds ``calibrate(request) -> Calibration``.
"""

from __future__ import annotations

import importlib
from dataclasses import dataclass
from typing import Final, cast

from surveyapp.domain.calibration import Calibration
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.workflows.calibrating.request import CalibrationRequest


@dataclass(frozen=True, slots=True)
class CalibrationSubject:
    """One kind of sensor: its name, the module that calibrates it, one line for the help."""

    kind: str
    module: str
    summary: str


SUBJECTS: Final = (
    CalibrationSubject("compass", "compass", "electronic compass: hard and soft iron, swing"),
    CalibrationSubject("tilt", "tilt", "tilt sensor: two axes, or one on a dividing head"),
    CalibrationSubject("rate", "rate", "gyros and accelerometers on a table or by hand"),
    CalibrationSubject("fog-station", "fog_station", "fibre-optic gyro on a total station"),
    CalibrationSubject("edm", "edm", "distance meter on a line of pillars"),
)
"""Every kind that can be calibrated."""


def subject_of(kind: str) -> CalibrationSubject:
    """The subject of a kind.

    Raises
    ------
    SurveyError
        If there is none; the known ones are named.
    """
    for subject in SUBJECTS:
        if subject.kind == kind:
            return subject
    hint = nearest_names(kind, [subject.kind for subject in SUBJECTS])
    raise SurveyError(Problem("there is no calibration of this kind", "calibrate", kind, hint=hint))


def run_calibration(request: CalibrationRequest) -> Calibration:
    """Calibrate what the request names."""
    module = importlib.import_module(f"{__name__}.{subject_of(request.kind).module}")
    return cast("Calibration", module.calibrate(request))


__all__ = [
    "SUBJECTS",
    "CalibrationRequest",
    "CalibrationSubject",
    "run_calibration",
    "subject_of",
]
