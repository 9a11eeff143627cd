"""Reading files that strangers made: size, kind and encoding are checked before anything else.

Every reader of a text file goes through here, so that a folder, a device, a photograph or a file
of 200 MB ends in the same clear sentence. Nothing here knows what the text means.
"""

from __future__ import annotations

import os
import re
import stat
from dataclasses import replace
from pathlib import Path
from typing import Final

from surveyapp.errors import Problem, SurveyError
from surveyapp.io.guarded import checked_inside
from surveyapp.languages import said

MAX_BYTES: Final = 32 * 1024 * 1024
MAX_LINES: Final = 100_000
"""Largest text file that is read; a field book of a whole year stays far below it."""

MAX_COLUMNS: Final = 200
"""No table of observations has more columns."""

_CONTROL = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f]")
_STEERING = re.compile(
    r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u2028\u2029\u202a-\u202e\u2066-\u2069\ufeff]|\r(?!\n)"
)
_SHOWN = 60


def shown(value: object) -> str:
    """Text of a found value for a message: printable, and never longer than a line."""
    text = value if isinstance(value, str) else repr(value)
    text = "".join(c if c.isprintable() else escape(c) for c in text[: _SHOWN + 1])
    return text[:_SHOWN] + "..." if len(text) > _SHOWN else text


def shown_path(path: Path) -> str:
    """Text of a path for a message: of a long one the end, where the name stands."""
    text = str(path)
    return shown(text if len(text) <= _SHOWN else "..." + text[3 - _SHOWN :])


def escape(letter: str) -> str:
    """A character as its escape: a backslash, x or u, and its code."""
    code = ord(letter)
    return f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}"


def visible(text: str) -> str:
    """Text with every control character as its escape, line ends and tabs left as they are.

    Controls of C0 and C1, line and paragraph separators, and what turns the direction of writing
    over: in a name, a note or a path they would steer the terminal or show another text.
    """
    return _STEERING.sub(lambda match: escape(match[0]), text)


def has_control(text: str) -> bool:
    """Whether the text holds control characters other than tab and line ends."""
    return _CONTROL.search(text) is not None


def has_steering(text: str) -> bool:
    """Whether a text would steer a terminal or turn the direction of writing over."""
    return _STEERING.search(text) is not None


def read_bytes(path: Path, *, where: str, follow: bool = True) -> bytes:
    """Read a whole regular file of at most ``MAX_BYTES``.

    Parameters
    ----------
    path : Path
        The file.
    where : str
        What the message calls it.
    follow : bool
        Whether the path may be a link; not so for a file of a project folder.

    Returns
    -------
    bytes

    Raises
    ------
    SurveyError
        If it is missing, no regular file, too large or not readable.
    """
    try:
        status = path.stat() if follow else path.lstat()
        if not stat.S_ISREG(status.st_mode):
            what = "this is a folder" if stat.S_ISDIR(status.st_mode) else "this is no regular file"
            raise SurveyError(Problem(what, where, shown_path(path), "a text file"))
        if status.st_size > MAX_BYTES:
            raise SurveyError(_too_large(where, status.st_size))
        with path.open("rb") as stream:
            opened = os.fstat(stream.fileno())
            if (opened.st_dev, opened.st_ino) != (status.st_dev, status.st_ino):
                raise OSError("it was exchanged while it was opened")
            data = stream.read(MAX_BYTES + 1)
    except FileNotFoundError:
        raise SurveyError(
            Problem(
                "the file does not exist",
                where,
                shown_path(path),
                "an existing file",
                "paths are relative to the file that names them",
            )
        ) from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise SurveyError(
            Problem(
                said("the file cannot be read ({reason})", reason=reason), where, shown_path(path)
            )
        ) from None
    if len(data) > MAX_BYTES:
        raise SurveyError(_too_large(where, len(data)))
    return data


def _too_large(where: str, size: int) -> Problem:
    return Problem(
        "the file is too large for a text of observations",
        where,
        f"{size / 1e6:.0f} MB",
        said("at most {size} MB", size=MAX_BYTES // (1024 * 1024)),
        "is it a sensor log? Those are named in [[sensor_log]]",
    )


def too_many_lines(text: str, where: str) -> Problem | None:
    """A text of more lines than any book has: each would be a problem of its own."""
    count = text.count("\n")
    if count <= MAX_LINES:
        return None
    return Problem(
        "the text has too many lines for a book",
        where,
        str(count),
        said("at most {lines} lines", lines=MAX_LINES),
        "is it a sensor log? Those are named in [[sensor_log]]",
    )


def too_many_columns(count: int, where: str) -> Problem:
    """A table that is none of observations."""
    return Problem(
        "the table has too many columns",
        where,
        str(count),
        said("at most {max_columns} columns", max_columns=MAX_COLUMNS),
    )


def decode(data: bytes, *, where: str) -> str:
    """Decode UTF-8 with or without BOM.

    Raises
    ------
    SurveyError
        If the bytes are binary (NUL) or no UTF-8, naming the line.
    """
    if b"\x00" in data:
        line = data.count(b"\n", 0, data.index(b"\x00")) + 1
        raise SurveyError(
            Problem(
                "this is a binary file",
                said("{where}, line {line}", where=where, line=line),
                "a NUL byte",
                "text in UTF-8",
                "a spreadsheet must be saved as CSV in UTF-8",
            )
        )
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise SurveyError(
            Problem(
                "this is no UTF-8 text",
                said("{where}, line {line}", where=where, line=line),
                said("byte 0x{data:02x}", data=data[error.start]),
                "text in UTF-8",
                "save the file anew with the encoding UTF-8",
            )
        ) from None


def read_inside(folder: Path, name: str, *, where: str) -> bytes:
    """Read a file that a project names; see ``read_bytes``.

    Raises
    ------
    SurveyError
        Also if the path leads out of the project folder.
    """
    real = checked_inside(folder, name, where=where)
    try:
        return read_bytes(real, where=where, follow=False)
    except SurveyError as error:
        named = shown_path(folder / name)
        told = [
            replace(p, found=named) if p.found == shown_path(real) else p for p in error.problems
        ]
        raise SurveyError(told) from None


def read_text(path: Path, *, where: str) -> str:
    """Read a text file; see ``read_bytes`` and ``decode``."""
    return decode(read_bytes(path, where=where), where=where)
