"""Files of a folder that a stranger made: nothing outside of it is read or written through it.

A path of a project resolves inside its folder, whatever links, ``..`` or drive letters it is made
of. What is opened is a regular file of bounded size: no device, no pipe, and for writing no link
and no file that has a second name elsewhere.
Flags that a system does not have are left away; nothing here needs POSIX.
"""

from __future__ import annotations

import errno
import os
import re
import stat
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Final

from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said

MAX_LOG_BYTES: Final = 256 * 1024 * 1024
"""Largest file that is hashed or packed."""

_COMMON: Final = (
    getattr(os, "O_BINARY", 0)
    | getattr(os, "O_CLOEXEC", 0)
    | getattr(os, "O_NONBLOCK", 0)
    | getattr(os, "O_NOCTTY", 0)
)
_DRIVE: Final = re.compile(r"[A-Za-z]:")
ON_WINDOWS: Final = os.name == "nt"
LONGEST_WINDOWS: Final = 259
"""Letters of a path that every program on Windows can open."""
UNSAFE_LETTERS: Final = '/\\:*?"<>|'
"""Letters that no name of a file may hold on some system."""
_DEVICES: Final = frozenset(
    {
        "con",
        "prn",
        "aux",
        "nul",
        "conin$",
        "conout$",
        *(f"{name}{k}" for name in ("com", "lpt") for k in range(1, 10)),
    }
)
_OUTSIDE_HINT: Final = "copy the file into the project folder and name it there"


def place_inside(folder: Path, name: str) -> Path | None:
    """Real path of a file that a project names, None where it does not lie in the folder.

    Parameters
    ----------
    folder : Path
    name : str
        As written; the file need not exist.
    """
    plain = name.replace("\\", "/")
    if not name or "\0" in name or plain.startswith("/") or _DRIVE.match(plain):
        return None
    if ON_WINDOWS and is_reserved(name):
        return None
    try:
        root = os.path.realpath(folder)
        real = os.path.realpath(folder / name)
    except (OSError, ValueError):
        return None
    within = os.path.commonpath([root, real]) == root if _same_drive(root, real) else False
    return Path(real) if within and real != root else None


def is_reserved(name: str) -> bool:
    """Whether a part of a path is a device on Windows, or loses its last letter there.

    CON, NUL, COM1 and their like are devices with any ending; a point or blank at the end is cut.
    """
    parts = [part for part in name.replace("\\", "/").split("/") if part not in ("", ".", "..")]
    return any(p.split(".")[0].strip().lower() in _DEVICES or p[-1] in ". " for p in parts)


def can_name_file(name: str) -> bool:
    """Whether an id can be the name of a file on every system, so that a project can be carried.

    Printable letters without those of paths, no point in front, no point or blank at the end, and
    no device of Windows.
    """
    usable = bool(name) and name.isprintable() and not set(name) & set(UNSAFE_LETTERS)
    return usable and not name.startswith(".") and not is_reserved(name)


def name_hint(name: str) -> str:
    """Why an id that looks good cannot be the name of a file; empty where its letters tell it."""
    if not is_reserved(name):
        return ""
    return said("Windows keeps this name for a device, or cuts its last letter")


def file_name_of(text: str, *, other: str) -> str:
    """A text as the name of a file on every system; ``other`` stands where nothing is left."""
    name = "".join("-" if c in UNSAFE_LETTERS or not c.isprintable() else c for c in text)
    name = name.strip(" ").rstrip(" .")
    return name if can_name_file(name) else f"{other}-{name}".rstrip("-. ")


def need_short_path(path: Path, *, room: int) -> None:
    """Refuse a folder whose files would have paths that Windows does not open.

    Parameters
    ----------
    path : Path
    room : int
        Letters that the files below it need.

    Raises
    ------
    SurveyError
    """
    length = len(str(path.absolute())) + room
    if ON_WINDOWS and length > LONGEST_WINDOWS:
        from surveyapp.io.files import shown_path

        raise SurveyError(
            Problem(
                "the path is longer than Windows allows",
                shown_path(path),
                said("{length} letters with the books below it", length=length),
                said("at most {longest_windows}", longest_windows=LONGEST_WINDOWS),
                "choose a folder nearer to the root of the drive",
            )
        )


def _same_drive(first: str, second: str) -> bool:
    return os.path.splitdrive(first)[0].lower() == os.path.splitdrive(second)[0].lower()


def checked_inside(folder: Path, name: str, *, where: str) -> Path:
    """As ``place_inside``.

    Raises
    ------
    SurveyError
        If the path leads out of the folder.
    """
    real = place_inside(folder, name)
    if real is None:
        problem = outside_problem(name, where=where)
        if _is_special(folder / name):
            problem = replace(
                problem, what=said("{what} and is no regular file", what=problem.what)
            )
        raise SurveyError(problem)
    return real


def _is_special(path: Path) -> bool:
    try:
        mode = path.stat().st_mode
    except (OSError, ValueError):
        return False
    return not stat.S_ISREG(mode) and not stat.S_ISDIR(mode)


def outside_problem(name: str, *, where: str) -> Problem:
    """A path leads out of the project folder."""
    from surveyapp.io.files import shown

    return Problem(
        "the path leads out of the project folder",
        where,
        shown(name),
        "a file below the project folder, reached by no link to the outside",
        _OUTSIDE_HINT,
    )


def open_regular(path: Path, flags: int, *, follow: bool = False) -> int:
    """Open a regular file and return its descriptor.

    A file that has a second name elsewhere (a hard link) gets bytes of its own before it is written
    to: what is written appears in the project alone.

    Parameters
    ----------
    path : Path
    flags : int
        Of ``os.open``.
    follow : bool
        Whether a link at the end of the path may be followed.

    Raises
    ------
    OSError
        Also for a link, a folder, a device and a pipe.
    """
    _refuse_irregular(path, follow=follow)
    if not follow:
        flags |= getattr(os, "O_NOFOLLOW", 0)
    handle = os.open(path, flags | _COMMON, 0o644)
    state = os.fstat(handle)
    if not stat.S_ISREG(state.st_mode):
        os.close(handle)
        raise OSError(errno.EINVAL, "no regular file")
    if state.st_nlink > 1 and not follow and flags & (os.O_WRONLY | os.O_RDWR):
        os.close(handle)
        _part(path)
        return os.open(path, flags | _COMMON, 0o644)
    return handle


def _part(path: Path) -> None:
    """Give a file that has several names bytes of its own under this one."""
    from surveyapp.io.tomltext import atomic_write

    atomic_write(path, _pieces(path))


def _pieces(path: Path) -> Iterator[bytes]:
    """Bytes of a file, which is closed behind them: Windows replaces none that is open."""
    with os.fdopen(open_regular(path, os.O_RDONLY), "rb") as stream:
        while piece := stream.read(1 << 20):
            yield piece


def _refuse_irregular(path: Path, *, follow: bool) -> None:
    """Look before opening: opening a pipe or a device may already do something."""
    try:
        mode = (path.stat() if follow else path.lstat()).st_mode
    except FileNotFoundError:
        return
    if stat.S_ISLNK(mode):
        raise OSError(errno.ELOOP, "this is a link")
    if stat.S_ISDIR(mode):
        raise OSError(errno.EISDIR, "this is a folder")
    if not stat.S_ISREG(mode):
        raise OSError(errno.EINVAL, "this is no regular file")


def is_regular(path: Path) -> bool:
    """Whether a path is a regular file itself, and no link to one."""
    try:
        return stat.S_ISREG(path.lstat().st_mode)
    except (OSError, ValueError):
        return False
