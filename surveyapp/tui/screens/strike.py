"""Choose a reading to strike, and say why."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Vertical
from textual.screen import ModalScreen
from textual.widgets import Input, OptionList, Static
from textual.widgets.option_list import Option

from surveyapp.domain.readings import Reading
from surveyapp.tui import texts
from surveyapp.tui.cells import padded
from surveyapp.tui.drafts import Draft, keep, put_back


class StrikeScreen(ModalScreen[tuple[int, str] | None]):
    """Returns the row's seq and the reason, or None; a struck row is chosen to count again."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("escape", "leave", texts.KEY_LEAVE),
        Binding("up", "move(-1)", show=False, priority=True),
        Binding("down", "move(1)", show=False, priority=True),
    ]

    def __init__(self, rows: Sequence[Reading], struck: Sequence[Reading], draft: Draft) -> None:
        super().__init__()
        self.draft = draft
        self.rows = (*rows, *struck)
        self.back = len(rows)

    def compose(self) -> ComposeResult:
        """Rows, the latest first, and the reason."""
        with Vertical(id="dialog"):
            yield Static(texts.STRIKE_TITLE, classes="heading", markup=False)
            yield OptionList(
                *[
                    Option(_line(row, struck=place >= self.back), id=str(row.seq))
                    for place, row in enumerate(self.rows)
                ]
            )
            reason = Input(
                placeholder=texts.STRIKE_REASON, id="reason", compact=True, select_on_focus=False
            )
            reason.cursor_blink = False
            yield reason
            yield Static(texts.STRIKE_KEYS, classes="hint", markup=False)

    def on_mount(self) -> None:
        """The latest row is chosen, the reason is typed at once."""
        self.query_one(OptionList).highlighted = 0
        put_back(self, self.draft)
        self.query_one(Input).focus()

    def action_move(self, places: int) -> None:
        """Choose another row."""
        options = self.query_one(OptionList)
        here = options.highlighted or 0
        options.highlighted = min(max(here + places, 0), len(self.rows) - 1)

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Strike."""
        chosen = self.query_one(OptionList).highlighted
        reason = event.value.strip()
        if chosen is not None and reason:
            self.draft.clear()
            self.dismiss((self.rows[chosen].seq, reason))

    def action_leave(self) -> None:
        """Strike nothing."""
        keep(self, self.draft)
        self.dismiss(None)


def _line(row: Reading, *, struck: bool) -> str:
    kind = texts.KIND_NAMES[row.kind].split(",")[0]
    time = "" if row.time is None else f"{row.time:%H:%M:%S}"
    back = f"  {texts.STRIKE_BACK}" if struck else ""
    return f"{row.seq:>4}  {time:<8}  {padded(kind, 14)}  {row.text}{back}"
