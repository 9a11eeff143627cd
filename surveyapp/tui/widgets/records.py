"""A table of the record as a list, with what is known of the chosen row beside or below it."""

from __future__ import annotations

from collections.abc import Callable

from rich.text import Text
from textual.app import ComposeResult
from textual.containers import Container
from textual.widgets import DataTable, Static

from surveyapp.report.blocks import Block, KeyValues, Table
from surveyapp.report.in_words import in_words
from surveyapp.report.text import display_width
from surveyapp.tui.widgets.blocks_pane import BlocksPane

CELL_SIDES = 2
"""Columns that the cell of a list has beside its text."""
SCROLL_BAR = 1
TABLE_SHARE = 0.62
"""Of the width, at most, for a table with its details beside it (app.tcss)."""


class Records(Container):
    """A table, and the details of the row under the cursor.

    The columns that find no room are left out of the list and told among the details.

    Parameters
    ----------
    empty : str
        Shown instead of the table where there are no rows.
    details : callable or None
        From the index of a row to blocks; None: every cell of the row.
    whole : bool
        Whether there are details; without them the table has the whole place.
    beside : bool
        Whether the details stand beside the table where the screen is wide.
    """

    def __init__(
        self,
        *,
        empty: str,
        details: Callable[[int], tuple[Block, ...]] | None = None,
        whole: bool = True,
        beside: bool = False,
    ) -> None:
        super().__init__(classes="beside" if beside else "")
        self.empty = empty
        self.details = details
        self.whole = whole
        self.table = Table((), ())
        self.listed = 0
        """Columns in the list, from the left."""

    def compose(self) -> ComposeResult:
        """Table, details, and the sentence for an empty table."""
        yield DataTable[Text](cursor_type="row", zebra_stripes=True)
        yield BlocksPane(can_focus=self.whole)
        yield Static(self.empty, classes="empty", markup=False)

    def on_mount(self) -> None:
        """Nothing is shown before there is something to show."""
        self._show_parts()
        self.query_one(".empty").display = False

    def show(self, table: Table) -> None:
        """Replace all rows; the cursor stays in its row."""
        self.table = in_words(table)
        self._fill(columns_in(self.table, self._room()))

    def on_resize(self) -> None:
        """As many columns as there is room for."""
        listed = columns_in(self.table, self._room())
        if listed != self.listed:
            self._fill(listed)

    def on_data_table_row_highlighted(self, event: DataTable.RowHighlighted) -> None:
        """Show the details of the row."""
        self._tell(event.cursor_row)

    def _room(self) -> int:
        """Columns for the table; 0 where it does not show yet."""
        width = self.size.width
        beside = self.styles.layout is not None and self.styles.layout.name == "horizontal"
        return int(width * TABLE_SHARE) if beside else width

    def _fill(self, listed: int) -> None:
        table, places = self.query_one(DataTable), range(listed)
        row = table.cursor_row
        table.clear(columns=True)
        align = self.table.align or "l" * len(self.table.head)
        right = [align[i] == "r" for i in places]
        for i in places:
            # a width found when idle leaves rows that were painted before it as narrow as the head
            width = _width(self.table, i)
            table.add_column(_cell(self.table.head[i], right=right[i]), width=width)
        for number, cells in enumerate(self.table.rows):
            strong = number in self.table.strong
            table.add_row(*(_cell(cells[i], right=right[i], strong=strong) for i in places))
        self.listed = listed
        self._show_parts()
        if self.table.rows:
            table.move_cursor(row=min(max(row, 0), len(self.table.rows) - 1))

    def _show_parts(self) -> None:
        rows = len(self.table.rows)
        self.query_one(DataTable).display = rows > 0
        self.query_one(BlocksPane).display = rows > 0 and self.whole
        self.query_one(".empty").display = rows == 0

    def _tell(self, row: int) -> None:
        """The details of a row, what found no room in the list before them."""
        if not self.whole or not 0 <= row < len(self.table.rows):
            return
        first = 0 if self.details is None else self.listed
        cells = zip(self.table.head[first:], self.table.rows[row][first:], strict=True)
        pairs = tuple((head, cell) for head, cell in cells if cell)
        blocks: tuple[Block, ...] = (KeyValues(pairs),) if pairs else ()
        if self.details is not None:
            blocks += self.details(row)
        self.query_one(BlocksPane).show(blocks)


def columns_in(table: Table, room: int) -> int:
    """How many columns of a table a list of a width shows, from the left; 0 has no width yet."""
    if room <= 0:
        return len(table.head)
    left = room - SCROLL_BAR
    for place in range(len(table.head)):
        left -= _width(table, place) + CELL_SIDES
        if left < 0:
            return max(place, 1)
    return len(table.head)


def _width(table: Table, place: int) -> int:
    """Of a column, its head and every cell."""
    cells = (display_width(row[place]) for row in table.rows)
    return max(display_width(table.head[place]), *cells, 0)


def _cell(text: str, *, right: bool, strong: bool = False) -> Text:
    justify, style = "right" if right else "left", "bold" if strong else ""
    return Text(text, justify=justify, style=style, no_wrap=True)  # type: ignore[arg-type]
