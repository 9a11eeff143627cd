"""The rows of a log, read by blocks: never more than one block of text in memory.

A block is parsed by numpy where every cell is a number; where one is not, it is read line by line,
so that each wrong cell is named. Columns of a large log live in a file without a name that the
system pages in and out.
"""

from __future__ import annotations

import csv
import hashlib
import re
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

import numpy as np

from surveyapp.domain.advance import PartDone
from surveyapp.domain.columns import let_go, pieces
from surveyapp.domain.sensor_log import Array
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.files import shown, shown_path
from surveyapp.io.sensor_logs.layout import Layout
from surveyapp.languages import said

BLOCK_BYTES: Final = 2 * 1024 * 1024
LONGEST_LINE: Final = 32 * 1024 * 1024
MAPPED_VALUES: Final = 4_000_000
"""Above this number of values the columns are mapped to disk (32 MB)."""

_CLOCK: Final = re.compile(r"^\d{1,4}[-/.]\d{1,2}[-/.]\d{1,4}|^\d{1,2}:\d\d(:|$)")
"""A date or a time of day."""

MAX_TOLD: Final = 20
"""Wrong cells that are named one by one; the rest is counted."""


@dataclass(slots=True)
class Wrong:
    """Cells that could not be read, in the order of the file."""

    where: str
    problems: list[Problem] = field(default_factory=list)
    count: int = 0

    def add(self, line: int, what: str, found: str, *, expected: str, hint: str = "") -> None:
        """Note one."""
        self.count += 1
        if self.count <= MAX_TOLD:
            place = said("{where}, line {line}", where=self.where, line=line)
            self.problems.append(Problem(what, place, shown(found), expected, hint))

    def all(self) -> list[Problem]:
        """The problems, with a last one that counts those not named."""
        more = self.count - len(self.problems)
        if not more:
            return list(self.problems)
        return [
            *self.problems,
            Problem(said("{more} further cells are wrong", more=more), self.where),
        ]


@dataclass(slots=True)
class Rows:
    """What was read.

    Parameters
    ----------
    numbers : ndarray, shape (k, n)
        One row per wanted column of numbers.
    texts : list of list of str
    lines : first line of data, for messages
    """

    numbers: Array
    texts: list[list[str]]
    first_row: int


def text_blocks(path: Path, *, where: str, digest: bool = True) -> Iterator[tuple[bytes, object]]:
    """Whole lines of a file, block by block, with the running sha256."""
    total = hashlib.sha256() if digest else None
    rest = b""
    try:
        with path.open("rb") as stream:
            while data := stream.read(BLOCK_BYTES):
                if total is not None:
                    total.update(data)
                if b"\x00" in data:
                    raise SurveyError(
                        Problem("this is a binary file", where, "a NUL byte", "a log as CSV text")
                    )
                cut = data.rfind(b"\n") + 1
                if cut == 0:
                    rest += data
                    if len(rest) > LONGEST_LINE:
                        raise SurveyError(Problem("the file has no lines", where))
                    continue
                yield rest + data[:cut], total
                rest = data[cut:]
    except OSError as error:
        reason = error.strerror or str(error)
        what = said("the file cannot be read ({reason})", reason=reason)
        raise SurveyError(Problem(what, where, shown_path(path))) from None
    yield rest, total


def count_lines(path: Path, *, where: str) -> tuple[int, str]:
    """Number of lines that hold anything at most, and the sha256 of the file."""
    lines = 0
    total: object = None
    for block, running in text_blocks(path, where=where):
        lines += block.count(b"\n") + (1 if block and not block.endswith(b"\n") else 0)
        total = running
    return lines, total.hexdigest() if total is not None else ""  # type: ignore[attr-defined]


def read_rows(
    path: Path,
    layout: Layout,
    wanted: tuple[Sequence[int], Sequence[int]],
    *,
    lines: int,
    wrong: Wrong,
    progress: PartDone | None = None,
) -> Rows:
    """Read the wanted columns of a file.

    Parameters
    ----------
    path : Path
    layout : Layout
    wanted : two sequences of int
        Places of the columns of numbers and of those of words.
    lines : int
        Lines of the file, at most as many rows.
    wrong : Wrong
        Takes what cannot be read.
    progress : callable, optional

    Returns
    -------
    Rows
    """
    numbers, texts = list(wanted[0]), list(wanted[1])
    room = max(lines - layout.first_row + 1, 0)
    store = make_room(len(numbers), room)
    words: list[list[str]] = [[] for _ in texts]
    filled, line = 0, 1
    size = max(path.stat().st_size, 1)
    done = 0
    for block, _ in text_blocks(path, where=wrong.where, digest=False):
        done += len(block)
        text = _decoded(block, line, wrong.where)
        rows = text.split("\n")
        if rows and not rows[-1]:
            rows.pop()
        first = line
        line += len(rows)
        skip = max(layout.first_row - first, 0)
        rows = rows[skip:]
        if not rows:
            continue
        values, found = _parse(rows, layout, (numbers, texts), (first + skip, wrong))
        store[:, filled : filled + values.shape[1]] = values
        filled += values.shape[1]
        let_go(store)
        for column, more in zip(words, found, strict=True):
            column.extend(more)
        if progress is not None:
            progress(min(done / size, 1.0))
    return Rows(store[:, :filled], words, layout.first_row)


def make_room(columns: int, rows: int) -> Array:
    """Room for so many columns, shape (columns, rows): in memory, or mapped to disk if large."""
    if columns * rows <= MAPPED_VALUES:
        return np.empty((columns, rows))
    return make_mapped(columns, rows)


def make_mapped(columns: int, rows: int) -> Array:
    """Room for so many columns in a file without a name, shape (columns, rows)."""
    with tempfile.TemporaryFile() as handle:  # the mapping keeps what it needs of it
        return np.memmap(handle, dtype=np.float64, mode="w+", shape=(columns, rows))


def room_for(size: int, *, beside: int = 0) -> Array:
    """Room for one series, shape (size,), beside so many of its size; a ``columns.Room``."""
    if (1 + beside) * size <= MAPPED_VALUES:
        return np.empty(size)
    found: Array = make_mapped(1, size)[0]
    return found


def even_times(size: int, rate: float) -> Array:
    """Times of a log without any [s], from its rate [Hz]."""
    times, start = room_for(size), 0
    for piece in pieces(times):
        np.divide(np.arange(start, start + piece.size), rate, out=piece)
        start += piece.size
    return times


def _decoded(block: bytes, line: int, where: str) -> str:
    try:
        return block.decode("utf-8-sig" if line == 1 else "utf-8").replace("\r\n", "\n")
    except UnicodeDecodeError as error:
        at = line + block.count(b"\n", 0, error.start)
        found = said("byte 0x{block:02x}", block=block[error.start])
        raise SurveyError(
            Problem(
                "this is no UTF-8 text",
                said("{where}, line {at}", where=where, at=at),
                found,
                "text in UTF-8",
            )
        ) from None


def _parse(
    rows: list[str],
    layout: Layout,
    wanted: tuple[list[int], list[int]],
    place: tuple[int, Wrong],
) -> tuple[Array, list[list[str]]]:
    """Values of one block, by numpy where it can."""
    numbers, texts = wanted
    commas = len(layout.names) - 1
    if not texts and all(row.count(layout.separator) == commas for row in rows):
        try:
            values = np.loadtxt(
                rows, delimiter=layout.separator, usecols=numbers, comments=None, ndmin=2
            )
        except ValueError:
            pass
        else:
            if values.shape[0] == len(rows):
                return values.T, []
    return _parse_lines(rows, layout, wanted, place)


def _parse_lines(
    rows: list[str],
    layout: Layout,
    wanted: tuple[list[int], list[int]],
    place: tuple[int, Wrong],
) -> tuple[Array, list[list[str]]]:
    numbers, texts = wanted
    first, wrong = place
    values = np.full((len(numbers), len(rows)), np.nan)
    words: list[list[str]] = [[] for _ in texts]
    filled = 0
    width = len(layout.names)
    for offset, cells in enumerate(_cells_of(rows, layout.separator)):
        line = first + offset
        if isinstance(cells, csv.Error):
            what = said("the line is no CSV ({error})", error=cells)
            wrong.add(line, what, rows[min(offset, len(rows) - 1)][:80], expected="numbers")
            continue
        if not cells or not any(cell.strip() for cell in cells):
            continue
        if len(cells) != width:
            hint = _width_hint(cells, width, layout.separator)
            wrong.add(
                line,
                "a row of another width",
                said("{size} cells", size=len(cells)),
                expected=str(width),
                hint=hint,
            )
            continue
        for row, index in enumerate(numbers):
            values[row, filled] = _number(cells[index], (line, layout.names[index]), wrong)
        for column, index in zip(words, texts, strict=True):
            column.append(sys.intern(cells[index].strip()))
        filled += 1
    return values[:, :filled], words


def _cells_of(rows: list[str], separator: str) -> Iterator[list[str] | csv.Error]:
    """Cells of every row; a row that is none (a bare carriage return, an endless cell) is told."""
    reader = csv.reader(rows, delimiter=separator)
    while True:
        try:
            yield next(reader)
        except StopIteration:
            return
        except csv.Error as error:
            yield error


def _width_hint(cells: Sequence[str], width: int, separator: str) -> str:
    if separator == "," and len(cells) > width:
        return "were decimal commas written? Numbers take a decimal point"
    return "was the file cut off while it was written?" if len(cells) < width else ""


def _number(cell: str, place: tuple[int, str], wrong: Wrong) -> float:
    text = cell.strip()
    if not text:
        return float("nan")
    try:
        return float(text)
    except ValueError:
        hint = "numbers take a decimal point" if "," in text else ""
        if _CLOCK.search(text):
            hint = "times are seconds, as a number; `rate_hz` replaces them"
            if place[1].endswith("_deg"):
                hint = "angles are decimal degrees"
        wrong.add(
            place[0],
            said("{place} is no number", place=place[1]),
            cell,
            expected="a number",
            hint=hint,
        )
        return 0.0
