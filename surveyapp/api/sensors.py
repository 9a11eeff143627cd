"""Sensors for scripts, re-exported by ``surveyapp.api``: read a log, calibrate, write a card."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from surveyapp.api.project import SOFTWARE, Folder, open_project, require
from surveyapp.domain.advance import stage
from surveyapp.domain.calibration import Calibration
from surveyapp.domain.noise import AllanResult, FilterResult
from surveyapp.domain.subject import Subject
from surveyapp.domain.warning import told_about
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said

if TYPE_CHECKING:
    from surveyapp.domain.advance import PartDone
    from surveyapp.domain.sensor_entry import SensorLogEntry
    from surveyapp.io.sensor_logs.reading import LogFile
    from surveyapp.workflows.compensating import CompensationResult


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

    @property
    def subject(self) -> Subject:
        """The sensor log: what warnings of its results are about."""
        return Subject.of("sensor", self.file.request.id if self.entry is None else self.entry.id)

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
                Problem("`sensor` names a log of a project", "sensor", found, expected)
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
        hint = said("`sensor` ID names it; the project has: {names}", names=names)
        raise SurveyError(Problem("which sensor log?", os.fspath(source), "", "`sensor` ID", hint))
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
    progress: PartDone | None = None,
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
    result = told_about(run_calibration(request), opened.subject)
    if card is not None and result.met:
        write_card(Path(card), result, request, software=SOFTWARE)
    return result


def allan(
    source: Folder,
    *,
    sensor: str | None = None,
    log: LogOptions | None = None,
    column: str | None = None,
    estimator: Literal["oadev", "adev"] = "oadev",
    taus: Sequence[float] | None = None,
    allow_outside: bool = False,
    progress: PartDone | None = None,
) -> AllanResult:
    """Allan deviation with intervals, and the noise coefficients, of the columns of a log.

    Parameters
    ----------
    source : path
        A CSV file, or a project folder together with ``sensor``.
    sensor : str, optional
    log : LogOptions, optional
    column : str, optional
        One column by its canonical name or its name in the file; by default every sensor column.
    estimator : str
        ``oadev`` or ``adev``.
    taus : sequence of float, optional
        Averaging times [s]; by default 1, 2, 4 ... samples up to a quarter of the record.
    allow_outside : bool
    progress : callable, optional

    Returns
    -------
    AllanResult

    Raises
    ------
    SurveyError
        For input that cannot be used.
    """
    from surveyapp.workflows.adopted_effects import left_in
    from surveyapp.workflows.noise import allan_of_log

    opened = open_sensor_log(source, sensor=sensor, log=log, allow_outside=allow_outside)
    found = allan_of_log(
        opened.file, column=column, estimator=estimator, taus=taus, progress=progress
    )
    found = replace(found, warnings=(*found.warnings, *left_in(opened.entry)))
    return told_about(found, opened.subject)


def filter_log(
    source: Folder,
    *,
    name: str = "kalman",
    sensor: str | None = None,
    log: LogOptions | None = None,
    column: str | None = None,
    q: float | None = None,
    r: float | None = None,
    seed: int = 1,
    out: Folder | None = None,
    allow_outside: bool = False,
    progress: PartDone | None = None,
) -> FilterResult:
    """Filter a column of a log, and tell what it costs: deviation ratios with the lag of a step.

    Parameters
    ----------
    source : path
    name : str
        kalman, sage-husa or particle.
    sensor : str, optional
    log : LogOptions, optional
    column : str, optional
        May be left out where the log has one sensor column only.
    q, r : float, optional
        Variances in the unit of the column squared, per sample.
    seed : int
        Of the particle filter and of the step test.
    out : path, optional
        A CSV file for the raw and the filtered series.
    allow_outside : bool
    progress : callable, optional

    Returns
    -------
    FilterResult

    Raises
    ------
    SurveyError
        For input that cannot be used.
    """
    from surveyapp.workflows.adopted_effects import left_in
    from surveyapp.workflows.filtering import filter_log as run

    opened = open_sensor_log(source, sensor=sensor, log=log, allow_outside=allow_outside)
    filtered = progress if out is None else stage(progress, 0.0, 0.5)
    result, columns = run(
        opened.file, name=name, column=column, q=q, r=r, seed=seed, progress=filtered
    )
    if out is not None:
        from surveyapp.io.sensor_logs.writing import write_columns

        source_file = opened.file.request.path
        written = stage(progress, 0.5, 1.0)
        write_columns(Path(out), columns, inputs=(source_file,), progress=written)
    result = replace(result, warnings=(*result.warnings, *left_in(opened.entry)))
    return told_about(result, opened.subject)


def compensate(
    kind: str,
    source: Folder,
    *,
    card: Folder,
    out: Folder,
    declination: str | None = None,
    sensor: str | None = None,
    log: LogOptions | None = None,
    allow_outside: bool = False,
    progress: PartDone | None = None,
) -> CompensationResult:
    """Apply a sensor card to a log, and write the corrected columns.

    Parameters
    ----------
    kind : str
        compass, tilt or rate.
    source : path
    card : path
        A sensor card; refused outside its days and temperatures.
    out : path
        The CSV file to write.
    declination : str, optional
        ``D`` or ``D,SIGMA`` [degrees, east positive]: only for a compass.
    sensor, log, allow_outside, progress
        As of ``calibrate``.

    Returns
    -------
    CompensationResult

    Raises
    ------
    SurveyError
        If the card does not hold for this log, and for input that cannot be used.
    """
    import math

    from surveyapp.core.sensors.compensation import Declination
    from surveyapp.io.outputs import check_output
    from surveyapp.workflows.calibrating.compass import declination_of
    from surveyapp.workflows.compensating import compensate_log, write_compensated

    opened = open_sensor_log(source, sensor=sensor, log=log, allow_outside=allow_outside)
    check_output(Path(out), (opened.file.request.path, Path(card)))
    added = None
    if declination is not None:
        value, sigma = declination_of(declination)
        added = Declination(math.radians(value), None if sigma is None else math.radians(sigma))
    parts, record, used = compensate_log(
        kind,
        opened.file,
        Path(card),
        entry=opened.entry,
        today=datetime.now(UTC).astimezone().date(),
        declination=added,
        progress=progress,
    )
    written = write_compensated(
        parts, record, used, kind=kind, card_path=os.fspath(card), out=Path(out)
    )
    return told_about(written, opened.subject)
