"""What the session screen knows beyond the book: what was chosen by key, and what is half typed.

It turns texts into calls of the API and answers of the API into texts. It draws nothing and
computes nothing.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from surveyapp.core.observing.progress import Progress
from surveyapp.core.observing.steps import BEFORE, STEP_NOTE, Expected, Step, kinds_of, steps_of
from surveyapp.core.observing.typed_rows import EntryError
from surveyapp.domain.readings import QUANTITY, QUIET_KINDS, Dimension, Face, Reading, ReadingKind
from surveyapp.errors import SurveyError
from surveyapp.io.fieldbook.clock import NOTICED_S, Stamp
from surveyapp.io.fieldbook.problems import read_only_problem
from surveyapp.languages import shown
from surveyapp.observation.entry import (
    Understood,
    expected,
    next_kind,
    next_target,
    understand,
)
from surveyapp.observation.session import NewRow, SessionDesk
from surveyapp.tui import texts
from surveyapp.tui.from_instrument import Taken, marked
from surveyapp.tui.views.question import question_text
from surveyapp_models.angles import AngleUnit, format_angle


class NotWrittenError(Exception):
    """A reading that was not written; the text says why and what to do."""


@dataclass(frozen=True, slots=True)
class Pending:
    """A text that stands in the line: what it was typed for, and when.

    Parameters
    ----------
    text : str
    step : Step
    kind : ReadingKind
    stamp : Stamp
        When its first character was typed.
    """

    text: str
    step: Step
    kind: ReadingKind
    stamp: Stamp


class Desk:
    """One observation and the choices of the surveyor.

    Parameters
    ----------
    observation : SessionDesk
    """

    def __init__(self, observation: SessionDesk) -> None:
        self.observation = observation
        self.progress: Progress | None = None
        self.kind: ReadingKind | None = None
        self.face: Face | None = None
        self.target: str | None = None
        self.pending: Pending | None = None
        self.taken = Taken()
        self.tried = False
        self.timed = True
        self.asked: str | None = None
        self.clock_off_s = -observation.clock.set_back_s

    @property
    def step(self) -> Step:
        """The step that the book stands at."""
        return self.observation.step

    @property
    def unit(self) -> AngleUnit:
        """The project's unit of angles."""
        return self.observation.project.angle_unit

    def what(self) -> Expected:
        """What is to be read next, the surveyor's choices applied."""
        found = expected(self.observation, self.step, self.progress, self.kind)
        if found.face is None:
            return found
        changed = self.target is not None or self.face is not None
        target = self.target if self.target is not None else found.target
        face = self.face if self.face is not None else found.face
        same = (target, face) == (found.target, found.face)
        near = found.near if same or not changed else None
        return replace(found, target=target, face=face, near=near)

    def closed(self) -> bool:
        """Whether the step takes nothing more because the swing has begun."""
        return self.step in BEFORE and self.observation.swing_begun()

    def step_name(self) -> str:
        """Name of the step in the trade's words."""
        if self.step is Step.SWING:
            return texts.SWING_NAMES[self.observation.session.method]
        return texts.STEP_NAMES[self.step]

    def prompt(self) -> str:
        """What is asked for."""
        if self.step is Step.RESULT:
            return texts.STEP_NAMES[self.step]
        what = self.what()
        detail = ""
        if what.face is not None:
            detail = texts.PROMPT_FACE.format(target=what.target, face=what.face)
        elif what.side is not None:
            detail = texts.PROMPT_SIDE.format(side=what.side)
        kind, _, unit = texts.KIND_NAMES[what.kind].partition(", ")
        shown = texts.PROMPT_UNIT.format(unit=unit) if unit else ""
        return texts.PROMPT.format(kind=kind, number=what.number, detail=detail, unit=shown)

    def hint(self) -> str:
        """What to do with the line."""
        if self.step is Step.RESULT:
            return texts.RESULT_HINT
        if self.what().kind is ReadingKind.TRANSIT:
            return texts.TRANSIT_HINT
        return texts.ENTRY_HINT

    def typing(self, text: str) -> str:
        """Stamp the beginning of an entry, and say how the text is understood so far."""
        self._keep_pending(text)
        if not text or self._strayed():
            return ""
        if text != self.asked:
            self.asked = None
        try:
            found = self._understand(text)
        except EntryError:
            return ""
        value = self.value_text(found)
        pattern = texts.UNDERSTOOD_COMPLETED if found.completed else texts.UNDERSTOOD
        return pattern.format(value=value)

    def _keep_pending(self, text: str) -> None:
        """A text keeps the moment and the kind of its first character until it is changed.

        Typing on and taking back are the same text; a text that Enter did not write, or that is
        replaced, is another one as soon as it is changed.
        """
        was = self.pending
        if not text:
            self.pending = self.asked = None
            self.tried = False
            return
        if was is not None and text == was.text:
            return
        grown = was is not None and (text.startswith(was.text) or was.text.startswith(text))
        if was is None or self.tried or not grown:
            self.tried = False
            stamp = self.observation.clock.stamp()
            self.pending = Pending(text, self.step, self.what().kind, stamp)
        else:
            self.pending = replace(was, text=text)

    def take_up(self, draft: Pending) -> None:
        """Go on with a text that was left half typed."""
        self.pending = draft
        self.tried = True

    def _strayed(self) -> bool:
        """Whether the text in the line was typed for something else than is asked for now."""
        was = self.pending
        return was is not None and (was.step, was.kind) != (self.step, self.what().kind)

    def obstacle(self, key: str) -> str:
        """Why a key does nothing while a text stands in the line, and what helps."""
        was = self.pending
        if was is None:
            return ""
        kind = texts.KIND_NAMES[was.kind].split(",")[0]
        told = {"text": was.text, "kind": kind, "key": key}
        try:
            self._check_place()
            found = self._understand(was.text)
        except EntryError as error:
            return texts.PENDING_REFUSED.format(**told, reason=shown(error.what))
        except NotWrittenError as error:
            if self.observation.writable:
                return str(error)  # which says what helps
            return texts.PENDING_REFUSED.format(**told, reason=str(error).rstrip("."))
        if found.questions and self.asked != was.text:
            self.asked = was.text  # it is asked now: Enter keeps it
            question = " ".join(question_text(item) for item in found.questions)
            return texts.PENDING_ASKED.format(**told, question=question)
        return texts.PENDING.format(**told)

    def _check_place(self) -> None:
        """Refuse a text where its kind is not taken, before it is understood."""
        if not self.observation.writable:
            problem = read_only_problem(self.observation.folder, closed=self.observation.closed)
            raise NotWrittenError(problem_text(SurveyError(problem)))
        was = self.pending
        if was is not None and self._strayed():
            kind = texts.KIND_NAMES[was.kind].split(",")[0]
            now = texts.KIND_NAMES[self.what().kind].split(",")[0]
            raise NotWrittenError(texts.STRAYED.format(kind=kind, now=now))
        if self.closed():
            raise NotWrittenError(texts.CLOSED_REFUSED)

    def _understand(self, text: str) -> Understood:
        stamp = self.pending.stamp if self.pending else self.observation.clock.stamp()
        return understand(
            self.observation,
            text,
            self.what(),
            progress=self.progress,
            stamp=stamp,
            timed=self.timed,
        )

    def value_text(self, found: Understood) -> str:
        """A reading as understood."""
        if QUANTITY[found.row.kind] is Dimension.ANGLE:
            shown = format_angle(found.value, self.unit)
            moment = f"{found.stamp.time:%H:%M:%S}" if found.timed else texts.NO_MOMENT
            return f"{shown}  {moment}"
        return f"{found.row.value or found.row.note} {found.row.unit}".strip()

    def enter(self, text: str) -> str:
        """Write a typed reading, or ask about it once.

        Returns
        -------
        str
            What to tell, once the row is on the disk.

        Raises
        ------
        NotWrittenError
            If nothing was written; the text stays typed.
        """
        self._keep_pending(text)
        self.tried = True
        self._check_place()
        try:
            found = self._understand(text)
        except EntryError as error:
            pattern = texts.REFUSED_EXPECTED if error.expected else texts.REFUSED
            raise NotWrittenError(
                pattern.format(what=shown(error.what), expected=shown(error.expected))
            ) from None
        if found.questions and self.asked != text:
            self.asked = text
            question = " ".join(question_text(item) for item in found.questions)
            raise NotWrittenError(texts.ASK_AGAIN.format(question=question))
        row = marked(found.row, text, self.taken)
        seq = self.write(row, found.stamp, timed=found.timed)
        kind = texts.KIND_NAMES[found.row.kind].split(",")[0]
        value = found.row.value or found.row.note
        told = texts.RECORDED.format(seq=seq, kind=kind, value=value)
        if not found.timed and self.timed:
            told += texts.RECORDED_UNTIMED
        return f"{told}{texts.STEP_COMPLETE if self.complete() else ''}"

    def clock_note(self) -> str:
        """That the computer's clock was set, once each time that it was."""
        off = self.observation.clock.wall_clock_off_s()
        if abs(off - self.clock_off_s) <= NOTICED_S:
            return ""
        self.clock_off_s = off
        return texts.CLOCK_SET.format(seconds=off)

    def complete(self) -> bool:
        """Whether the step has all that it needs, and nothing more is usual."""
        if self.step is Step.SWING:
            return False
        return any(s.step is self.step and s.complete for s in self.observation.steps())

    def write(self, row: NewRow, stamp: Stamp | None = None, *, timed: bool = True) -> int:
        """Write one row; what was chosen for it is done with."""
        try:
            seq = self.observation.record(row, stamp, timed=timed)
        except SurveyError as error:
            raise NotWrittenError(problem_text(error)) from None
        self.face = self.target = self.pending = self.asked = None
        self.tried = False
        if self.kind is not ReadingKind.TRANSIT:
            self.kind = None
        return seq

    def passage(self) -> str:
        """A timed passage of the scale's zero: stamped now, written at once."""
        if not self.timed:
            raise NotWrittenError(texts.PASSAGE_TYPED_UP)
        seq = self.write(NewRow(ReadingKind.TRANSIT, value="0", unit="div"))
        kind = texts.KIND_NAMES[ReadingKind.TRANSIT]
        return texts.RECORDED.format(seq=seq, kind=kind, value="0")

    def missed(self) -> str:
        """Note a turning point that was not read."""
        seq = self.write(NewRow(ReadingKind.MISSED), timed=self.timed)
        return texts.MISSED_NOTED.format(seq=seq)

    def remark(self, text: str) -> str:
        """Note a remark; a text in the line stays what it is."""
        if text.startswith(STEP_NOTE):  # it must not be taken for a step of the observation
            text = texts.REMARK_OF_STEP.format(text=text)
        try:
            seq = self.observation.record(NewRow(ReadingKind.NOTE, note=text))
        except SurveyError as error:
            raise NotWrittenError(problem_text(error)) from None
        return texts.REMARK_NOTED.format(seq=seq, text=text)

    def strike(self, seq: int, reason: str) -> str:
        """Strike a row with a reason."""
        try:
            self.observation.strike(seq, reason)
        except SurveyError as error:
            raise NotWrittenError(problem_text(error)) from None
        return texts.STRUCK.format(seq=seq, reason=reason)

    def unstrike(self, seq: int, reason: str) -> str:
        """Take a strike back, with a reason."""
        try:
            self.observation.unstrike(seq, reason)
        except SurveyError as error:
            raise NotWrittenError(problem_text(error)) from None
        return texts.UNSTRUCK.format(seq=seq, reason=reason)

    def undo(self) -> str:
        """Strike the latest reading that counts."""
        row = self.observation.last_live()
        if row is None:
            raise NotWrittenError(texts.NOTHING_TO_STRIKE)
        return self.strike(row.seq, texts.UNDO_REASON)

    def swings(self) -> bool:
        """Whether turning points are read now that may be missed."""
        turning = (ReadingKind.REVERSAL, ReadingKind.SCALE_REVERSAL, ReadingKind.TRANSIT)
        return self.step is Step.SWING and self.what().kind in turning

    def times(self) -> bool:
        """Whether passages are timed now."""
        return self.step is Step.SWING and self.what().kind is ReadingKind.TRANSIT

    def has_other(self, which: str) -> bool:
        """Whether there is another kind, face or target to read in this step."""
        if which == "kind":
            return len(kinds_of(self.step, self.observation.session.method)) > 1
        return self.what().face is not None

    def go(self, places: int) -> str:
        """Go on, or back, by some steps, and say where that is."""
        order = steps_of(self.observation.session.method)
        index = min(max(order.index(self.step) + places, 0), len(order) - 1)
        self.kind = self.face = self.target = None
        try:
            self.observation.go_to(order[index])
        except SurveyError as error:
            raise NotWrittenError(problem_text(error)) from None
        if self.closed():
            return texts.CLOSED_BEFORE
        return self.step_name()

    def take_other(self, which: str) -> None:
        """Take the other kind of reading, the other face, or the next target."""
        what = self.what()
        self.asked = None  # a doubt about one target or face is none about another
        if which == "kind":
            self.kind = next_kind(self.observation, what)
        elif which == "face":
            self.face = Face.RIGHT if what.face is Face.LEFT else Face.LEFT
        else:
            self.target = next_target(self.observation, what)

    def strikable(self) -> tuple[Reading, ...]:
        """Rows that may be struck, the latest first."""
        struck = set(self.observation.book.struck)
        rows = [r for r in self.observation.book.rows if r.kind not in QUIET_KINDS]
        return tuple(r for r in reversed(rows) if r.seq not in struck)

    def struck(self) -> tuple[Reading, ...]:
        """Struck rows whose strike may be taken back, the latest first."""
        struck = set(self.observation.book.struck)
        return tuple(r for r in reversed(self.observation.book.rows) if r.seq in struck)


def problem_text(error: SurveyError) -> str:
    """The first problem of an error in one line."""
    problem = error.problems[0]
    what, hint = shown(problem.what), shown(problem.hint)
    what = f"{what}: {shown(problem.found)}" if problem.found else what
    if not hint.startswith("surveyapp "):  # a command is written as it is typed
        hint = hint[:1].upper() + hint[1:]
    return texts.NOT_WRITTEN.format(what=what, hint=hint).strip()
