"""Observing: a session opened for writing, one reading at a time, and what it says so far.

The screens call nothing else while a surveyor observes. A row is on the disk when ``record``
returns; what cannot be written is told in words and changes nothing.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from datetime import datetime
from functools import partial
from pathlib import Path
from typing import Final

from surveyapp import api
from surveyapp.core.observing.progress import Progress
from surveyapp.core.observing.steps import (
    STEP_NOTE,
    Step,
    StepState,
    current_step,
    rows_of,
    step_states,
    swing_begun,
)
from surveyapp.core.observing.target import target_of
from surveyapp.domain.project import OrientationSession, Project
from surveyapp.domain.readings import QUIET_KINDS, FieldBook, Reading, ReadingKind
from surveyapp.domain.results import OrientationResult
from surveyapp.errors import SurveyError
from surveyapp.io.fieldbook import append_row, book_columns, read_field_book
from surveyapp.io.fieldbook.clock import SessionClock, Stamp, local_now, steady_seconds
from surveyapp.io.fieldbook.problems import edited_problem, read_only_problem
from surveyapp.io.filing.lock import ProjectLock
from surveyapp.io.filing.seals import is_closed
from surveyapp.io.guarded import checked_inside
from surveyapp.io.project import read_project
from surveyapp.observation.aim import Aim
from surveyapp.observation.half_swing import half_swing_of
from surveyapp.observation.usable import unusable

FARTHEST: Final = 10.0
"""Periods beyond which a countdown is none: its moments stand on another clock than the session."""


@dataclass(frozen=True, slots=True)
class NewRow:
    """A row before it has a number.

    Parameters
    ----------
    kind : ReadingKind
    value, unit : str
        As it goes into the book.
    face, side, target, note : str
    """

    kind: ReadingKind
    value: str = ""
    unit: str = ""
    face: str = ""
    side: str = ""
    target: str = ""
    note: str = ""


class SessionDesk:
    """One session, open for observing.

    Parameters
    ----------
    folder : path
        Project folder.
    session : str
        Id of the session.
    now, steady : callable
        Wall clock, and seconds that never go back; for tests.

    Attributes
    ----------
    writable : bool
        False where another program has the project open, or the folder is read-only.
    project : Project
        As it stands after the last row.

    Raises
    ------
    SurveyError
        If the project cannot be used, or has no such session.
    """

    def __init__(
        self,
        folder: api.Folder,
        session: str,
        *,
        now: Callable[[], datetime] = local_now,
        steady: Callable[[], float] = steady_seconds,
    ) -> None:
        self.folder = Path(folder)
        self.session_id = session
        self._lock = ProjectLock(self.folder)
        self.closed = is_closed(self.folder, session)
        try:
            self.project = read_project(self.folder, observing=True)
            self._step: Step | None = None
            self._half_swing: tuple[float | None] | None = None
            self._clocks = now, steady
            self._begin_behind_the_book()
        except BaseException:
            self._lock.release()
            raise

    def _begin_behind_the_book(self) -> None:
        """Clock and columns follow the book as it stands."""
        now, steady = self._clocks
        self._columns = book_columns(self.path)
        self._mark = self._file_mark()
        self.clock = SessionClock(self.session.book.rows, now=now, steady=steady)

    @property
    def path(self) -> Path:
        """The field book's file, which lies in the project folder."""
        name = self.session.book_path
        return checked_inside(self.folder, name, where=self.session_id)

    def _file_mark(self) -> tuple[int, int, int] | None:
        """What tells one state of the file from another."""
        try:
            state = self.path.stat()
        except OSError:
            return None
        return state.st_ino, state.st_size, state.st_mtime_ns

    def changed_outside(self) -> bool:
        """Whether another hand has changed the book's file since it was read or written here."""
        return self._file_mark() != self._mark

    def read_again(self) -> None:
        """Take the book as another hand has left it.

        Raises
        ------
        SurveyError
            If it cannot be read so; what was known of it stays.
        """
        self._read_again(self.path)
        if self.writable:  # who only reads stays at the step that is looked at
            self._step = None
        self._begin_behind_the_book()

    @property
    def torn(self) -> str | None:
        """File beside the book that holds a torn last line, None where there is none."""
        name = f"{self.session.book_path}.torn"
        return name if (self.folder / name).exists() else None

    @property
    def writable(self) -> bool:
        """Whether rows may be written: not by a second opener, and not after closing."""
        return self._lock.writable and not self.closed

    @property
    def session(self) -> OrientationSession:
        """The session as it stands."""
        return self.project.session(self.session_id)

    @property
    def book(self) -> FieldBook:
        """Its field book as it stands."""
        return self.session.book

    @property
    def targets(self) -> tuple[str, ...]:
        """Targets of this set-up, the session's own first."""
        own = (self.session.target,) if self.session.target else ()
        sighted = [row.target for row in self.book.of_kind(ReadingKind.BACKSIGHT) if row.target]
        return tuple(dict.fromkeys((*own, *sighted)))

    @property
    def step(self) -> Step:
        """The step that the book stands at."""
        if self._step is not None:
            return self._step
        return current_step(self.book, self.session.method)

    def steps(self) -> tuple[StepState, ...]:
        """State of every step."""
        return step_states(self.book, self.session.method, self.targets)

    def rows(self, step: Step) -> tuple[Reading, ...]:
        """Live readings of a step."""
        return rows_of(self.book, step, self.session.method)

    def swing_begun(self) -> bool:
        """Whether what is read now can no longer stand before the observation."""
        return swing_begun(self.book, self.session.method)

    def latest_elapsed_s(self) -> float | None:
        """Latest elapsed time that stands in the book [s], None where there is none."""
        found = [row.elapsed_s for row in self.book.rows if row.elapsed_s is not None]
        return max(found, default=None)

    def record(self, row: NewRow, stamp: Stamp | None = None, *, timed: bool = True) -> int:
        """Append one row; it is on the disk when this returns.

        A turning point of the very moment of another one is written without a moment. Elapsed
        seconds never go back in a book: a reading of an earlier moment than a row above it carries
        its time alone, and so do strikes and remarks, which measure nothing.

        Parameters
        ----------
        row : NewRow
        stamp : Stamp or None
            When the reading was taken; this moment if None.
        timed : bool
            False writes no moment at all: a book that is typed up afterwards.

        Returns
        -------
        int
            seq of the row.

        Raises
        ------
        SurveyError
            If the folder may not be written to, if the row cannot stand in the book, if another
            hand has changed the book, or if the disk refuses; the book is as it was in each case.
        """
        if not self.writable:
            raise SurveyError(read_only_problem(self.folder, closed=self.closed))
        if self.changed_outside():
            self.read_again()
            raise SurveyError(edited_problem(self.path))
        moment = stamp or self.clock.stamp()
        latest = self.latest_elapsed_s()
        timed = timed and not self._twice(row.kind, moment)
        quiet = row.kind in QUIET_KINDS and not row.note.startswith(STEP_NOTE)
        back = latest is not None and round(moment.elapsed_s, 3) < latest
        cells = {
            "time": moment.time.isoformat(timespec="milliseconds") if timed else "",
            "elapsed_s": "" if quiet or back or not timed else f"{moment.elapsed_s:.3f}",
            "kind": str(row.kind),
            "value": row.value,
            "unit": row.unit,
            "face": row.face,
            "side": row.side,
            "target": row.target,
            "note": row.note,
        }
        try:
            seq = append_row(
                self.path,
                self._fitting(cells),
                angle_unit=self.project.angle_unit,
                also=partial(unusable, self.session, row.kind),
            )
        finally:
            self._mark = self._file_mark()
        self._read_again(self.path)
        if row.kind not in QUIET_KINDS or row.note.startswith(STEP_NOTE):
            self._step = None
        return seq

    def _twice(self, kind: ReadingKind, moment: Stamp) -> bool:
        """Whether a turning point of this very moment stands in the book: not both are right."""
        elapsed = round(moment.elapsed_s, 3)
        turning = kind in (ReadingKind.REVERSAL, ReadingKind.SCALE_REVERSAL)
        return turning and any(row.elapsed_s == elapsed for row in self.book.of_kind(kind))

    def _fitting(self, cells: dict[str, str]) -> dict[str, str]:
        """Cells without the moment where an older book has no column for it."""
        return {
            name: text
            for name, text in cells.items()
            if name in self._columns or name not in ("time", "elapsed_s")
        }

    def _read_again(self, path: Path) -> None:
        book = read_field_book(path, angle_unit=self.project.angle_unit, repair=False)
        self.project = replace(
            self.project,
            sessions=tuple(
                replace(item, book=book) if item.id == self.session_id else item
                for item in self.project.sessions
            ),
        )

    def strike(self, seq: int, reason: str) -> int:
        """Strike a row; it stays in the book, and the next of its kind takes its place."""
        return self.record(NewRow(ReadingKind.STRIKE, value=str(seq), note=reason))

    def unstrike(self, seq: int, reason: str) -> int:
        """Take a strike back: the row counts again where it stands, and both stay in the book."""
        return self.record(NewRow(ReadingKind.UNSTRIKE, value=str(seq), note=reason))

    def last_live(self) -> Reading | None:
        """The latest reading that counts: what undo strikes."""
        struck = set(self.book.struck)
        for row in reversed(self.book.rows):
            if row.kind not in QUIET_KINDS and row.seq not in struck:
                return row
        return None

    def go_to(self, step: Step) -> None:
        """Note that the surveyor goes to a step, unless the book stands there already."""
        if step is self.step:
            return
        if not self.writable or "note" not in self._columns:  # who only reads leaves no trace
            self._step = step
        else:
            self.record(NewRow(ReadingKind.NOTE, note=f"{STEP_NOTE}{step}"))

    def aim(self) -> Aim:
        """Target of this session: its own wanted interval, else what the rule book tells."""
        own = target_of(self.session, None)
        if own is not None:
            return Aim(own)
        unusable = [w.text for w in self.project.warnings if w.code == "rule_book_unusable"]
        if unusable:
            return Aim(None, self.project.rule_book or "", unusable[0])
        book = self.project.rules
        return Aim(target_of(self.session, book), "" if book is None else book.id)

    def half_swing_s(self) -> float | None:
        """Half swing that the card tells for this method and latitude [s], None where it does not.

        Computed once: card and position do not change while a session is observed.
        """
        if self._half_swing is None:
            self._half_swing = (half_swing_of(self.project, self.session),)
        return self._half_swing[0]

    def remaining_s(self, progress: Progress) -> float | None:
        """Seconds to the next passage or turning point; None where not known or long past."""
        due, period = progress.due_s, progress.period_s
        if due is None:
            return None
        remaining = due - self.clock.stamp().elapsed_s
        if period is None:
            return remaining
        late = 0.25 if progress.passage is not None else 0.5
        return remaining if -late * period <= remaining <= FARTHEST * period else None

    def close(self) -> None:
        """Give the right to write back."""
        self._lock.release()


def progress(project: Project, session: str) -> Progress:
    """What a session says so far: forecast, interval, alarm.

    Parameters
    ----------
    project : Project
        A snapshot: nothing is read from the disk.
    session : str
        Id of the session.
    """
    from surveyapp.core.geodesy import grid_of, position_of
    from surveyapp.core.observing.by_method import progress_of
    from surveyapp.workflows.computing import generator_of

    item = project.session(session)
    grid = grid_of(project)
    position = position_of(project.station(item.station), grid)
    card = project.instrument(item.instrument).card
    rng = generator_of(project)
    return progress_of(item, card, rng, latitude=position.latitude)


def orient_observed(project: Project) -> OrientationResult:
    """Orient a project of which no session may be finished yet.

    Raises
    ------
    SurveyError
        If what has enough readings cannot be oriented.
    """
    from surveyapp.workflows.computing import judged, oriented

    found = oriented(project, all_if_none=False)
    return judged(found, software=api.SOFTWARE).result


def unfinished_session(project: Project) -> str | None:
    """The session to go on with: the one with the latest row that was begun here and not ended."""
    best: tuple[float, str] | None = None
    for session in project.sessions:
        begun = any(row.note.startswith(STEP_NOTE) for row in session.book.rows)
        if not begun or current_step(session.book, session.method) is Step.RESULT:
            continue
        last = next((r.time for r in reversed(session.book.rows) if r.time is not None), None)
        moment = last.timestamp() if last is not None else 0.0
        if best is None or moment > best[0]:
            best = (moment, session.id)
    return None if best is None else best[1]
