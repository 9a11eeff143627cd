"""Pictures of a sensor result: the log is read again for what the result does not hold."""

from __future__ import annotations

from typing import Final

from surveyapp.core.sensors.charts import logs, results
from surveyapp.core.sensors.charts.north import north_charts
from surveyapp.core.sensors.rate.stop_plan import StopPlan
from surveyapp.domain.advance import PartDone
from surveyapp.domain.calibration import Calibration
from surveyapp.domain.chart import Picture, SensorPictures
from surveyapp.domain.line_spectrum import LineSpectrum
from surveyapp.domain.motion import Motion
from surveyapp.domain.noise import AllanResult, FilterResult
from surveyapp.domain.north import NorthResult
from surveyapp.domain.sensor_log import STANDARD_GRAVITY_M_S2, SensorLog
from surveyapp.io.sensor_logs.reading import LogFile, Need
from surveyapp.workflows.calibrating.tilt import DIVIDING_HEAD, TWO_AXES

SensorResult = (
    Calibration | AllanResult | FilterResult | LineSpectrum | Motion | NorthResult | StopPlan
)

COMPASS: Final = ("mag_x_uT", "mag_y_uT", "mag_z_uT")
FORCE: Final = ("acc_x_m_s2", "acc_y_m_s2", "acc_z_m_s2")
NEEDS: Final = {
    "compass": Need(columns=COMPASS, timed="required"),
    "swing": Need(columns=(*COMPASS, "heading_deg"), optional=FORCE, timed="optional"),
    "tilt": Need(columns=TWO_AXES, optional=("temperature_c",), timed="optional"),
    "dividing-head": DIVIDING_HEAD,
}
"""What the pictures of a kind of calibration need of its log."""


def pictures_of(
    result: SensorResult, file: LogFile | None = None, *, progress: PartDone | None = None
) -> SensorPictures:
    """Pictures of a result.

    Parameters
    ----------
    result : result of a calibration, an Allan deviation, a filter, a spectrum, a motion, a north
        or a plan
    file : LogFile or None
        The log, for calibrations; without it those that need the log have no picture of it.
    progress : callable, optional
    """
    match result:
        case AllanResult():
            made, source = results.allan_charts(result), result.source
        case FilterResult():
            made, source = results.filter_charts([result]), result.source
        case LineSpectrum():
            made, source = results.spectrum_charts(result), result.source
        case Motion():
            made, source = results.motion_charts(result), result.source
        case NorthResult():
            made, source = north_charts(result), result.source
        case StopPlan():
            made, source = results.plan_charts(result), result.grade.id
        case Calibration():
            made, source = _of_calibration(result, file, progress), result.source
    return SensorPictures(source, made)


def _of_calibration(
    result: Calibration, file: LogFile | None, progress: PartDone | None
) -> tuple[Picture, ...]:
    made = [*results.table_charts(result), *results.turns_of(result)]
    made += logs.stop_pictures(result, gravity=STANDARD_GRAVITY_M_S2)
    kind = _kind(result, file)
    if file is not None and kind in NEEDS:
        made += _of_log(kind, file.read(NEEDS[kind], progress=progress), result)
    return tuple(made)


def _kind(result: Calibration, file: LogFile | None) -> str:
    """The kind of picture: a swing is a compass log with known headings."""
    if result.kind == "compass" and file is not None and file.has("heading_deg"):
        return "swing"
    return result.kind


def _of_log(kind: str, log: SensorLog, result: Calibration) -> tuple[Picture, ...]:
    makers = {
        "compass": logs.compass_pictures,
        "swing": logs.swing_pictures,
        "tilt": logs.tilt_pictures,
        "dividing-head": logs.head_pictures,
    }
    return makers[kind](log, result)
