"""The ledger of a project: every diagnosis, adoption, closing and reopening, appended for ever.

One line an entry, canonical JSON, each with the hash of the one before it and its own: a changed
byte anywhere is found. A line without its newline was never finished: it does not count, and the
next writer moves it aside. Nothing here decides what an entry means.
"""

from __future__ import annotations

import errno
import hashlib
import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from surveyapp.errors import Problem, SurveyError
from surveyapp.io.fieldbook.reading import move_tail_aside
from surveyapp.io.files import shown
from surveyapp.io.guarded import open_regular
from surveyapp.io.tomltext import sync_folder
from surveyapp.languages import said

LEDGER_FILE: Final = "ledger.jsonl"
MAX_LEDGER_BYTES: Final = 64 * 1024 * 1024
_KEYS: Final = frozenset({"at", "data", "kind", "previous", "seq", "sha256", "software"})


@dataclass(frozen=True, slots=True)
class LedgerEntry:
    """One entry.

    Parameters
    ----------
    seq : int
        From 1.
    kind : str
        diagnosis | adoption | closing | reopening.
    at : str
        ISO 8601 with UTC offset.
    software : str
    data : mapping
        What the kind says.
    previous : str
        sha256 of the entry before it, empty for the first.
    sha256 : str
        Of this entry without this key.
    """

    seq: int
    kind: str
    at: str
    software: str
    data: Mapping[str, Any]
    previous: str
    sha256: str


@dataclass(frozen=True, slots=True)
class Ledger:
    """A ledger as read.

    Parameters
    ----------
    entries : tuple of LedgerEntry
        Those that are whole.
    faults : tuple of str
        What is wrong: a line that is no entry, a broken chain.
    tail : bytes
        What stands behind the last newline.
    tail_altered : bool
        Whether that is a whole entry whose newline was changed, and not an unfinished line.
    last_hash : str
        What the next entry names as the previous one.
    """

    entries: tuple[LedgerEntry, ...] = ()
    faults: tuple[str, ...] = ()
    tail: bytes = b""
    tail_altered: bool = False
    last_hash: str = ""


def canonical(value: Mapping[str, Any]) -> str:
    """The one text of a JSON object: sorted keys, no spaces, no NaN."""
    return json.dumps(
        value, ensure_ascii=False, sort_keys=True, separators=(",", ":"), allow_nan=False
    )


def digest_of(value: Mapping[str, Any]) -> str:
    """sha256 of the canonical text of a JSON object."""
    return hashlib.sha256(canonical(value).encode("utf-8")).hexdigest()


def _parse(line: bytes) -> LedgerEntry | None:
    """Entry of a line, None where a single byte of it is not as it was written."""
    try:
        text = line.decode("utf-8")
        value = json.loads(text)
        if not isinstance(value, dict) or set(value) != _KEYS or canonical(value) != text:
            return None
        own = value.pop("sha256")
        texts = ("at", "kind", "previous", "software")
        if own != digest_of(value) or not isinstance(value["data"], dict):
            return None
        if any(not isinstance(value[key], str) for key in texts) or type(value["seq"]) is not int:
            return None
        return LedgerEntry(sha256=own, **value)
    except (ValueError, TypeError, RecursionError):
        return None


def read_ledger(folder: Path) -> Ledger:
    """Read the ledger of a project folder; an absent one is empty.

    Raises
    ------
    SurveyError
        If the file cannot be read at all. A damaged one is read as far as it is whole.
    """
    path = folder / LEDGER_FILE
    try:
        data = _ledger_bytes(path)
    except OSError as error:
        raise SurveyError(
            Problem(
                said("the ledger cannot be read ({strerror})", strerror=error.strerror or error),
                LEDGER_FILE,
            )
        ) from None
    return parse_ledger(data)


def _ledger_bytes(path: Path) -> bytes:
    """The whole ledger, empty where there is none."""
    try:
        handle = open_regular(path, os.O_RDONLY)
    except FileNotFoundError:
        return b""
    with os.fdopen(handle, "rb") as stream:
        data = stream.read(MAX_LEDGER_BYTES + 1)
    if len(data) > MAX_LEDGER_BYTES:
        raise OSError(errno.EFBIG, f"it is larger than {MAX_LEDGER_BYTES // 1024**2} MB")
    return data


def parse_ledger(data: bytes) -> Ledger:
    """Entries of a ledger's bytes, with everything that is not as it was written."""
    lines = data.split(b"\n")
    tail = lines.pop()
    entries: list[LedgerEntry] = []
    faults: list[str] = []
    previous = ""
    for number, line in enumerate(lines, start=1):
        entry = _parse(line)
        if entry is None:
            faults.append(f"line {number} is not as it was written")
            previous = hashlib.sha256(line).hexdigest()
            continue
        if entry.previous != previous or entry.seq != number:
            faults.append(f"line {number} does not follow the line before it")
        entries.append(entry)
        previous = entry.sha256
    altered = len(tail) > 1 and _parse(tail[:-1]) is not None
    return Ledger(tuple(entries), tuple(faults), tail, altered, previous)


def append_entry(
    folder: Path, kind: str, data: Mapping[str, Any], *, at: str, software: str
) -> LedgerEntry:
    """Append one entry; it is on disk when this returns, and not at all if it does not.

    The caller holds the project's lock.

    Parameters
    ----------
    folder : Path
    kind : str
    data : mapping
        Plain JSON values, no NaN.
    at : str
        ISO 8601 with UTC offset.
    software : str

    Raises
    ------
    SurveyError
        If the ledger cannot be written; it stands as before.
    """
    return append_entries(folder, [(kind, data)], at=at, software=software)[0]


def append_entries(
    folder: Path, entries: Sequence[tuple[str, Mapping[str, Any]]], *, at: str, software: str
) -> tuple[LedgerEntry, ...]:
    """Append several entries (kind, data), all of them or none; as ``append_entry``."""
    path = folder / LEDGER_FILE
    ledger = read_ledger(folder)
    made: list[LedgerEntry] = []
    lines = ""
    try:
        if ledger.tail:
            move_tail_aside(path, size=path.stat().st_size, tail=ledger.tail)
        count = _lines(path)
        for number, (kind, data) in enumerate(entries, start=count + 1):
            body: dict[str, Any] = {
                "at": at,
                "data": json.loads(canonical(data)),
                "kind": kind,
                "previous": made[-1].sha256 if made else ledger.last_hash,
                "seq": number,
                "software": software,
            }
            made.append(LedgerEntry(sha256=digest_of(body), **body))
            lines += canonical({**body, "sha256": made[-1].sha256}) + "\n"
        _append(path, lines.encode("utf-8"))
    except OSError as error:
        raise SurveyError(
            Problem(
                said(
                    "the ledger could not be written ({strerror})", strerror=error.strerror or error
                ),
                shown(str(path)),
                "",
                "a folder with room that may be written to",
                "the ledger stands as before",
            )
        ) from None
    return tuple(made)


def _lines(path: Path) -> int:
    return _ledger_bytes(path).count(b"\n")


def _append(path: Path, data: bytes) -> None:
    """Append in one write and fsync; what could not be written in whole is cut off again."""
    new = not path.exists()
    handle = open_regular(path, os.O_WRONLY | os.O_APPEND | os.O_CREAT)
    try:
        size = os.fstat(handle).st_size
        try:
            written = os.write(handle, data)
            if written != len(data):
                raise OSError(errno.ENOSPC, f"{written} of {len(data)} bytes")
            os.fsync(handle)
        except OSError:
            os.ftruncate(handle, size)
            if new:
                path.unlink(missing_ok=True)
            raise
    finally:
        os.close(handle)
    if new:
        sync_folder(path.parent)
