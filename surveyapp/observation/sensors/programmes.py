"""A run of a guided programme at the desk: what is next, one line typed, nothing lost."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from surveyapp import api
from surveyapp.domain.advance import PartDone
from surveyapp.domain.programme import LOG, STRIKE, Programme, ProgrammeRun, ProgrammeState
from surveyapp.errors import Problem
from surveyapp.io.filing.lock import ProjectLock
from surveyapp.observation.sensors.desk import card_path
from surveyapp.observation.sensors.options import told_options
from surveyapp.observation.sensors.tasks import Examined

LOG_SIGN = "log="
"""What a line begins with that names the log of a run."""


@dataclass(frozen=True, slots=True)
class RunShown:
    """A run in the list, or why it cannot be read."""

    run: ProgrammeRun
    programme: Programme
    done: int
    of: int


def runs_of(folder: str) -> tuple[tuple[RunShown, ...], tuple[Problem, ...]]:
    """Every run of a project that was begun; steps found in a log are not counted here."""
    from surveyapp.core.sensors.programmes.state import BY_ID
    from surveyapp.io.programmes import read_runs

    runs, problems = read_runs(Path(folder))
    shown = []
    for run in runs:
        programme = BY_ID.get(run.programme)
        if programme is not None:
            typed = [step.id for step in programme.steps if step.kind != "record"]
            done = sum(step in run.live for step in typed)
            shown.append(RunShown(run, programme, done, len(typed)))
    return tuple(shown), problems


def free_id(folder: str, programme: str) -> str:
    """An id for a new run that nobody has."""
    taken = {shown.run.id for shown in runs_of(folder)[0]}
    taken |= {entry.id for entry in api.open_project(folder).sensor_logs}
    number = 1
    while f"{programme}-{number}" in taken:
        number += 1
    return f"{programme}-{number}"


class ProgrammeDesk:
    """One run, open for going on.

    Parameters
    ----------
    folder : str
        Project folder.
    identity : str
        Of the run.
    now : callable
        Wall clock.

    Raises
    ------
    SurveyError
        If the run cannot be read.
    """

    def __init__(self, folder: str, identity: str, *, now: Callable[[], datetime]) -> None:
        self.folder = folder
        self.identity = identity
        self.now = now
        self.state = self.look()

    @property
    def programme(self) -> Programme:
        """What is gone through."""
        return self.state.programme

    def log_options(self) -> str:
        """How the columns of the log are to be understood, as it was told."""
        from surveyapp.io.programmes import read_run

        entry = read_run(Path(self.folder), self.identity).live.get(LOG)
        return "" if entry is None else entry.note

    def look(self) -> ProgrammeState:
        """Where the run stands now, its log read as far as it is written."""
        told = told_options("add", self.log_options())
        self.state = api.programme_state(self.folder, self.identity, log=told.log, now=self.now())
        return self.state

    def log_mark(self) -> tuple[int, int] | None:
        """What tells one state of the log from another; None without a log."""
        name = self.state.run.log
        if name is None:
            return None
        try:
            found = (Path(self.folder) / name).stat()
        except OSError:
            return None
        return found.st_size, found.st_mtime_ns

    def record(self, step: str, text: str) -> ProgrammeState:
        """Write one line down: a reading, that a step is done, or ``log=FILE options``.

        Raises
        ------
        SurveyError
            If the reading is none; nothing is written then.
        """
        if text.startswith(LOG_SIGN):
            path, _, options = text.removeprefix(LOG_SIGN).partition(" ")
            told_options("add", options)
            api.record_programme(
                self.folder, self.identity, LOG, path, note=options.strip(), now=self.now()
            )
        else:
            api.record_programme(self.folder, self.identity, step, text, now=self.now())
        return self.look()

    def undo(self, reason: str) -> ProgrammeState:
        """Strike the latest entry; it stays in the file.

        Raises
        ------
        SurveyError
            If there is none.
        """
        api.record_programme(self.folder, self.identity, STRIKE, note=reason, now=self.now())
        return self.look()

    def writable(self) -> bool:
        """Whether the project may be written to now."""
        with ProjectLock(Path(self.folder)) as lock:
            return lock.writable

    def finish(self, options: str, *, progress: PartDone | None = None) -> Examined:
        """Calibrate, or find north; the card is written where everything is determined.

        Raises
        ------
        SurveyError
            As the command of the same name.
        """
        from surveyapp.report.sections.sensor_results import north_blocks
        from surveyapp.report.sections.sensors import calibration_body

        task = self.programme.ends_in
        told = told_options(task, options)
        read_as = told_options("add", self.log_options()).log
        result = api.finish_programme(
            self.folder,
            self.identity,
            options=told.own,
            log=read_as,
            card=Path(self.folder) / card_path(self.identity),
            now=self.now(),
            progress=progress,
        )
        if result.north is not None:
            return Examined(task, north_blocks(result.north), met=result.north.met)
        made = result.calibration
        if made is None:
            return Examined(task, (), met=False)
        pictures = api.sensor_pictures(made, self.folder, sensor=result.sensor)
        return Examined(
            task,
            calibration_body(made),
            pictures.pictures,
            made.met,
            made,
            options=options,
            card="" if result.card is None else card_path(self.identity),
        )
