"""Reading files that strangers made: size, kind and encoding are checked before anything else.

Every reader of a text file goes through here, so that a folder, a device, a photograph or a file
of 200 MB ends in the same clear sentence. Nothing here knows what the text means.
"""

from __future__ import annotations

import re
import stat
from pathlib import Path
from typing import Final

from surveyapp.errors import Problem, SurveyError

MAX_BYTES: Final = 32 * 1024 * 1024
"""Largest text file that is read; a field book of a whole year stays far below it."""

_CONTROL = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f]")
_SHOWN = 60


def shown(value: object) -> str:
    """Text of a found value for a message: printable, and never longer than a line."""
    text = value if isinstance(value, str) else repr(value)
    text = "".join(c if c.isprintable() else f"\\x{ord(c):02x}" for c in text[: _SHOWN + 1])
    return text[:_SHOWN] + "..." if len(text) > _SHOWN else text


def shown_path(path: Path) -> str:
    """Text of a path for a message: of a long one the end, where the name stands."""
    text = str(path)
    return shown(text if len(text) <= _SHOWN else "..." + text[3 - _SHOWN :])


def has_control(text: str) -> bool:
    """Whether the text holds control characters other than tab and line ends."""
    return _CONTROL.search(text) is not None


def read_bytes(path: Path, *, where: str) -> bytes:
    """Read a whole regular file of at most ``MAX_BYTES``.

    Parameters
    ----------
    path : Path
        The file.
    where : str
        What the message calls it.

    Returns
    -------
    bytes

    Raises
    ------
    SurveyError
        If it is missing, no regular file, too large or not readable.
    """
    try:
        status = path.stat()
        if not stat.S_ISREG(status.st_mode):
            what = "this is a folder" if stat.S_ISDIR(status.st_mode) else "this is no regular file"
            raise SurveyError(Problem(what, where, shown_path(path), "a text file"))
        if status.st_size > MAX_BYTES:
            raise SurveyError(_too_large(where, status.st_size))
        with path.open("rb") as stream:
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
            Problem(f"the file cannot be read ({reason})", where, shown_path(path))
        ) from None
    if len(data) > MAX_BYTES:
        raise SurveyError(_too_large(where, len(data)))
    return data


def _too_large(where: str, size: int) -> Problem:
    return Problem(
        "the file is too large for a text of observations",
        where,
        f"{size / 1e6:.0f} MB",
        f"at most {MAX_BYTES // (1024 * 1024)} MB",
        "is it a sensor log? Those are named in [[sensor_log]]",
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
                f"{where}, line {line}",
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
                f"{where}, line {line}",
                f"byte 0x{data[error.start]:02x}",
                "text in UTF-8",
                "save the file anew with the encoding UTF-8",
            )
        ) from None


def read_text(path: Path, *, where: str) -> str:
    """Read a text file; see ``read_bytes`` and ``decode``."""
    return decode(read_bytes(path, where=where), where=where)
