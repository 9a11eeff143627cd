"""One writing of everything that an import brings: new files first, project.toml last, or nothing.

project.toml decides: as long as it does not name the new files, the project is as it was. What was
written is taken away again when anything fails.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from surveyapp.errors import Problem, SurveyError
from surveyapp.io.files import MAX_BYTES, shown
from surveyapp.io.guarded import file_name_of
from surveyapp.io.importers.fieldfiles.lines import field_digest, open_field_file
from surveyapp.io.importers.fieldfiles.parts import parts_hint
from surveyapp.io.tomltext import atomic_write
from surveyapp.io.writing import append_tables
from surveyapp.languages import said

_CHUNK: Final = 1 << 20


@dataclass(frozen=True, slots=True)
class FileCopy:
    """A file from outside that goes into the project unchanged, read in pieces.

    Parameters
    ----------
    source : Path
    sha256 : str
        Of its bytes; a file that has others meanwhile is refused.
    """

    source: Path
    sha256: str


Content = bytes | FileCopy


@dataclass(frozen=True, slots=True)
class Additions:
    """New files by their path in the project, and tables for the end of project.toml."""

    files: Mapping[str, Content]
    tables: Sequence[tuple[str, Mapping[str, object]]]


def stored_name(folder: Path, copied: FileCopy, name: str) -> str:
    """Path below imports/ for the file itself; one that is there with the same bytes is kept."""
    file = copied.source
    own = file_name_of(file.name, other="import")
    for candidate in (own, f"{name}-{own}"):
        path = folder / "imports" / candidate
        if not path.exists() or _same_bytes(path, copied):
            return f"imports/{candidate}"
    raise SurveyError(
        Problem(
            "imports/ holds another file of this name",
            "imports",
            shown(file.name),
            "a name that is free",
            "rename the file, or take another `traverse`",
        )
    )


def _same_bytes(path: Path, content: Content) -> bool:
    try:
        if not path.is_file():
            return False
        if isinstance(content, bytes):
            return path.stat().st_size == len(content) and path.read_bytes() == content
        return field_digest(path) == content.sha256
    except (OSError, SurveyError):
        return False


def taken_files(
    folder: Path, files: Mapping[str, Content], *, parts: tuple[tuple[int, int], ...] = ()
) -> list[Problem]:
    """Problems of files that exist already, or of books that no project could read again.

    Parameters
    ----------
    folder : Path
    files : mapping
    parts : tuple of (int, int)
        Lines of the field file that are books of their own.
    """
    problems = []
    for name, content in files.items():
        path = folder / name
        own = name.startswith("imports/") and not name.endswith(".raw.csv")
        if (path.exists() or path.is_symlink()) and not (own and _same_bytes(path, content)):
            problems.append(
                Problem(
                    "a file of this name exists",
                    shown(name),
                    "a book or an import",
                    "a name that is free",
                    "take another name with `traverse`",
                )
            )
        if isinstance(content, bytes) and len(content) > MAX_BYTES and not _as_read(name):
            problems.append(
                Problem(
                    "the readings are too many for one book",
                    shown(name),
                    f"{len(content) / 1e6:.0f} MB",
                    said("at most {size} MB", size=MAX_BYTES // 2**20),
                    parts_hint(parts),
                )
            )
    return problems


def _as_read(name: str) -> bool:
    """Whether a file is kept as evidence, and read by no command."""
    return name.startswith("imports/")


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
            for name, content in additions.files.items():
                _write_new(folder, name, content, made)
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


def _write_new(folder: Path, name: str, content: Content, made: list[Path]) -> None:
    path = folder / name
    parent = path.parent
    if parent.is_symlink() or (parent.exists() and not parent.is_dir()):
        raise SurveyError(
            Problem("this is no folder of the project", shown(parent.name), "", "a plain folder")
        )
    if path.exists() and _same_bytes(path, content):
        return
    try:
        if not parent.exists():
            parent.mkdir()
            made.append(parent)
    except OSError as error:
        raise SurveyError(
            Problem(
                said("the folder cannot be made ({strerror})", strerror=error.strerror or error),
                shown(str(parent)),
            )
        ) from None
    made.append(path)
    atomic_write(path, content if isinstance(content, bytes) else _pieces(content))


def _pieces(copied: FileCopy) -> Iterator[bytes]:
    """Bytes of a file; behind its end they are compared with those that were read."""
    digest = hashlib.sha256()
    with open_field_file(copied.source, copied.source.name) as stream:
        while chunk := stream.read(_CHUNK):
            digest.update(chunk)
            yield chunk
    if digest.hexdigest() != copied.sha256:
        what = "the file was changed while it was imported"
        raise SurveyError(Problem(what, copied.source.name, "", "a file that nobody writes to"))


def _take_back(made: Sequence[Path]) -> None:
    for path in reversed(made):
        try:
            if path.is_dir():
                path.rmdir()
            else:
                path.unlink(missing_ok=True)
        except OSError:
            continue
