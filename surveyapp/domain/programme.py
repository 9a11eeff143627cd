"""A guided programme: the steps of a calibration as data, and what was written of a run of it.

A run is a list of entries that is only ever appended to. What a step means stands in the programme;
what was read, when and by whom stands in the entries.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime
from typing import Any, Final, Literal

from surveyapp.domain.calibration import Calibration
from surveyapp.domain.north import NorthResult
from surveyapp.domain.sensor_entry import SensorKind

StepKind = Literal["do", "wait", "read", "record"]
BEGIN: Final = "begin"
STRIKE: Final = "strike"
LOG: Final = "log"
"""Steps of entries that are no step of the programme: the programme's id, a strike, a log file."""

Row = Mapping[str, float | str]
"""One reading, or one stretch of a log, by column."""


@dataclass(frozen=True, slots=True)
class ProgrammeStep:
    """One step.

    Parameters
    ----------
    id : str
        Unique in its programme, never renamed: it stands in written runs.
    title : str
    told : str
        What to do, in a sentence.
    kind : str
        ``do``: done by hand; ``wait``: minutes since another step; ``read``: a reading is typed;
        ``record``: found in a log.
    minutes : float
        Of a wait.
    since : str
        Step from whose moment the minutes count.
    asks : tuple of str
        Columns of a reading, in the order in which they are typed.
    row : mapping
        Columns of that reading that the step sets; of a record: what its stretches hold.
    part : str
        Group of steps, for the list.
    """

    id: str
    title: str
    told: str = ""
    kind: StepKind = "do"
    minutes: float = 0.0
    since: str = ""
    asks: tuple[str, ...] = ()
    row: Row = field(default_factory=dict)
    part: str = ""


@dataclass(frozen=True, slots=True)
class Programme:
    """The steps of a calibration.

    Parameters
    ----------
    id, title : str
    kind : SensorKind
    standard : str
        What it follows, for the record.
    steps : tuple of ProgrammeStep
    log_programme : str or None
        ``programme`` of the sensor log that comes of it.
    method : str or None
        ``method`` of a log that finds north.
    units : mapping of str to str
        Of the columns that are typed.
    ends_in : str
        ``calibrate`` or ``north``.
    needs : str
        What the last step must be told, as options: ``latitude=`` ...
    """

    id: str
    title: str
    kind: SensorKind
    standard: str
    steps: tuple[ProgrammeStep, ...]
    log_programme: str | None = None
    method: str | None = None
    units: Mapping[str, str] = field(default_factory=dict)
    ends_in: Literal["calibrate", "north"] = "calibrate"
    needs: str = ""

    def step(self, identity: str) -> ProgrammeStep | None:
        """A step by its id; None if there is none."""
        return next((step for step in self.steps if step.id == identity), None)

    @property
    def typed(self) -> bool:
        """Whether readings are typed; else they come from a log."""
        return any(step.kind == "read" for step in self.steps)

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "id": self.id,
            "title": self.title,
            "kind": self.kind,
            "standard": self.standard,
            "steps": [
                {"id": s.id, "title": s.title, "told": s.told, "kind": s.kind, "part": s.part}
                for s in self.steps
            ],
        }


@dataclass(frozen=True, slots=True)
class ProgrammeEntry:
    """One appended row of a run.

    Parameters
    ----------
    seq : int
    time : datetime.datetime
        With its offset.
    step : str
        Of the programme, or ``begin``, ``strike``, ``log``.
    value : str
        As typed: numbers separated by blanks; the id of the programme; a seq; a file.
    note : str
    """

    seq: int
    time: datetime
    step: str
    value: str = ""
    note: str = ""


@dataclass(frozen=True, slots=True)
class ProgrammeRun:
    """A run as it stands on the disk.

    Parameters
    ----------
    id : str
    programme : str
        Its id.
    entries : tuple of ProgrammeEntry
    path : str
        Relative to the project.
    """

    id: str
    programme: str
    entries: tuple[ProgrammeEntry, ...]
    path: str = ""

    @property
    def live(self) -> dict[str, ProgrammeEntry]:
        """The latest entry of every step that was not struck."""
        struck = {int(e.value) for e in self.entries if e.step == STRIKE and e.value.isdigit()}
        return {
            e.step: e for e in self.entries if e.seq not in struck and e.step not in (BEGIN, STRIKE)
        }

    @property
    def log(self) -> str | None:
        """The log file that the run was given, None where it has none."""
        entry = self.live.get(LOG)
        return None if entry is None else entry.value


StepStatus = Literal["open", "here", "done", "short"]


@dataclass(frozen=True, slots=True)
class StepState:
    """A step of a run.

    Parameters
    ----------
    step : ProgrammeStep
    status : str
        ``short``: done before its minutes were over.
    told : str
        What was read, or how many turns were found.
    """

    step: ProgrammeStep
    status: StepStatus
    told: str = ""


@dataclass(frozen=True, slots=True)
class Known:
    """What the design so far determines.

    Parameters
    ----------
    determined, undetermined : tuple of str
        Parameters.
    rank, of : int
        Of the design, nuisance unknowns among them.
    """

    determined: tuple[str, ...]
    undetermined: tuple[str, ...]
    rank: int
    of: int


@dataclass(frozen=True, slots=True)
class ProgrammeState:
    """Where a run stands, schema ``surveyapp.programme/1``.

    Parameters
    ----------
    run : ProgrammeRun
    programme : Programme
    steps : tuple of StepState
    known : Known
    warnings : tuple of str
        What a reader of the card must know, such as a warm-up that was too short.
    waits_min : float or None
        Minutes left of the wait that is open.
    """

    run: ProgrammeRun
    programme: Programme
    steps: tuple[StepState, ...]
    known: Known
    warnings: tuple[str, ...] = ()
    waits_min: float | None = None

    @property
    def here(self) -> ProgrammeStep | None:
        """The step that is next; None when every one is done."""
        return next((s.step for s in self.steps if s.status == "here"), None)

    @property
    def complete(self) -> bool:
        """Whether every step is done."""
        return self.here is None

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "schema": "surveyapp.programme/1",
            "id": self.run.id,
            "programme": self.programme.id,
            "standard": self.programme.standard,
            "steps": [
                {"id": s.step.id, "title": s.step.title, "status": s.status, "told": s.told}
                for s in self.steps
            ],
            "next": None if self.here is None else self.here.id,
            "complete": self.complete,
            "determined": list(self.known.determined),
            "undetermined": list(self.known.undetermined),
            "rank": self.known.rank,
            "of": self.known.of,
            "warnings": list(self.warnings),
        }


@dataclass(frozen=True, slots=True)
class ProgrammeResult:
    """What a run ended in, schema ``surveyapp.programme_result/1``.

    Parameters
    ----------
    state : ProgrammeState
    sensor : str
        Id of the ``[[sensor_log]]``.
    calibration : Calibration or None
    north : NorthResult or None
    card : str or None
        Path of the card that was written.
    """

    state: ProgrammeState
    sensor: str
    calibration: Calibration | None = None
    north: NorthResult | None = None
    card: str | None = None

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "schema": "surveyapp.programme_result/1",
            "sensor": self.sensor,
            "state": self.state.to_dict(),
            "calibration": None if self.calibration is None else self.calibration.to_dict(),
            "north": None if self.north is None else self.north.to_dict(),
            "card": self.card,
        }
