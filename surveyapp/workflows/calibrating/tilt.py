"""``calibrate tilt``: a two-axis log against its reference, or one axis on a dividing head."""

from __future__ import annotations

from typing import Final

from surveyapp.core.sensors.clipping import without_clipped
from surveyapp.core.sensors.dividing_head import calibrate_dividing_head
from surveyapp.core.sensors.tilt_axes import calibrate_tilt_axes
from surveyapp.domain.calibration import Calibration
from surveyapp.io.sensor_logs.reading import Need
from surveyapp.workflows.calibrating.request import CalibrationRequest

TWO_AXES: Final = (
    "tilt_along_arcsec",
    "tilt_across_arcsec",
    "ref_along_arcsec",
    "ref_across_arcsec",
)
DIVIDING_HEAD: Final = Need(
    columns=("test",),
    optional=(
        "set",
        "angle_deg",
        "flip",
        "output",
        "frequency_hz",
        "impedance_ohm",
        "time_s",
        "temperature_c",
    ),
    timed="no",
    unit_stated=("output",),
)
REFERENCE_TEMPERATURE_C: Final = 20.0


def calibrate(request: CalibrationRequest) -> Calibration:
    """Calibrate a tilt sensor from its log."""
    if request.file.has("test"):
        return calibrate_dividing_head(without_clipped(request.read(DIVIDING_HEAD), ("output",)))
    reference = request.number("reference_temperature_c", REFERENCE_TEMPERATURE_C)
    log = request.read_adopted(
        Need(columns=TWO_AXES, varying=TWO_AXES, optional=("temperature_c",), timed="optional"),
        fitted=TWO_AXES[:2],
    )
    return calibrate_tilt_axes(log, reference_temperature_c=reference or 0.0)
