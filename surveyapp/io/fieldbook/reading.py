"""Reading a field book: what was written down, what of it counts, and on which side it was.

A book is only ever appended to. Reading it never changes a complete row; a last line without its
newline (a crash in the middle of writing) is moved aside to ``<book>.csv.torn`` and reported.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

from surveyapp.core.book.resolution import infer_resolution
from surveyapp.core.book.sides import sides_of_swing
from surveyapp.core.book.strikes import find_strikes, live_rows
from surveyapp.domain.readings import SWING_KINDS, FieldBook, Place, Reading, ReadingKind
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.fieldbook.rows import RawBook, parse_rows
from surveyapp.io.files import decode, read_bytes, shown
from surveyapp.io.guarded import open_regular
from surveyapp.languages import said
from surveyapp_models.angles import AngleUnit

_MOST_PROBLEMS: Final = 100
_LONGEST_TAIL: Final = 4096
"""A torn line is no longer than this [bytes]; no reading and no header is."""


def parse_field_book(text: str, *, angle_unit: AngleUnit, where: str) -> FieldBook:
    """Read a book from its text.

    Parameters
    ----------
    text : str
        The whole book. What follows the last newline does not count and is returned as
        ``torn_tail``.
    angle_unit : AngleUnit
        Unit of angles whose row names none.
    where : str
        What messages call the book.

    Returns
    -------
    FieldBook
        An empty text gives a book without rows.

    Raises
    ------
    SurveyError
        With every problem of the book together.
    """
    whole, newline, tail = text.rpartition("\n")
    book, _ = interpret(whole + newline, angle_unit=angle_unit, where=where)
    return replace(book, torn_tail=tail or None)


@dataclass(frozen=True, slots=True)
class Judged:
    """A book with everything that is wrong with it.

    Parameters
    ----------
    book : FieldBook
        Without inferred sides where there are problems.
    problems : tuple of Problem
    odd_columns : tuple of str
        Columns that are not known.
    """

    book: FieldBook
    problems: tuple[Problem, ...]
    odd_columns: tuple[str, ...]


def judge(text: str, *, angle_unit: AngleUnit, where: str) -> Judged:
    """Read complete lines and collect every problem."""
    raw = parse_rows(text.removeprefix("\ufeff"), angle_unit=angle_unit, where=where)
    strikes, problems = find_strikes(raw.rows, where)
    void = {raw.rows[s.row].seq for s in strikes}
    problems = [p for seq, p in raw.problems if seq is None or seq not in void] + problems
    problems += _elapsed_problems(raw, void, where)
    book = FieldBook(tuple(raw.rows), live_rows(raw.rows, strikes), tuple(sorted(void)))
    if not problems:
        book, problems = _with_sides(book, where)
    return Judged(book, _at_most(problems, where), raw.odd_columns)


def _at_most(problems: Sequence[Problem], where: str) -> tuple[Problem, ...]:
    """The first problems of a book; of a file of another kind every line would be one."""
    if len(problems) <= _MOST_PROBLEMS:
        return tuple(problems)
    further = Problem(said("{more} further problems", more=len(problems) - _MOST_PROBLEMS), where)
    return (*problems[:_MOST_PROBLEMS], further)


def interpret(text: str, *, angle_unit: AngleUnit, where: str) -> tuple[FieldBook, tuple[str, ...]]:
    """Read complete lines; the second result names columns that are not known."""
    judged = judge(text, angle_unit=angle_unit, where=where)
    if judged.problems:
        raise SurveyError(judged.problems)
    return judged.book, judged.odd_columns


def _elapsed_problems(raw: RawBook, void: set[int], where: str) -> list[Problem]:
    problems = []
    latest: Reading | None = None
    for row in raw.rows:
        if row.elapsed_s is None or row.seq in void:
            continue
        if latest is not None and latest.elapsed_s is not None and row.elapsed_s < latest.elapsed_s:
            problems.append(
                Problem(
                    "elapsed_s goes back",
                    said(
                        "{where}, line {line} (seq {seq})", where=where, line=row.line, seq=row.seq
                    ),
                    said(
                        "{elapsed_s:g} after {elapsed_s2:g}",
                        elapsed_s=row.elapsed_s,
                        elapsed_s2=latest.elapsed_s,
                    ),
                    "seconds that do not decrease",
                    "a wrong row is struck and entered anew",
                )
            )
        latest = row
    return problems


def _with_sides(book: FieldBook, where: str) -> tuple[FieldBook, list[Problem]]:
    """Fill in the sides of the live turning points, each swing by itself."""
    live = list(book.live)
    problems: list[Problem] = []
    for group in _swings(book):
        points = [live[index] for index in group]
        sides, found = sides_of_swing(points, where=where, tolerance=_rest_tolerance(points))
        problems += found
        for index, side in zip(group, sides, strict=True):
            live[index] = replace(live[index], side=side)
    return replace(book, live=tuple(live)), problems


def _swings(book: FieldBook) -> list[list[int]]:
    """Indices into ``live`` of each swing: turning points, tape zeros before, tape zeros after.

    A missed point belongs to the swing of the turning point above it, else of the one below.
    """
    live = book.live
    places = _places(live)
    groups: dict[tuple[ReadingKind, Place], list[int]] = {}
    leading: list[int] = []
    current: list[int] | None = None
    for index, row in enumerate(live):
        if row.kind in (ReadingKind.REVERSAL, ReadingKind.SCALE_REVERSAL):
            current = groups.setdefault((row.kind, Place.DURING), [])
        elif row.kind is ReadingKind.TAPE_ZERO:
            current = groups.setdefault((row.kind, places[index]), [])
        elif row.kind is not ReadingKind.MISSED:
            continue
        elif current is None:
            leading.append(index)
            continue
        if current is not None:
            current.extend([*leading, index])
            leading = []
    return list(groups.values())


def _places(live: Sequence[Reading]) -> list[Place]:
    """Place of every row; as ``FieldBook.place_of``, for all at once."""
    kinds = SWING_KINDS - {ReadingKind.MISSED}
    swing = [i for i, row in enumerate(live) if row.kind in kinds]
    if not swing:
        return [Place.BEFORE] * len(live)
    first, last = swing[0], swing[-1]
    return [
        Place.BEFORE if i < first else Place.AFTER if i > last else Place.DURING
        for i in range(len(live))
    ]


def _rest_tolerance(points: Sequence[Reading]) -> float:
    """Width [div] up to which the unspun tape is at rest and has no sides: two reading steps."""
    if not any(p.kind is ReadingKind.TAPE_ZERO for p in points):
        return 0.0
    return 2.0 * infer_resolution([p.value for p in points if p.value is not None], "div")


def split_tail(data: bytes, *, where: str) -> tuple[str, bytes]:
    """Complete lines of a book, and what follows its last newline.

    Raises
    ------
    SurveyError
        If the complete lines are no text, or if what follows is no torn line of a book but a file
        of another kind: that is never moved aside.
    """
    whole, newline, tail = data.rpartition(b"\n")
    text = decode(whole + newline, where=where)
    if not text.strip("\ufeff\r\n") and tail:
        tail_text = decode(tail, where=where)
        if "\r" in tail_text[:-1] or len(tail) > _LONGEST_TAIL:
            raise SurveyError(_no_lines(where, tail_text))
    elif len(tail) > _LONGEST_TAIL:
        raise SurveyError(_no_lines(where, tail[:80].decode("utf-8", errors="replace")))
    return text, tail


def _no_lines(where: str, found: str) -> Problem:
    return Problem(
        "the text has no line ends",
        where,
        shown(found),
        "one line for each reading",
        "save the file with the line ends LF or CR LF",
    )


def read_field_book(path: Path, *, angle_unit: AngleUnit, repair: bool = True) -> FieldBook:
    """Read a book from its file.

    Parameters
    ----------
    path : Path
    angle_unit : AngleUnit
        Unit of angles whose row names none.
    repair : bool
        Move a last line without newline to ``<book>.csv.torn``; where that is impossible (a
        read-only folder) or not wanted it is left out in memory only.

    Returns
    -------
    FieldBook
        ``torn_tail`` holds what was left out.

    Raises
    ------
    SurveyError
        With every problem of the book together.
    """
    where = path.name
    data = read_bytes(path, where=where)
    text, tail = split_tail(data, where=where)
    book, _ = interpret(text, angle_unit=angle_unit, where=where)
    if not tail:
        return book
    if repair:
        move_tail_aside(path, size=len(data), tail=tail)
    return replace(book, torn_tail=tail.decode("utf-8", errors="replace"))


def move_tail_aside(path: Path, *, size: int, tail: bytes) -> bool:
    """Append a torn tail to ``<book>.torn`` and cut it off the book, in this order.

    A crash between the two leaves the tail in both files: nothing is lost. A book that has
    changed since it was read (``size`` [bytes]) is left alone.

    Returns
    -------
    bool
        Whether the tail was moved; False in a read-only folder.
    """
    append = os.O_WRONLY | os.O_APPEND | os.O_CREAT
    beside = path.with_name(path.name + ".torn")
    try:
        with os.fdopen(open_regular(path, os.O_RDWR), "r+b") as book:
            if os.fstat(book.fileno()).st_size != size:
                return False
            with os.fdopen(open_regular(beside, append), "ab") as aside:
                aside.write(tail + b"\n")
                aside.flush()
                os.fsync(aside.fileno())
            book.truncate(size - len(tail))
            book.flush()
            os.fsync(book.fileno())
    except OSError:
        return False
    return True
