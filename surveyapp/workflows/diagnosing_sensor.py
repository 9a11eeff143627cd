"""``diagnose --sensor``: the log of a sensor through the same engine as every other subject.

One line of ``CASES`` a kind of sensor; the module behind it makes the case of a log.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from typing import Any, Final

from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.engine import diagnose as run_engine
from surveyapp.diagnosis.plain_words import words_of
from surveyapp.diagnosis.result import Diagnosis
from surveyapp.domain.project import Project
from surveyapp.domain.sensor_entry import SensorLogEntry
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.sensor_logs.reading import LogFile
from surveyapp.languages import either, said
from surveyapp.workflows.adopting import NotWritten, record_under, sensor_tables
from surveyapp.workflows.diagnosing import Diagnosed
from surveyapp_models.effects.effect import Effect

CASES: Final = {
    "rate": "rate_case",
    "fog-station": "fog_case",
}
"""Kind of a sensor log to the module of ``workflows`` that makes its case."""


@dataclass(frozen=True, slots=True)
class SensorCase:
    """A case, what a reader must know of it, and further keys of the JSON.

    ``finished`` adds what the case alone cannot show and its keys, ``told`` makes keys of what was
    found; ``sha256`` is that of the log, for which effects are adopted.
    """

    case: Case
    warnings: tuple[ResultWarning, ...] = ()
    extra: dict[str, Any] = field(default_factory=dict)
    told: Callable[[Diagnosis], dict[str, Any]] | None = None
    finished: Callable[[Diagnosis], tuple[Diagnosis, dict[str, Any]]] | None = None
    sha256: str = ""


@dataclass(frozen=True, slots=True)
class SensorDiagnosed:
    """A diagnosis of a sensor's log."""

    found: Diagnosed
    extra: dict[str, Any] = field(default_factory=dict)

    @property
    def diagnosis(self) -> Any:
        """As of every other subject."""
        return self.found.diagnosis

    @property
    def words(self) -> tuple[str, ...]:
        """The diagnosis in plain sentences."""
        return self.found.words

    @property
    def written(self) -> tuple[str, ...]:
        """Where adopted effects were written."""
        return self.found.written

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON, schema ``surveyapp.diagnose/1``."""
        return {**self.found.to_dict(), **self.extra}


@dataclass(frozen=True, slots=True)
class Second:
    """A second log of the same sensor, which chose nothing."""

    file: LogFile
    entry: SensorLogEntry


def diagnose_sensor(
    file: LogFile,
    entry: SensorLogEntry,
    *,
    project: Project | None,
    software: str,
    own: Sequence[Effect] = (),
    confirm: Second | None = None,
    adopt: bool = False,
    now: datetime | None = None,
) -> SensorDiagnosed:
    """Diagnose the log of a sensor, append it to the ledger, and adopt where asked.

    Parameters
    ----------
    file : LogFile
    entry : SensorLogEntry
    project : Project or None
        Whose ledger is appended to; None writes nothing.
    software : str
    own : sequence of Effect
        The user's own.
    confirm : Second, optional
    adopt : bool
        Whether named effects are written under the log in project.toml.
    now : datetime, optional

    Raises
    ------
    SurveyError
    """
    made = _case_of(file, entry, own)
    second = None
    if confirm is not None:
        second = _case_of(confirm.file, confirm.entry, own).case
    diagnosis = run_engine(made.case, confirm=second)
    extra = made.extra
    if made.finished is not None:
        diagnosis, keys = made.finished(diagnosis)
        extra = extra | keys
    notes = [*made.warnings, *already_adopted(entry)]
    written: tuple[str, ...] = ()
    refused: tuple[NotWritten, ...] = ()
    if project is not None:
        tables: list[dict[str, object]] = []
        if adopt:
            records = [
                replace(a.record, data_sha256=made.sha256) if made.sha256 else a.record
                for a in diagnosis.adopted
            ]
            tables, refused = sensor_tables(records, entry)
        written, more = write_under(
            project, entry, diagnosis.ledger, tables, software=software, now=now
        )
        notes += more
    words = [note.text for note in notes] + list(words_of(diagnosis, made.case))
    words += [f"Not written: {item}." for item in refused]
    told = replace(diagnosis, warnings=(*diagnosis.warnings, *notes))
    extra = extra | ({} if made.told is None else made.told(diagnosis))
    found = Diagnosed(told, written=written, not_written=refused, words=tuple(words))
    return SensorDiagnosed(found, {"identity": entry.id, **extra})


def already_adopted(entry: SensorLogEntry) -> list[ResultWarning]:
    """That effects of a log are adopted already."""
    if not entry.effects:
        return []
    names = ", ".join(dict.fromkeys(effect.id for effect in entry.effects))
    text = said(
        "Sensor log {id} has adopted {names} already; this diagnosis is about "
        "the log without it, so that it is found again.",
        id=entry.id,
        names=names,
    )
    return [ResultWarning("already_adopted", text)]


def write_under(
    project: Project,
    entry: SensorLogEntry,
    ledger: Mapping[str, Any],
    tables: Sequence[Mapping[str, object]],
    *,
    software: str,
    now: datetime | None = None,
) -> tuple[tuple[str, ...], list[ResultWarning]]:
    """Append a diagnosis to the ledger and write what is adopted under the log."""
    moment = (now or datetime.now(UTC)).isoformat(timespec="seconds")
    stamped = [{**t, "adopted_at": moment, "software": software} for t in tables]
    return record_under(
        project, ("sensor_log", entry.id), ledger, stamped, moment=moment, software=software
    )


def _case_of(file: LogFile, entry: SensorLogEntry, own: Sequence[Effect]) -> SensorCase:
    if entry.kind not in CASES:
        known = either(("compass", "tilt", *CASES))
        raise SurveyError(
            Problem(
                "there is no diagnosis of this kind of log",
                f"[[sensor_log]] {entry.id}",
                entry.kind or "no kind",
                said("kind {known}", known=known),
            )
        )
    module = importlib.import_module(f"surveyapp.workflows.{CASES[entry.kind]}")
    made: SensorCase = module.case(file, entry, tuple(own))
    return made
