"""Choose a reading to strike, and say why."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import ClassVar

from textual.binding import Binding, BindingType
from textual.widget import Widget
from textual.widgets import OptionList
from textual.widgets.option_list import Option

from surveyapp.domain.readings import Reading
from surveyapp.tui import texts
from surveyapp.tui.cells import padded
from surveyapp.tui.drafts import Draft
from surveyapp.tui.screens.lines import LinesScreen, heading, hint, line


class StrikeScreen(LinesScreen[tuple[int, str]]):
    """Returns the row's seq and the reason, or None; a struck row is chosen to count again."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("up", "move(-1)", show=False, priority=True),
        Binding("down", "move(1)", show=False, priority=True),
    ]

    def __init__(self, rows: Sequence[Reading], struck: Sequence[Reading], draft: Draft) -> None:
        super().__init__(draft)
        self.rows = (*rows, *struck)
        self.back = len(rows)

    def lines(self) -> Iterable[Widget]:
        """Rows, the latest first, and the reason."""
        yield heading(texts.STRIKE_TITLE)
        yield OptionList(
            *[
                Option(_line(row, struck=place >= self.back), id=str(row.seq))
                for place, row in enumerate(self.rows)
            ],
            markup=False,
        )
        yield line("reason", texts.STRIKE_REASON)
        yield hint(texts.STRIKE_KEYS)

    def on_mount(self) -> None:
        """The latest row is chosen."""
        self.query_one(OptionList).highlighted = 0

    def action_move(self, places: int) -> None:
        """Choose another row."""
        options = self.query_one(OptionList)
        here = options.highlighted or 0
        options.highlighted = min(max(here + places, 0), len(self.rows) - 1)

    def answer(self) -> tuple[int, str] | None:
        """The row, if a reason is given."""
        self.wrong = texts.STRIKE_WHY
        chosen, reason = self.query_one(OptionList).highlighted, self.typed()
        return None if chosen is None or not reason else (self.rows[chosen].seq, reason)


def _line(row: Reading, *, struck: bool) -> str:
    kind = texts.KIND_NAMES[row.kind].split(",")[0]
    time = "" if row.time is None else f"{row.time:%H:%M:%S}"
    back = f"  {texts.STRIKE_BACK}" if struck else ""
    return f"{row.seq:>4}  {time:<8}  {padded(kind, 14)}  {row.text}{back}"
