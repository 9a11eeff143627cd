"""One writing of everything that an import brings: new files first, project.toml last, or nothing.

project.toml decides: as long as it does not name the new files, the project is as it was. What was
written is taken away again when anything fails.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from surveyapp.errors import Problem, SurveyError
from surveyapp.io.files import MAX_BYTES, shown
from surveyapp.io.tomltext import atomic_write
from surveyapp.io.writing import append_tables


@dataclass(frozen=True, slots=True)
class Additions:
    """New files by their path in the project, and tables for the end of project.toml."""

    files: Mapping[str, bytes]
    tables: Sequence[tuple[str, Mapping[str, object]]]


def stored_name(folder: Path, file: Path, data: bytes, name: str) -> str:
    """Path below imports/ for the file itself; one that is there with the same bytes is kept."""
    for candidate in (file.name, f"{name}-{file.name}"):
        path = folder / "imports" / candidate
        if not path.exists() or _same_bytes(path, data):
            return f"imports/{candidate}"
    raise SurveyError(
        Problem(
            "imports/ holds another file of this name",
            "imports",
            shown(file.name),
            "a name that is free",
            "rename the file, or take another --traverse",
        )
    )


def _same_bytes(path: Path, data: bytes) -> bool:
    try:
        return path.is_file() and path.stat().st_size == len(data) and path.read_bytes() == data
    except OSError:
        return False


def taken_files(folder: Path, files: Mapping[str, bytes]) -> list[Problem]:
    """Problems of files that exist already, or would be too large to be read again."""
    problems = []
    for name, data in files.items():
        path = folder / name
        own = name.startswith("imports/") and not name.endswith(".raw.csv")
        if (path.exists() or path.is_symlink()) and not (own and _same_bytes(path, data)):
            problems.append(
                Problem(
                    "a file of this name exists",
                    shown(name),
                    "a book or an import",
                    "a name that is free",
                    "take another name with --traverse",
                )
            )
        if len(data) > MAX_BYTES:
            problems.append(
                Problem(
                    "the readings are too many for one book",
                    shown(name),
                    f"{len(data) / 1e6:.0f} MB",
                    f"at most {MAX_BYTES // 2**20} MB",
                    "split the field file by days or set-ups and import the parts",
                )
            )
    return problems


def sha256(data: bytes) -> str:
    """Digest of a file."""
    return hashlib.sha256(data).hexdigest()


def write_additions(folder: Path, additions: Additions) -> None:
    """Write everything, or leave the project as it was.

    Raises
    ------
    SurveyError
        If the project is open elsewhere, closed or cannot be written.
    """
    from surveyapp.io.filing.lock import ProjectLock

    with ProjectLock(folder) as lock:
        if not lock.writable:
            raise SurveyError(_not_writable(folder, closed=lock.closed))
        made: list[Path] = []
        try:
            for name, data in additions.files.items():
                _write_new(folder, name, data, made)
            append_tables(folder / "project.toml", additions.tables)
        except BaseException:
            _take_back(made)
            raise


def _not_writable(folder: Path, *, closed: bool) -> Problem:
    if closed:
        hint = "surveyapp reopen tells why and opens it"
        return Problem("the project is closed", shown(str(folder)), "", "an open project", hint)
    what = "the project is open elsewhere or cannot be written"
    return Problem(what, shown(str(folder)), "", "a project that nobody else writes to")


def _write_new(folder: Path, name: str, data: bytes, made: list[Path]) -> None:
    path = folder / name
    parent = path.parent
    if parent.is_symlink() or (parent.exists() and not parent.is_dir()):
        raise SurveyError(
            Problem("this is no folder of the project", shown(parent.name), "", "a plain folder")
        )
    if path.exists() and _same_bytes(path, data):
        return
    try:
        if not parent.exists():
            parent.mkdir()
            made.append(parent)
    except OSError as error:
        raise SurveyError(
            Problem(f"the folder cannot be made ({error.strerror or error})", shown(str(parent)))
        ) from None
    made.append(path)
    atomic_write(path, data)


def _take_back(made: Sequence[Path]) -> None:
    for path in reversed(made):
        try:
            if path.is_dir():
                path.rmdir()
            else:
                path.unlink(missing_ok=True)
        except OSError:
            continue
