"""Writing a reading down: one line at the end of the book, on the disk before it is reported.

Nothing that stands in a book is ever written again. The caller holds the project's lock.
"""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from surveyapp.domain.readings import COLUMNS, FieldBook
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.io.fieldbook.reading import judge, move_tail_aside, split_tail
from surveyapp.io.files import has_control, read_bytes, shown, shown_path
from surveyapp.io.guarded import open_regular
from surveyapp.io.tomltext import sync_folder
from surveyapp.languages import said
from surveyapp_models.angles import AngleUnit

Judge = Callable[[FieldBook, str], Sequence[Problem]]
"""Further problems of a book, which is called as told."""


def append_row(
    path: Path,
    row: Mapping[str, str],
    *,
    angle_unit: AngleUnit = AngleUnit.DMS,
    also: Judge | None = None,
) -> int:
    """Append one row to a book and return its seq when it is on the disk.

    Parameters
    ----------
    path : Path
        The book; it is begun, header first, where it does not exist or is empty.
    row : mapping of column to text
        Without seq, which is given here. A new book has the columns of the format; an existing
        one keeps its own, and a value for a column that it lacks is refused.
    angle_unit : AngleUnit
        The project's unit of angles.
    also : callable or None
        A further judgement: a problem that it finds with the row and not without it, by what is
        wrong and where, refuses the row.

    Returns
    -------
    int
        seq of the new row.

    Raises
    ------
    SurveyError
        If the row brings a problem into the book that was not there before, or if it cannot be
        written in whole; the earlier rows stand as they were in either case.
    """
    where = path.name
    data = read_bytes(path, where=where) if path.exists() else b""
    text, tail = split_tail(data, where=where)
    if tail and not move_tail_aside(path, size=len(data), tail=tail):
        raise SurveyError(
            Problem(
                said("the torn last line of the book cannot be moved aside"),
                where,
                shown_path(path),
            )
        )
    before = judge(text, angle_unit=angle_unit, where=where)
    header = _header(text, where)
    end = "\r\n" if text.partition("\n")[0].endswith("\r") else "\n"
    seq = max((r.seq for r in before.book.rows), default=0) + 1
    line = _line(header or COLUMNS, {**row, "seq": str(seq)}, where) + end
    if header is None:
        line = ",".join(COLUMNS) + end + line
    after = judge(text + line, angle_unit=angle_unit, where=where)
    fresh = [problem for problem in after.problems if problem not in before.problems]
    if also is not None and not after.problems:
        known = {(problem.what, problem.where) for problem in also(before.book, where)}
        fresh += [p for p in also(after.book, where) if (p.what, p.where) not in known]
    if fresh:
        raise SurveyError(fresh)
    append_line(path, line.encode("utf-8"))
    return seq


def book_columns(path: Path) -> tuple[str, ...]:
    """Columns that a row of this book may have: its own, or those of the format for a new one."""
    if not path.exists():
        return COLUMNS
    text, _ = split_tail(read_bytes(path, where=path.name), where=path.name)
    return _header(text, path.name) or COLUMNS


def _header(text: str, where: str) -> tuple[str, ...] | None:
    """Columns of an existing book in their order, None for a new one."""
    for line in text.removeprefix("\ufeff").split("\n"):
        if line.strip():
            try:
                cells = next(csv.reader([line.rstrip("\r")], strict=True))
            except csv.Error as error:
                raise SurveyError(
                    Problem(said("the header is no CSV ({error})", error=error), where)
                ) from None
            return tuple(cell.strip().lower() for cell in cells)
    return None


def _line(header: Sequence[str], row: Mapping[str, str], where: str) -> str:
    problems = []
    for column, value in row.items():
        if value and column not in header:
            problems.append(
                Problem(
                    said("the book has no column {column}", column=shown(column)),
                    where,
                    shown(value),
                    ",".join(header),
                    nearest_names(column, header),
                )
            )
        if has_control(value) or "\n" in value or "\r" in value:
            problems.append(
                Problem(
                    said("{column} is not one line of text", column=shown(column)),
                    where,
                    shown(value),
                )
            )
    if problems:
        raise SurveyError(problems)
    buffer = io.StringIO()
    csv.writer(buffer, lineterminator="").writerow([row.get(column, "") for column in header])
    return buffer.getvalue()


def append_line(path: Path, line: bytes) -> None:
    """One write at the end, then fsync; what could not be written in whole is cut off again.

    Raises
    ------
    SurveyError
        If the system refuses; the earlier lines stand.
    """
    new = not path.exists()
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        book = open_regular(path, os.O_WRONLY | os.O_APPEND | os.O_CREAT)
    except OSError as error:
        raise _not_written(path, error) from None
    try:
        size = os.fstat(book).st_size
        try:
            written = os.write(book, line)
            if written != len(line):
                raise OSError(said("{written} of {line} bytes", written=written, line=len(line)))
            os.fsync(book)
        except OSError as error:
            os.ftruncate(book, size)
            raise _not_written(path, error) from None
    except OSError as error:
        raise _not_written(path, error) from None
    finally:
        os.close(book)
    if new:
        sync_folder(path.parent)


def _not_written(path: Path, error: OSError) -> SurveyError:
    return SurveyError(
        Problem(
            said("the reading could not be written ({strerror})", strerror=error.strerror or error),
            path.name,
            shown_path(path),
            said("a disk with room that may be written to"),
            said("the earlier rows stand; note the reading on paper and make room"),
        )
    )
