"""Diagnosis of sensor logs for scripts, re-exported by ``surveyapp.api``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from surveyapp.api.project import SOFTWARE, Folder, open_project
from surveyapp.api.sensors import LogOptions, open_sensor_log
from surveyapp.errors import Problem, SurveyError

if TYPE_CHECKING:
    from surveyapp.diagnosis.sensors.diagnosis import SensorDiagnosis
    from surveyapp.domain.advance import PartDone
    from surveyapp.domain.sensor_entry import SensorLogEntry
    from surveyapp.workflows.diagnosing_sensor import SensorDiagnosed


def diagnose_log(
    source: Folder,
    *,
    sensor: str | None = None,
    log: LogOptions | None = None,
    allow_outside: bool = False,
    effects: Folder | None = None,
    confirm: str | None = None,
    adopt: bool = False,
    keep: bool = False,
    progress: PartDone | None = None,
) -> SensorDiagnosis:
    """Find which effect a sensor log holds beyond the base model, and prove it.

    Parameters
    ----------
    source : path
        A project folder together with ``sensor``, or a CSV file of a compass or tilt sensor.
    sensor : str, optional
        Id of a ``[[sensor_log]]``; may be left out where the project has one only.
    log, allow_outside, progress
        As of ``calibrate``.
    effects : path or None
        A Python file with a tuple ``EFFECTS`` of the user's own effects.
    confirm : str or None
        Id of a second log of the same sensor, which chooses nothing.
    adopt : bool
        Write what is named under the log in project.toml.
    keep : bool
        Append the diagnosis to the project's ledger; adopting does so in any case.

    Returns
    -------
    SensorDiagnosis

    Raises
    ------
    SurveyError
        For input that cannot be used.
    """
    from surveyapp.io.user_effects.loading import load_effects
    from surveyapp.workflows.diagnosing_log import SecondLog, adopt_log
    from surveyapp.workflows.diagnosing_log import diagnose_log as run

    own = () if effects is None else load_effects(Path(effects))
    opened = open_sensor_log(source, sensor=sensor, log=log, allow_outside=allow_outside)
    entry = opened.entry
    if entry is None and (adopt or confirm is not None):
        where, expected = "adopt, confirm", "a project folder and `sensor`"
        raise SurveyError(Problem("a log by itself has no project", where, str(source), expected))
    second = None
    if confirm is not None:
        other = open_sensor_log(source, sensor=confirm, allow_outside=allow_outside)
        _same_kind(entry, other.entry)
        second = SecondLog(confirm, other.file)
    kind = None if entry is None else entry.kind
    identity = opened.file.request.id if entry is None else entry.id
    found = run(kind, identity, opened.file, own=own, confirm=second, progress=progress)
    if entry is None or not (adopt or keep):
        return found
    return adopt_log(found, open_project(source), entry, adopt=adopt, software=SOFTWARE)


def _same_kind(entry: SensorLogEntry | None, other: SensorLogEntry | None) -> None:
    """A second log confirms only what its own kind of sensor can show.

    Raises
    ------
    SurveyError
    """
    if entry is None or other is None or other.kind == entry.kind:
        return
    found, expected = other.kind or "", entry.kind or ""
    raise SurveyError(Problem("the log is of another kind", "confirm", found, expected))


def diagnose_sensor(
    folder: Folder,
    sensor: str,
    *,
    effects: Folder | None = None,
    confirm: str | None = None,
    adopt: bool = False,
    allow_outside: bool = False,
    log: bool = True,
) -> SensorDiagnosed:
    """Find which effect the model of a sensor lacks, and prove it on left-out stops.

    Parameters
    ----------
    folder : path
        Of a project.
    sensor : str
        Id of a ``[[sensor_log]]``.
    effects : path or None
        A Python file with a tuple ``EFFECTS`` of the user's own effects.
    confirm : str or None
        Id of a second log of the same sensor, which chooses nothing.
    adopt : bool
        Write what is named under the log in project.toml.
    allow_outside : bool
        Whether the log may lie outside the project folder.
    log : bool
        Append the diagnosis to the project's ledger where it can be written.

    Raises
    ------
    SurveyError
        For an unknown sensor, a kind without a diagnosis, or too few stops.
    """
    from surveyapp.io.user_effects.loading import load_effects
    from surveyapp.workflows.diagnosing_sensor import Second
    from surveyapp.workflows.diagnosing_sensor import diagnose_sensor as diagnose_log

    own = () if effects is None else load_effects(Path(effects))
    opened = open_sensor_log(folder, sensor=sensor, allow_outside=allow_outside)
    if opened.entry is None:
        raise SurveyError(
            Problem("a sensor is a log of a project", "sensor", str(folder), "a project folder")
        )
    second = None
    if confirm is not None:
        other = open_sensor_log(folder, sensor=confirm, allow_outside=allow_outside)
        _same_kind(opened.entry, other.entry)
        if other.entry is not None:
            second = Second(other.file, other.entry)
    return diagnose_log(
        opened.file,
        opened.entry,
        project=open_project(folder) if log or adopt else None,
        software=SOFTWARE,
        own=own,
        confirm=second,
        adopt=adopt,
    )
