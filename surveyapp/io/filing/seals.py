"""Closing: what is sealed, whether it still is as it was, and whether a project is closed.

A closing is one entry of the ledger with the size and sha256 of every file of the folder (project
file, books, own cards and rule books, logs, notes), chained one to the next and to the entry
before. ``results/``, hidden files and the ledger itself are left out: the ledger seals itself.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from surveyapp.core.checks.filing_checks import filing_checks
from surveyapp.domain.closing import Closing, Filing
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.cards import is_path
from surveyapp.io.files import read_text, shown
from surveyapp.io.filing.ledger import LEDGER_FILE, Ledger, LedgerEntry, digest_of, read_ledger
from surveyapp.io.tables import parse_toml

CLOSING: Final = "closing"
REOPENING: Final = "reopening"
_LEFT_OUT: Final = frozenset({"results"})


@dataclass(frozen=True, slots=True)
class SealedFile:
    """A file under a seal: its name as written, its size and its sha256."""

    name: str
    size: int
    sha256: str

    def to_dict(self) -> dict[str, Any]:
        """Plain values for the ledger."""
        return {"name": self.name, "bytes": self.size, "sha256": self.sha256}


def hash_file(path: Path, name: str) -> SealedFile:
    """Size and sha256 of a file, read in pieces: a log may be large.

    Raises
    ------
    SurveyError
        If it cannot be read.
    """
    digest, size = hashlib.sha256(), 0
    try:
        with path.open("rb") as stream:
            while block := stream.read(1 << 20):
                digest.update(block)
                size += len(block)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise SurveyError(
            Problem(f"the file cannot be read ({reason})", shown(name), shown(str(path)))
        ) from None
    return SealedFile(name, size, digest.hexdigest())


def project_file_names(folder: Path) -> tuple[str, ...]:
    """Names of everything that a closing seals, project.toml first, the others sorted.

    Files of the folder by their relative path, then files outside of it that project.toml names
    (a card, a rule book, a sensor log), by the name as written there.
    """
    inside = {
        path.relative_to(folder).as_posix()
        for path in _walk(folder)
        if path.relative_to(folder).as_posix() != LEDGER_FILE
    }
    outside = {
        name
        for name in _named_files(folder)
        if os.path.normpath(name.replace("\\", "/")) not in inside and (folder / name).is_file()
    }
    return (
        *sorted(inside, key=lambda name: (name != "project.toml", name)),
        *sorted(outside),
    )


def _walk(folder: Path) -> Iterator[Path]:
    for path in sorted(folder.iterdir()):
        if path.name.startswith(".") or (path.is_dir() and path.name in _LEFT_OUT):
            continue
        if path.is_dir() and not path.is_symlink():
            yield from _walk_all(path)
        elif path.is_file():
            yield path


def _walk_all(folder: Path) -> Iterator[Path]:
    for path in sorted(folder.iterdir()):
        if path.name.startswith("."):
            continue
        if path.is_dir() and not path.is_symlink():
            yield from _walk_all(path)
        elif path.is_file():
            yield path


def _named_files(folder: Path) -> list[str]:
    """Every path that project.toml names, as it is written."""
    data = parse_toml(
        read_text(folder / "project.toml", where="project.toml"), where="project.toml"
    )
    names = [data.get("rule_book")]
    for table, key in (
        ("instrument", "card"),
        ("sensor_log", "file"),
        ("traverse", "book"),
        ("shaft", "book"),
        ("orientation", "book"),
    ):
        rows = data.get(table)
        if isinstance(rows, Sequence):
            names += [row.get(key) for row in rows if isinstance(row, Mapping)]
    found = [name for name in names if isinstance(name, str) and name]
    return [name for name in found if is_path(name) or "." in name]


def chain(files: Sequence[SealedFile], start: str) -> str:
    """Head of the hash chain over files, begun with the hash of the ledger entry before."""
    head = start
    for item in files:
        link = f"{head}\0{item.name}\0{item.size}\0{item.sha256}"
        head = hashlib.sha256(link.encode("utf-8")).hexdigest()
    return head


def session_table(folder: Path, session: str) -> dict[str, Any]:
    """The [[orientation]] table of a session with plain values, for its hash."""
    data = parse_toml(
        read_text(folder / "project.toml", where="project.toml"), where="project.toml"
    )
    rows = data.get("orientation")
    for row in rows if isinstance(rows, Sequence) else ():
        if isinstance(row, Mapping) and row.get("id") == session:
            return {key: _plain(value) for key, value in row.items()}
    return {}


def _plain(value: object) -> Any:
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_plain(item) for item in value]
    return value if isinstance(value, str | int | float | bool) else str(value)


def seal_of(folder: Path, ledger: Ledger, session: str | None) -> dict[str, Any]:
    """What a closing writes into the ledger: files, hashes, head of the chain.

    Raises
    ------
    SurveyError
        If a file cannot be read.
    """
    if session is None:
        names: Sequence[str] = project_file_names(folder)
        table = ""
    else:
        row = session_table(folder, session)
        names, table = [str(row.get("book", ""))], digest_of(row)
    files = [hash_file(folder / name, name) for name in names]
    start = hashlib.sha256(f"{ledger.last_hash}\0{table}".encode()).hexdigest()
    return {
        "scope": "project" if session is None else "session",
        "session": session or "",
        "files": [item.to_dict() for item in files],
        "table_sha256": table,
        "seal": chain(files, start),
    }


def closings_in_force(ledger: Ledger) -> dict[str, LedgerEntry]:
    """Closings that no reopening has ended, by session id; the project's own under ``""``."""
    found: dict[str, LedgerEntry] = {}
    for entry in ledger.entries:
        name = str(entry.data.get("session", ""))
        if entry.kind == CLOSING:
            found[name] = entry
        elif entry.kind == REOPENING:
            found.pop(name, None)
    return found


def is_closed(folder: Path, session: str | None = None) -> bool:
    """Whether a project, or a session of it, is closed: nothing may be written to it then."""
    try:
        if not (folder / LEDGER_FILE).exists():
            return False
        found = closings_in_force(read_ledger(folder))
    except (SurveyError, OSError, ValueError):
        return False
    return "" in found or (session is not None and session in found)


def changes(folder: Path, entry: LedgerEntry) -> list[str]:
    """What is no longer as it was when it was closed, in words; empty where nothing is."""
    found = []
    files = entry.data.get("files")
    for row in files if isinstance(files, list) else ():
        name = str(row.get("name", ""))
        try:
            now = hash_file(folder / name, name)
        except SurveyError:
            found.append(f"{name} is missing")
            continue
        if (now.size, now.sha256) != (row.get("bytes"), row.get("sha256")):
            found.append(f"{name} was changed")
    table = entry.data.get("table_sha256")
    if table:
        try:
            same = digest_of(session_table(folder, str(entry.data.get("session", "")))) == table
        except (SurveyError, ValueError):
            same = False
        if not same:
            found.append("its table in project.toml was changed")
    return found


def read_filing(folder: Path) -> Filing:
    """State of a project's ledger and closings, every sealed file compared with its seal.

    Raises
    ------
    SurveyError
        If the ledger cannot be read.
    """
    if not (folder / LEDGER_FILE).exists():
        return Filing()
    ledger = read_ledger(folder)
    faults = list(ledger.faults)
    if ledger.tail_altered:
        faults.append("the newline of the last line was changed")
    return Filing(
        entries=len(ledger.entries),
        faults=tuple(faults),
        unfinished_tail=bool(ledger.tail) and not ledger.tail_altered,
        closed_once=any(entry.kind == CLOSING for entry in ledger.entries),
        closings=tuple(
            Closing(
                session=name,
                at=entry.at,
                by=str(entry.data.get("by", "")),
                seal=str(entry.data.get("seal", "")),
                changed=tuple(changes(folder, entry)),
            )
            for name, entry in closings_in_force(ledger).items()
        ),
    )


def changed_after_closing(folder: Path) -> tuple[Problem, ...]:
    """What was changed in a closed project, as problems: for one that can no longer be read."""
    try:
        filing = read_filing(folder)
    except (SurveyError, OSError, ValueError):
        return ()
    return tuple(
        Problem("the closed project was changed", check.where, check.text, "as it was closed")
        for check in filing_checks(filing)
        if check.passed is False and check.confirmed
    )
