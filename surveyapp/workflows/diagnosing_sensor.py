"""``diagnose --sensor``: the log of a sensor through the same engine as every other subject.

One line of ``CASES`` a kind of sensor; the module behind it makes the case of a log.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from typing import Any, Final

from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.engine import diagnose as run_engine
from surveyapp.diagnosis.plain_words import words_of
from surveyapp.diagnosis.result import Diagnosis
from surveyapp.domain.project import Project, ResultWarning
from surveyapp.domain.sensor_entry import SensorLogEntry
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.sensor_logs.reading import LogFile
from surveyapp.workflows.adopting import record
from surveyapp.workflows.diagnosing import Diagnosed
from surveyapp_models.effects.effect import Effect

CASES: Final = {
    "rate": "rate_case",
}
"""Kind of a sensor log to the module of ``workflows`` that makes its case."""


@dataclass(frozen=True, slots=True)
class SensorCase:
    """A case, what a reader must know of it, and further keys of the JSON.

    ``told`` makes keys of what was found.
    """

    case: Case
    warnings: tuple[ResultWarning, ...] = ()
    extra: dict[str, Any] = field(default_factory=dict)
    told: Callable[[Diagnosis], dict[str, Any]] | None = None


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
        """Nothing: an effect of a sensor goes to its card."""
        return self.found.written

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON, schema ``surveyapp.diagnose/1``."""
        return {**self.found.to_dict(), **self.extra}


def diagnose_sensor(
    file: LogFile,
    entry: SensorLogEntry,
    *,
    project: Project | None,
    software: str,
    own: Sequence[Effect] = (),
    now: datetime | None = None,
) -> SensorDiagnosed:
    """Diagnose the log of a sensor and append it to the ledger.

    Parameters
    ----------
    file : LogFile
    entry : SensorLogEntry
    project : Project or None
        Whose ledger is appended to; None writes nothing.
    software : str
    own : sequence of Effect
        The user's own.
    now : datetime, optional

    Raises
    ------
    SurveyError
    """
    if entry.kind not in CASES:
        known = " or ".join(CASES)
        raise SurveyError(
            Problem(
                "there is no diagnosis of this kind of log",
                f"[[sensor_log]] {entry.id}",
                entry.kind or "no kind",
                f"kind {known}",
            )
        )
    module = importlib.import_module(f"surveyapp.workflows.{CASES[entry.kind]}")
    made: SensorCase = module.case(file, entry, tuple(own))
    diagnosis = run_engine(made.case)
    notes = list(made.warnings)
    if project is not None:
        moment = (now or datetime.now(UTC)).isoformat(timespec="seconds")
        _, more = record(project, diagnosis, [], moment=moment, software=software)
        notes += more
    words = [note.text for note in notes] + list(words_of(diagnosis, made.case))
    told = replace(diagnosis, warnings=(*diagnosis.warnings, *notes))
    extra = made.extra | ({} if made.told is None else made.told(diagnosis))
    return SensorDiagnosed(Diagnosed(told, words=tuple(words)), extra)
