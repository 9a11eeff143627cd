"""Closing: what is sealed, whether it still is as it was, and whether a project is closed.

A closing is one entry of the ledger with the size and sha256 of every file of the folder (project
file, books, own cards and rule books, logs, notes), chained one to the next and to the entry
before. ``results/``, hidden files and the ledger itself are left out: the ledger seals itself.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from surveyapp.core.checks.filing_checks import filing_checks
from surveyapp.domain.closing import Closing, Filing
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.files import shown
from surveyapp.io.filing.dependencies import dependencies, differences, session_table
from surveyapp.io.filing.ledger import Ledger, LedgerEntry, digest_of, read_ledger
from surveyapp.io.filing.sealed_files import SealedFile, hash_inside, project_file_names
from surveyapp.io.filing.witness import head_of, missing_entries, typed_head

CLOSING: Final = "closing"
REOPENING: Final = "reopening"


def chain(files: Sequence[SealedFile], start: str) -> str:
    """Head of the hash chain over files, begun with the hash of the ledger entry before."""
    head = start
    for item in files:
        link = f"{head}\0{item.name}\0{item.size}\0{item.sha256}"
        head = hashlib.sha256(link.encode("utf-8")).hexdigest()
    return head


def seal_of(folder: Path, ledger: Ledger, session: str | None) -> dict[str, Any]:
    """What a closing writes into the ledger: files, hashes, head of the chain.

    Raises
    ------
    SurveyError
        If a file cannot be read.
    """
    if session is None:
        names: Sequence[str] = project_file_names(folder)
        table, depends = "", {}
    else:
        row = session_table(folder, session)
        names, table = [str(row.get("book", ""))], digest_of(row)
        depends = dependencies(folder, session)
    files = [hash_inside(folder, name) for name in names]
    start = hashlib.sha256(f"{ledger.last_hash}\0{table}".encode()).hexdigest()
    return {
        "scope": "project" if session is None else "session",
        "session": session or "",
        "files": [item.to_dict() for item in files],
        "table_sha256": table,
        "depends": depends,
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
        found = closings_in_force(read_ledger(folder))
    except (SurveyError, OSError, ValueError):
        return False
    return "" in found or (session is not None and session in found)


def changes(folder: Path, entry: LedgerEntry) -> list[str]:
    """What is no longer as it was when it was closed, in words; empty where nothing is."""
    found = []
    files = entry.data.get("files")
    for row in files if isinstance(files, list) else ():
        if not isinstance(row, Mapping):
            found.append("its list of files is not as a closing writes it")
            continue
        name = str(row.get("name", ""))
        try:
            now = hash_inside(folder, name)
        except SurveyError:
            found.append(f"{shown(name)} is missing")
            continue
        if (now.size, now.sha256) != (row.get("bytes"), row.get("sha256")):
            found.append(f"{shown(name)} was changed")
    return found + _session_changes(folder, entry)


def _session_changes(folder: Path, entry: LedgerEntry) -> list[str]:
    """What a session's azimuth depends on beside its book, as far as it was sealed."""
    session = str(entry.data.get("session", ""))
    table, depends = entry.data.get("table_sha256"), entry.data.get("depends")
    try:
        found = []
        if table and digest_of(session_table(folder, session)) != table:
            found.append("its table in project.toml was changed")
        if session and isinstance(depends, Mapping):
            found += differences(depends, dependencies(folder, session))
    except (SurveyError, ValueError):
        return ["project.toml cannot be read"]
    return found


def read_filing(folder: Path) -> Filing:
    """State of a project's ledger and closings, every sealed file compared with its seal.

    Raises
    ------
    SurveyError
        If the ledger cannot be read.
    """
    ledger = read_ledger(folder)
    faults = [*ledger.faults, *missing_entries(folder, ledger)]
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
                head=head_of(entry.sha256),
                changed=tuple(changes(folder, entry)),
            )
            for name, entry in closings_in_force(ledger).items()
        ),
    )


def sealed_by(folder: Path, typed: str) -> tuple[str, list[str], str]:
    """Head as typed, what is not as that seal says, and what it seals.

    Raises
    ------
    SurveyError
        If it is no seal, or the ledger cannot be read.
    """
    head = typed_head(typed)
    ledger = read_ledger(folder)
    entry = next((e for e in ledger.entries if head_of(e.sha256) == head), None)
    if entry is None or entry.kind != CLOSING:
        return head, ["no closing of the ledger has this seal"], ""
    found = [*ledger.faults, *changes(folder, entry)]
    session = str(entry.data.get("session", ""))
    what = f"session {session}" if session else "the project"
    return head, found, f"{what} as closed at {entry.at}"


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
