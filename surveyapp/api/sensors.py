"""Sensors for scripts, re-exported by ``surveyapp.api``: read a log, calibrate, write a card."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

from surveyapp.api.project import SOFTWARE, Folder, open_project, require
from surveyapp.domain.calibration import Calibration
from surveyapp.errors import Problem, SurveyError

if TYPE_CHECKING:
    from surveyapp.domain.sensor_entry import SensorLogEntry
    from surveyapp.io.sensor_logs.blocks import Progress
    from surveyapp.io.sensor_logs.reading import LogFile


@dataclass(frozen=True, slots=True)
class LogOptions:
    """How the columns of a log are to be understood.

    Parameters
    ----------
    columns : mapping of str to str
        Canonical name to the name in the file.
    units : mapping of str to str
        Name in the file to a unit: uT nT mT G mG m/s2 g mg rad/s deg/s deg/h arcsec deg rad LSB 1.
    scale : mapping of str to float
        Name in the file to the value of one count.
    rate_hz : float or None
        Replaces a missing ``time_s``.
    header_rows : int or None
        Lines before the names of the columns, where they are not found by themselves.
    """

    columns: Mapping[str, str] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    scale: Mapping[str, float] = field(default_factory=dict)
    rate_hz: float | None = None
    header_rows: int | None = None


@dataclass(frozen=True, slots=True)
class OpenedLog:
    """A log whose head was looked at, with its entry where it is one of a project."""

    file: LogFile
    entry: SensorLogEntry | None
    folder: Path

    def to_dict(self) -> dict[str, object]:
        """Keys of the JSON, schema ``surveyapp.sensor_log/1``."""
        return {
            "schema": "surveyapp.sensor_log/1",
            "id": None if self.entry is None else self.entry.id,
            "kind": None if self.entry is None else self.entry.kind,
            "folder": str(self.folder),
        }


def open_sensor_log(
    source: Folder,
    *,
    sensor: str | None = None,
    log: LogOptions | None = None,
    allow_outside: bool = False,
) -> OpenedLog:
    """Look at the head of a log: a file, or a sensor log of a project.

    Parameters
    ----------
    source : path
        A CSV file, or a project folder together with ``sensor``.
    sensor : str, optional
        Id of a ``[[sensor_log]]``; may be left out where the project has one only.
    log : LogOptions, optional
    allow_outside : bool
        Whether a project's log may lie outside its folder.

    Raises
    ------
    SurveyError
    """
    from surveyapp.io.sensor_logs.reading import LogRequest, open_log
    from surveyapp.io.sensor_logs.tables import request_of

    options = log or LogOptions()
    path = Path(source)
    if not path.is_dir():
        if sensor is not None:
            found, expected = str(path), "a project folder"
            raise SurveyError(
                Problem("--sensor names a log of a project", "--sensor", found, expected)
            )
        request = LogRequest(
            path=path,
            where=os.fspath(source),
            id=path.name,
            columns=options.columns,
            units=options.units,
            scale=options.scale,
            rate_hz=options.rate_hz,
            header_rows=options.header_rows,
        )
        return OpenedLog(open_log(request), None, path.parent)
    entries = open_project(path).sensor_logs
    if sensor is None and len(entries) == 1:
        sensor = entries[0].id
    if sensor is None:
        names = ", ".join(entry.id for entry in entries) or "none"
        hint = f"--sensor ID names it; the project has: {names}"
        raise SurveyError(Problem("which sensor log?", os.fspath(source), "", "--sensor ID", hint))
    require(sensor, [entry.id for entry in entries], "sensor")
    entry = next(item for item in entries if item.id == sensor)
    override = {
        "columns": options.columns,
        "units": options.units,
        "scale": options.scale,
        "rate_hz": options.rate_hz,
        "header_rows": options.header_rows,
    }
    request = request_of(entry, path, allow_outside=allow_outside, override=override)
    return OpenedLog(open_log(request), entry, path)


def calibrate(
    kind: str,
    source: Folder,
    *,
    sensor: str | None = None,
    log: LogOptions | None = None,
    card: Folder | None = None,
    allow_outside: bool = False,
    options: Mapping[str, object] | None = None,
    progress: Progress | None = None,
) -> Calibration:
    """Calibrate a sensor from its log.

    Parameters
    ----------
    kind : str
        compass, tilt, ...: the kinds of ``surveyapp calibrate --help``.
    source : path
        A CSV file, or a project folder together with ``sensor``.
    sensor : str, optional
        Id of a ``[[sensor_log]]``.
    log : LogOptions, optional
    card : path, optional
        Where a sensor card is written.
    allow_outside : bool
    options : mapping, optional
        Of this kind, such as ``heading_limit_deg``.
    progress : callable, optional
        Called with the share of the file that was read.

    Returns
    -------
    Calibration

    Raises
    ------
    SurveyError
        For input that cannot be used.
    """
    from surveyapp.workflows.calibrating import CalibrationRequest, run_calibration, subject_of
    from surveyapp.workflows.calibrating.cards import write_card

    subject_of(kind)
    opened = open_sensor_log(source, sensor=sensor, log=log, allow_outside=allow_outside)
    if opened.entry is not None and opened.entry.kind not in (None, kind):
        where = f"[[sensor_log]] {opened.entry.id}"
        raise SurveyError(
            Problem("the log is of another kind", where, str(opened.entry.kind), kind)
        )
    request = CalibrationRequest(
        kind=kind,
        file=opened.file,
        entry=opened.entry,
        options=options or {},
        folder=opened.folder,
        today=datetime.now(UTC).astimezone().date(),
        progress=progress,
    )
    result = run_calibration(request)
    if card is not None and result.met:
        write_card(Path(card), result, request, software=SOFTWARE)
    return result
