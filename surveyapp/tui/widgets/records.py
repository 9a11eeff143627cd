"""A table of text rows with what is known of the chosen row beside or below it."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from rich.text import Text
from textual.app import ComposeResult
from textual.containers import Container, VerticalScroll
from textual.widgets import DataTable, Static

from surveyapp.languages import shown
from surveyapp.tui.cells import columns, padded

NUMERIC = "+-±.0123456789"


class Records(Container):
    """A table, and the details of the row under the cursor.

    Parameters
    ----------
    columns : sequence of str
    empty : str
        Shown instead of the table where there are no rows.
    details : callable or None
        From the index of a row to its details; without it the table has the whole place.
    """

    def __init__(
        self,
        columns: Sequence[str],
        *,
        empty: str,
        details: Callable[[int], Text] | None = None,
    ) -> None:
        super().__init__()
        self.columns = tuple(columns)
        self.empty = empty
        self.details = details

    def compose(self) -> ComposeResult:
        """Table, details, and the sentence for an empty table."""
        yield DataTable[Text](cursor_type="row", zebra_stripes=True)
        with VerticalScroll(can_focus=self.details is not None):
            yield Static(markup=False)
        yield Static(self.empty, classes="empty", markup=False)

    def on_mount(self) -> None:
        """Nothing is shown before there is something to show."""
        table = self.query_one(DataTable)
        table.add_columns(*(shown(column) for column in self.columns))
        self._show(rows=0)
        self.query_one(".empty").display = False

    def show(self, rows: Sequence[Sequence[str]]) -> None:
        """Replace all rows."""
        table = self.query_one(DataTable)
        table.clear()
        right = [
            all(row[i][:1] in NUMERIC for row in rows if row[i]) for i in range(len(self.columns))
        ]
        for row in rows:
            cells = [
                Text(shown(cell), justify="right" if numeric else "left", no_wrap=True)
                for cell, numeric in zip(row, right, strict=True)
            ]
            table.add_row(*cells)
        self._show(rows=len(rows))

    def _show(self, *, rows: int) -> None:
        self.query_one(DataTable).display = rows > 0
        self.query_one(VerticalScroll).display = rows > 0 and self.details is not None
        self.query_one(".empty").display = rows == 0

    def on_resize(self) -> None:
        """The details take the width that there is."""
        table = self.query_one(DataTable)
        if self.details is not None and table.row_count:
            text = self.details(max(table.cursor_row, 0))
            self.query_one(VerticalScroll).query_one(Static).update(text)

    def on_data_table_row_highlighted(self, event: DataTable.RowHighlighted) -> None:
        """Show the details of the row."""
        if self.details is not None and event.cursor_row >= 0:
            self.query_one(VerticalScroll).query_one(Static).update(self.details(event.cursor_row))


def pairs_text(pairs: Sequence[tuple[str, str]]) -> Text:
    """Labels and values, one a line, values below each other."""
    width = max((columns(label) for label, _ in pairs), default=0)
    text = Text()
    for label, value in pairs:
        text.append(f"{padded(label, width)}  ")
        text.append(f"{value}\n", style="bold")
    return text


def table_text(rows: Sequence[Sequence[str]], *, left: tuple[int, ...] = (0,)) -> Text:
    """A small table: some columns to the left, the others to the right."""
    if not rows:
        return Text()
    widths = [max(columns(row[i]) for row in rows) for i in range(len(rows[0]))]
    text = Text()
    for row in rows:
        cells = [
            padded(cell, width, right=i not in left)
            for i, (cell, width) in enumerate(zip(row, widths, strict=True))
        ]
        text.append(("  ".join(cells)).rstrip() + "\n")
    return text
