"""``diagnose --sensor``: the loop on a log of a project."""

from __future__ import annotations

from surveyapp.diagnosis.sensors.diagnosis import SensorDiagnosis, diagnose_sensor
from surveyapp.diagnosis.sensors.records import compass_record, tilt_record
from surveyapp.domain.sensor_log import QUATERNION
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.sensor_logs.blocks import Progress
from surveyapp.io.sensor_logs.reading import LogFile, Need

MAG = ("mag_x_uT", "mag_y_uT", "mag_z_uT")
PLACE = ("ref_px_m", "ref_py_m", "ref_pz_m")
TILT = ("tilt_along_arcsec", "tilt_across_arcsec", "ref_along_arcsec", "ref_across_arcsec")
FEWEST = 40
"""Rows below which no effect is told from noise."""


def diagnose_log(
    kind: str | None, identity: str, file: LogFile, *, progress: Progress | None = None
) -> SensorDiagnosis:
    """Diagnose a compass or a tilt log.

    Parameters
    ----------
    kind : str or None
        compass or tilt; None = by its columns.
    identity : str
    file : LogFile
    progress : callable, optional

    Raises
    ------
    SurveyError
        If the log is of another kind or too short, and for what is wrong with it.
    """
    if kind is None:
        kind = "compass" if file.has(*MAG) else "tilt"
    if kind == "compass":
        attitude = QUATERNION if file.has(*QUATERNION) else ()
        place = PLACE if file.has(*PLACE) else ()
        log = file.read(
            Need(columns=(*MAG, *attitude, *place), varying=MAG, optional=("temperature_c",)),
            progress=progress,
        )
    elif kind == "tilt":
        need = Need(columns=TILT, varying=TILT, optional=("temperature_c",), timed="optional")
        log = file.read(need, progress=progress)
    else:
        what, expected = "logs of this kind are not diagnosed by themselves", "compass | tilt"
        raise SurveyError(Problem(what, identity, kind, expected))
    if log.size < FEWEST:
        found, expected = f"{log.size} rows", f"{FEWEST} rows or more"
        raise SurveyError(Problem("the log is too short to diagnose", log.path, found, expected))
    record = compass_record(log) if kind == "compass" else tilt_record(log)
    return diagnose_sensor(record, identity=identity, n_log=log.size, warnings=log.warnings)
