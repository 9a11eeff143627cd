"""Sensor logs as files, re-exported by ``surveyapp.api``: look at one, take it into a project."""

from __future__ import annotations

import os
from collections.abc import Mapping
from datetime import date
from pathlib import Path
from typing import TYPE_CHECKING

from surveyapp.api.project import Folder
from surveyapp.api.sensors import LogOptions, open_sensor_log
from surveyapp.domain.calibration import Calibration
from surveyapp.domain.log_preview import LogPreview

if TYPE_CHECKING:
    from surveyapp.domain.advance import PartDone
    from surveyapp.domain.chart import SensorPictures
    from surveyapp.io.sensor_logs.reading import LogRequest
    from surveyapp.workflows.sensor_pictures import SensorResult


def preview_sensor_log(
    source: Folder, *, log: LogOptions | None = None, progress: PartDone | None = None
) -> LogPreview:
    """What would be understood of a log: columns, units, first values, and what is wrong.

    Parameters
    ----------
    source : path
        A CSV file.
    log : LogOptions, optional
    progress : callable, optional

    Raises
    ------
    SurveyError
        If it cannot be opened; what is wrong with its rows stands in ``problems``.
    """
    from surveyapp.workflows.registering_log import preview_log

    return preview_log(_request(source, log or LogOptions()), progress=progress)


def add_sensor_log(
    folder: Folder,
    source: Folder,
    *,
    identity: str = "",
    kind: str | None = None,
    log: LogOptions | None = None,
    programme: str | None = None,
    instrument: str | None = None,
    serial: str | None = None,
    latitude_deg: float | None = None,
    calibrated_on: date | None = None,
    options: Mapping[str, object] | None = None,
    progress: PartDone | None = None,
) -> LogPreview:
    """Take a log into a project: copied below ``sensors/``, pinned by its hash, entered.

    Parameters
    ----------
    folder : path
        Of the project.
    source : path
        A CSV file; one that lies in the folder stays where it is.
    identity : str
        Id of the ``[[sensor_log]]``; empty = the name of the file.
    kind : str, optional
        compass, tilt, rate or fog-station.
    log : LogOptions, optional
        Columns, units and scale, which are written into the entry.
    programme, instrument, serial : str, optional
    latitude_deg : float, optional
        [degrees]
    calibrated_on : datetime.date, optional
        Day of the record.
    options : mapping, optional
        Further keys of the entry, such as ``declination_deg``.
    progress : callable, optional

    Raises
    ------
    SurveyError
        With everything that is wrong; nothing is written then.
    """
    from surveyapp.workflows.registering_log import LogEntryWish, register_log

    wish = LogEntryWish(
        id=identity,
        kind=kind,
        programme=programme,
        instrument=instrument,
        serial=serial,
        latitude_deg=latitude_deg,
        calibrated_on=calibrated_on,
        more=options or {},
    )
    request = _request(source, log or LogOptions())
    return register_log(Path(folder), request, wish, progress=progress)


def sensor_pictures(
    result: SensorResult,
    source: Folder | None = None,
    *,
    sensor: str | None = None,
    log: LogOptions | None = None,
    progress: PartDone | None = None,
) -> SensorPictures:
    """What is plotted of a result of a sensor log.

    Parameters
    ----------
    result : Calibration, AllanResult, FilterResult, LineSpectrum, Motion, NorthResult or StopPlan
    source : path, optional
        The log of a calibration, or the project with ``sensor``: readings before and after are
        drawn from it.
    sensor : str, optional
    log : LogOptions, optional
    progress : callable, optional

    Raises
    ------
    SurveyError
        If the log cannot be read.
    """
    from surveyapp.workflows.sensor_pictures import pictures_of

    file = None
    if source is not None and isinstance(result, Calibration):
        file = open_sensor_log(source, sensor=sensor, log=log).file
    return pictures_of(result, file, progress=progress)


def _request(source: Folder, log: LogOptions) -> LogRequest:
    from surveyapp.io.sensor_logs.reading import LogRequest

    path = Path(source)
    return LogRequest(
        path=path,
        where=os.fspath(source),
        id=path.name,
        columns=log.columns,
        units=log.units,
        scale=log.scale,
        rate_hz=log.rate_hz,
        header_rows=log.header_rows,
    )
