"""What the session screen knows beyond the book: what was chosen by key, and what is half typed.

It turns texts into calls of the API and answers of the API into texts. It draws nothing and
computes nothing.
"""

from __future__ import annotations

from dataclasses import replace

from surveyapp.core.observing.doubts import Question
from surveyapp.core.observing.progress import Progress
from surveyapp.core.observing.steps import BEFORE, Expected, Step, kinds_of, steps_of
from surveyapp.core.observing.typed_rows import EntryError
from surveyapp.domain.readings import QUANTITY, Dimension, Face, Reading, ReadingKind
from surveyapp.errors import SurveyError
from surveyapp.io.fieldbook.clock import NOTICED_S, Stamp
from surveyapp.observation.entry import (
    Understood,
    expected,
    next_kind,
    next_target,
    understand,
)
from surveyapp.observation.session import NewRow, SessionDesk
from surveyapp.tui import texts
from surveyapp.tui.views.form import number_text, small_text
from surveyapp_models.angles import AngleUnit, format_angle


class NotWrittenError(Exception):
    """A reading that was not written; the text says why and what to do."""


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
        self.stamp: Stamp | None = None
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
        if not text:
            self.stamp = None
            self.asked = None
            return ""
        if self.stamp is None:
            self.stamp = self.observation.clock.stamp()
        if text != self.asked:
            self.asked = None
        try:
            found = self._understand(text)
        except EntryError:
            return ""
        value = self.value_text(found)
        pattern = texts.UNDERSTOOD_COMPLETED if found.completed else texts.UNDERSTOOD
        return pattern.format(value=value)

    def _understand(self, text: str) -> Understood:
        stamp = self.stamp or self.observation.clock.stamp()
        return understand(self.observation, text, self.what(), progress=self.progress, stamp=stamp)

    def value_text(self, found: Understood) -> str:
        """A reading as understood."""
        if QUANTITY[found.row.kind] is Dimension.ANGLE:
            shown = format_angle(found.value, self.unit)
            moment = f"{found.stamp.time:%H:%M:%S}"
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
        if self.closed():
            raise NotWrittenError(texts.CLOSED_BEFORE)
        try:
            found = self._understand(text)
        except EntryError as error:
            pattern = texts.REFUSED_EXPECTED if error.expected else texts.REFUSED
            raise NotWrittenError(pattern.format(what=error, expected=error.expected)) from None
        if found.questions and self.asked != text:
            self.asked = text
            question = " ".join(question_text(item) for item in found.questions)
            raise NotWrittenError(texts.ASK_AGAIN.format(question=question))
        seq = self.write(found.row, found.stamp)
        kind = texts.KIND_NAMES[found.row.kind].split(",")[0]
        value = found.row.value or found.row.note
        told = texts.RECORDED.format(seq=seq, kind=kind, value=value)
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

    def write(self, row: NewRow, stamp: Stamp | None = None) -> int:
        """Write one row; what was chosen for it is done with."""
        try:
            seq = self.observation.record(row, stamp)
        except SurveyError as error:
            raise NotWrittenError(problem_text(error)) from None
        self.face = self.target = self.stamp = self.asked = None
        if self.kind is not ReadingKind.TRANSIT:
            self.kind = None
        return seq

    def passage(self) -> str:
        """A timed passage of the scale's zero: stamped now, written at once."""
        seq = self.write(NewRow(ReadingKind.TRANSIT, value="0", unit="div"))
        kind = texts.KIND_NAMES[ReadingKind.TRANSIT]
        return texts.RECORDED.format(seq=seq, kind=kind, value="0")

    def missed(self) -> str:
        """Note a turning point that was not read."""
        return texts.MISSED_NOTED.format(seq=self.write(NewRow(ReadingKind.MISSED)))

    def strike(self, seq: int, reason: str) -> str:
        """Strike a row with a reason."""
        try:
            self.observation.strike(seq, reason)
        except SurveyError as error:
            raise NotWrittenError(problem_text(error)) from None
        return texts.STRUCK.format(seq=seq, reason=reason)

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
        quiet = (ReadingKind.STRIKE, ReadingKind.NOTE)
        rows = self.observation.book.rows
        return tuple(r for r in reversed(rows) if r.kind not in quiet and r.seq not in struck)


def question_text(item: Question) -> str:
    """A doubt in words."""
    if item.scale:
        return texts.QUESTIONS[item.doubt].format(
            difference=texts.DIVISIONS.format(value=number_text(item.difference, 2, sign=True)),
            limit=texts.DIVISIONS.format(value=number_text(item.limit, 2)),
        )
    return texts.QUESTIONS[item.doubt].format(
        difference=small_text(item.difference), limit=small_text(item.limit).lstrip("+")
    )


def problem_text(error: SurveyError) -> str:
    """The first problem of an error in one line."""
    problem = error.problems[0]
    what = f"{problem.what}: {problem.found}" if problem.found else problem.what
    hint = problem.hint
    if not hint.startswith("surveyapp "):  # a command is written as it is typed
        hint = hint[:1].upper() + hint[1:]
    return texts.NOT_WRITTEN.format(what=what, hint=hint).strip()
