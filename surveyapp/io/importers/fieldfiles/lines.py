"""A field file as a stream of lines: looked through once, then read line by line, never as a whole.

The first passage finds the encoding and refuses what is no text; the second yields the lines. The
memory is that of one line, and a line is bounded.
"""

from __future__ import annotations

import codecs
import hashlib
import io
import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO, Final

from surveyapp.errors import Problem, SurveyError
from surveyapp.io.files import shown_path
from surveyapp.io.guarded import MAX_LOG_BYTES, open_regular
from surveyapp.languages import said

LONGEST_LINE: Final = 1 << 20
"""Characters; only a GSI file may have all its blocks on one line, and is cut between them."""
_CHUNK: Final = 1 << 20
_TOLD_EVERY: Final = 2000

Cut = Callable[[str], int]
"""Place where a text may be cut in two, 0 where nowhere."""


@dataclass(frozen=True, slots=True)
class FieldText:
    """A field file that was looked through.

    Parameters
    ----------
    path : Path
    name : str
        What messages call it.
    size : int
        Bytes.
    encoding : str
        ``ascii``, ``utf-8`` or ``latin-1``.
    ended : bool
        Whether the last line has its end.
    """

    path: Path
    name: str
    size: int
    encoding: str
    ended: bool = True

    def lines(
        self, *, progress: Callable[[float], None] | None = None, cut: Cut | None = None
    ) -> Iterator[tuple[int, str]]:
        """Numbered lines without their ends.

        Parameters
        ----------
        progress : callable or None
            Told from time to time which part has been read, 0 to 1.
        cut : callable or None
            Where a line that is too long may be cut; its parts keep its number.

        Raises
        ------
        SurveyError
            For a line that is too long.
        """
        codec = "utf-8-sig" if self.encoding == "utf-8" else "latin-1"
        done = number = 0
        with (
            open_field_file(self.path, self.name) as binary,
            io.TextIOWrapper(binary, encoding=codec, newline=None) as stream,
        ):
            read = stream.readline
            while line := read(LONGEST_LINE):
                number += 1
                while not line.endswith("\n") and len(line) >= LONGEST_LINE:
                    place = cut(line) if cut is not None else 0
                    if not place:
                        raise SurveyError(_too_long(self.name, number))
                    yield number, line[:place]
                    done += place
                    if progress is not None:
                        progress(min(1.0, done / self.size))
                    line = line[place:] + read(LONGEST_LINE)
                done += len(line)
                if progress is not None and number % _TOLD_EVERY == 0:
                    progress(min(1.0, done / self.size))
                yield number, line.removesuffix("\n")


def _too_long(name: str, line: int) -> Problem:
    expected = said("lines of at most {longest_line} characters", longest_line=LONGEST_LINE)
    return Problem(
        "the line is too long for a field file",
        said("{name}, line {line}", name=name, line=line),
        "",
        expected,
    )


def open_field_file(path: Path, name: str) -> BinaryIO:
    """Open a field file for reading.

    Parameters
    ----------
    path : Path
    name : str
        What messages call it.

    Raises
    ------
    SurveyError
        If it is missing, no regular file, not readable, or larger than any field file.
    """
    try:
        stream = os.fdopen(open_regular(path, os.O_RDONLY, follow=True), "rb")
    except FileNotFoundError:
        what, expected = "the file does not exist", "an existing file"
        raise SurveyError(Problem(what, name, shown_path(path), expected)) from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        what = said("the file cannot be read ({reason})", reason=reason)
        raise SurveyError(Problem(what, name, shown_path(path), "a text file")) from None
    size = os.fstat(stream.fileno()).st_size
    if size > MAX_LOG_BYTES:
        stream.close()
        expected = said("at most {size} MB", size=MAX_LOG_BYTES // 2**20)
        found = f"{size / 1e6:.0f} MB"
        raise SurveyError(Problem("the file is too large for a field file", name, found, expected))
    return stream


def look_through(path: Path, *, single_byte: bool = False) -> FieldText:
    """Find the encoding of a field file and refuse what is no text.

    Parameters
    ----------
    path : Path
    single_byte : bool
        Columns are counted in bytes: never decode several bytes to one character.

    Raises
    ------
    SurveyError
        As ``open_field_file``; for a binary file, naming the line.
    """
    ascii_only = utf8 = True
    decoder = codecs.getincrementaldecoder("utf-8")()
    lines, size, last = 1, 0, b"\n"
    with open_field_file(path, path.name) as stream:
        while chunk := stream.read(_CHUNK):
            size, last = size + len(chunk), chunk[-1:]
            if b"\x00" in chunk:
                lines += chunk.count(b"\n", 0, chunk.index(b"\x00"))
                raise SurveyError(_binary(path.name, lines))
            lines += chunk.count(b"\n")
            ascii_only = ascii_only and chunk.isascii()
            utf8 = utf8 and not single_byte and _continues(decoder, chunk)
    if utf8 and not single_byte:
        utf8 = _continues(decoder, b"", final=True)
    encoding = "ascii" if ascii_only else "utf-8" if utf8 and not single_byte else "latin-1"
    return FieldText(path, path.name, size, encoding, last in b"\r\n\x1a\x03")


def _continues(decoder: codecs.IncrementalDecoder, chunk: bytes, *, final: bool = False) -> bool:
    """Whether a text in UTF-8 goes on."""
    try:
        decoder.decode(chunk, final)
    except UnicodeDecodeError:
        return False
    return True


def _binary(name: str, line: int) -> Problem:
    return Problem(
        "this is a binary file",
        said("{name}, line {line}", name=name, line=line),
        "a NUL byte",
        "text in UTF-8",
        "a spreadsheet must be saved as CSV in UTF-8",
    )


def field_digest(path: Path) -> str:
    """Sha256 of a field file, read in pieces.

    Raises
    ------
    SurveyError
        As ``open_field_file``.
    """
    found = hashlib.sha256()
    with open_field_file(path, path.name) as stream:
        while chunk := stream.read(_CHUNK):
            found.update(chunk)
    return found.hexdigest()
