"""Where a reading would stand in the swing: behind the others, or in the place of a struck one.

A struck turning point that is typed anew stands where the struck one stood, with its moment: it
was read then and only typed wrongly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from surveyapp.core.book.strikes import find_strikes, live_rows
from surveyapp.domain.readings import FieldBook, Reading, ReadingKind


@dataclass(frozen=True, slots=True)
class Placed:
    """A reading at its place in the swing.

    Parameters
    ----------
    index : int
        Its number among the rows of its kind and the missed ones, from 0.
    before : Reading or None
        Nearest row of its kind above that counts and has a moment.
    after : Reading or None
        Nearest row of its kind below that counts.
    turns : int
        Half swings from ``before`` to it.
    struck : Reading or None
        The struck row whose place it takes.
    """

    index: int
    before: Reading | None = None
    after: Reading | None = None
    turns: int = 1
    struck: Reading | None = None


def place_in_swing(book: FieldBook, row: Reading) -> Placed:
    """Tell where a turning point or passage would stand in the book.

    Parameters
    ----------
    book : FieldBook
    row : Reading
        Not in the book yet; its seq is given here.
    """
    seq = max((item.seq for item in book.rows), default=0) + 1
    rows = (*book.rows, replace(row, seq=seq))
    strikes, _ = find_strikes(rows, "")
    kinds = (row.kind, ReadingKind.MISSED)
    swing = [item for item in live_rows(rows, strikes) if item.kind in kinds]
    index = next(i for i, item in enumerate(swing) if item.seq == seq)
    was = [item for item in book.live if item.kind in kinds]
    struck = None
    if len(was) == len(swing) and was[index].seq in book.struck:
        struck = next(item for item in book.rows if item.seq == was[index].seq)
    before = [i for i in range(index) if swing[i].kind is row.kind and _has_moment(swing[i])]
    after = [i for i in range(index + 1, len(swing)) if swing[i].kind is row.kind]
    return Placed(
        index=index,
        before=swing[before[-1]] if before else None,
        after=swing[after[0]] if after else None,
        turns=index - before[-1] if before else 1,
        struck=struck,
    )


def _has_moment(row: Reading) -> bool:
    return row.elapsed_s is not None or row.time is not None


def open_strike(book: FieldBook, kind: ReadingKind) -> Reading | None:
    """The latest turning point, where it is struck and waits to be typed anew; else None."""
    swing = [row for row in book.live if row.kind in (kind, ReadingKind.MISSED)]
    if not swing or swing[-1].seq not in book.struck:
        return None
    last = max(row.seq for row in book.rows if row.kind in (kind, ReadingKind.MISSED))
    if last != swing[-1].seq:
        return None
    return next(row for row in book.rows if row.seq == last)


def nearest_with_moment(above: Sequence[Reading], row: Reading) -> Reading | None:
    """The nearest row above whose clock another row shares; rows without a moment lie between."""
    return next((item for item in reversed(above) if seconds_between(item, row) is not None), None)


def seconds_between(earlier: Reading, later: Reading) -> float | None:
    """Seconds from one row to another on a clock that both have, None where they share none."""
    if earlier.elapsed_s is not None and later.elapsed_s is not None:
        return later.elapsed_s - earlier.elapsed_s
    if earlier.time is not None and later.time is not None:
        return (later.time - earlier.time).total_seconds()
    return None
