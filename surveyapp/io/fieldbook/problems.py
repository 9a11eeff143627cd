"""Why a reading cannot be written down now, in words."""

from __future__ import annotations

from pathlib import Path

from surveyapp.core.observing.retyped import nearest_with_moment, seconds_between
from surveyapp.domain.readings import FieldBook, Reading, ReadingKind
from surveyapp.errors import Problem
from surveyapp.languages import said


def edited_problem(path: Path) -> Problem:
    """Another hand wrote in the book while it was open here."""
    return Problem(
        "the book was changed by another hand meanwhile",
        path.name,
        "",
        "the book as it was left here",
        "It is read again and shown: look, then press the key once more.",
    )


def read_only_problem(folder: Path, *, closed: bool) -> Problem:
    """Nothing may be written: the session is closed, or the folder cannot be written to now."""
    if closed:
        return Problem(
            "this session is closed and signed",
            folder.name,
            "a closing in the ledger",
            "an open session",
            "surveyapp reopen opens it again and keeps the reason.",
        )
    return Problem(
        "this project cannot be written to now",
        folder.name,
        "it is open in another program, or the folder is read-only",
        "the only program that has the project open",
        "Close the other one and open the session again; it is shown for reading until then.",
    )


def moment_problems(book: FieldBook, where: str) -> list[Problem]:
    """Turning points and passages whose moment does not lie behind that of the one before.

    No reduction can use such a book; whoever writes one row asks this before it is written.
    """
    found = []
    for kind in (ReadingKind.REVERSAL, ReadingKind.SCALE_REVERSAL, ReadingKind.TRANSIT):
        rows = book.of_kind(kind)
        for place, row in enumerate(rows):
            earlier = nearest_with_moment(rows[:place], row)
            if earlier is not None and (seconds_between(earlier, row) or 0.0) <= 0.0:
                found.append(_moment_problem(where, earlier, row))
    return found


def _moment_problem(where: str, earlier: Reading, row: Reading) -> Problem:
    name = str(row.kind).replace("_", " ")
    clocks = [
        f"{item.time:%H:%M:%S}" if item.time is not None else f"{item.elapsed_s:g} s"
        for item in (row, earlier)
    ]
    return Problem(
        said("its moment does not lie behind the {name} of row {seq}", name=name, seq=earlier.seq),
        where,
        " against ".join(clocks),
        "moments in the order of the swing",
        "State its moment behind @ (@08:15:30), or strike that row first.",
    )
