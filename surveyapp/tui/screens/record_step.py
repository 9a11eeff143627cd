"""Record that a step of the procedure is done: who, with which file, readings of a check.

Returns the entry, or None; nothing typed is lost when it is left.
"""

from __future__ import annotations

from collections.abc import Iterable

from textual.widget import Widget

from surveyapp.domain.penetration import STEP_TITLES, ProcedureStep
from surveyapp.languages import translated
from surveyapp.tui import texts
from surveyapp.tui.drafts import Draft
from surveyapp.tui.screens.lines import LinesScreen, heading, hint
from surveyapp.tui.views.penetration import CHECKS_STEP, typed_reading
from surveyapp.tui.widgets.field import TextField, typed


class RecordStepScreen(LinesScreen[ProcedureStep]):
    """One entry of one step."""

    DEFAULT_CSS = """
    RecordStepScreen .label { width: 18; }
    RecordStepScreen Input { width: 1fr; }
    """

    def __init__(self, step: int, draft: Draft) -> None:
        super().__init__(draft)
        self.step = step

    def lines(self) -> Iterable[Widget]:
        """The fields of an entry."""
        yield heading(f"{self.step} {translated(STEP_TITLES[self.step - 1])}")
        yield TextField(texts.R_BY, "by")
        yield TextField(texts.R_FILE, "file", hint=texts.R_FILE_HINT)
        yield TextField(texts.R_NOTE, "note")
        if self.step == CHECKS_STEP:
            yield TextField(texts.R_CENTRE, "centre", hint=texts.R_CENTRE_HINT)
            yield TextField(texts.R_WAIST, "waist", hint=texts.R_WAIST_HINT)
        yield hint(texts.R_KEYS)

    def answer(self) -> ProcedureStep | None:
        """The entry, if everything can be understood."""
        readings: list[float | None] = [None, None]
        if self.step == CHECKS_STEP:
            try:
                readings = [typed_reading(typed(self, name)) for name in ("centre", "waist")]
            except ValueError:
                self.wrong = texts.R_NO_NUMBER
                return None
        by = typed(self, "by")
        if not by:
            self.wrong = texts.R_NOBODY
            return None
        file, note = typed(self, "file"), typed(self, "note")
        return ProcedureStep(self.step, "", by, note, file, readings[0], readings[1])
