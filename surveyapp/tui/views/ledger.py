"""Rows of the field book as rows of text, struck ones visible."""

from __future__ import annotations

from surveyapp.core.observing.progress import Progress
from surveyapp.domain.readings import QUIET_KINDS, FieldBook, Reading, ReadingKind
from surveyapp.tui import texts
from surveyapp.tui.views.progress import residual_text

QUIET = tuple(QUIET_KINDS)


def ledger_rows(
    book: FieldBook, progress: Progress | None, rows: tuple[Reading, ...]
) -> list[tuple[str, ...]]:
    """Cells of the given rows: number, time, kind, reading, state, residual or why it is struck."""
    residuals: dict[int, str] = {}
    if progress is not None:
        residuals = {
            point.seq: residual_text(progress, point.residual)
            for point in progress.points
            if point.residual is not None
        }
    sides = {row.seq: row.side for row in book.live}
    struck = set(book.struck)
    reasons = strike_reasons(book)
    return [
        (
            str(row.seq),
            "" if row.time is None else f"{row.time:%H:%M:%S}",
            _kind(row),
            _reading(row),
            texts.LEDGER_STRUCK if row.seq in struck else _place(row, sides.get(row.seq)),
            (reasons if row.seq in struck else residuals).get(row.seq, ""),
        )
        for row in rows
    ]


def strike_reasons(book: FieldBook) -> dict[int, str]:
    """Why each struck row was struck, as far as its strike says so."""
    strikes = (row for row in book.rows if row.kind is ReadingKind.STRIKE)
    return {int(row.text): row.note for row in strikes if row.text.isdecimal()}


def _kind(row: Reading) -> str:
    return texts.KIND_NAMES[row.kind].split(",")[0]


def _reading(row: Reading) -> str:
    """The reading as it was typed, with its unit where the kind has several."""
    if row.kind is ReadingKind.SUPPLY:
        return f"{row.text} {row.unit}"
    return row.text or row.note


def _place(row: Reading, side: str | None) -> str:
    if row.face is not None:
        return f"{row.target} {row.face}".strip()
    return "" if side is None else str(side)


def book_rows(book: FieldBook, kinds: tuple[ReadingKind, ...]) -> tuple[Reading, ...]:
    """Every row of some kinds, struck ones included, in the order of the book."""
    return tuple(row for row in book.rows if row.kind in kinds)
