"""The head of the ledger's chain, short enough to be typed, and a list of closings beside it.

Twenty characters (100 bits of the sha256 of the closing's entry, Crockford's base 32) stand on the
signed record: who has the paper finds every later change of ledger or files with
``check --seal HEAD``. ``closings.txt`` holds the same heads in the folder, so that a ledger that
was cut or deleted is missed; who changes both is found by the paper alone.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Final

from surveyapp.errors import Problem, SurveyError
from surveyapp.io.files import decode, read_inside, shown, visible
from surveyapp.io.filing.ledger import Ledger, LedgerEntry
from surveyapp.io.filing.sealed_files import WITNESS_FILE
from surveyapp.io.guarded import open_regular

_LETTERS: Final = "0123456789ABCDEFGHJKMNPQRSTVWXYZ"
_LENGTH: Final = 20
_HEADING: Final = (
    "# Closings and reopenings of this project, one a line, as they stand in ledger.jsonl.\n"
    "# surveyapp check compares them; the head on the signed record is the proof.\n"
)


def head_of(sha256: str) -> str:
    """Twenty characters in groups of five from a sha256 in hexadecimal digits."""
    number = int(sha256, 16) >> (256 - 5 * _LENGTH)
    letters = [_LETTERS[(number >> (5 * k)) & 31] for k in reversed(range(_LENGTH))]
    return "-".join("".join(letters[k : k + 5]) for k in range(0, _LENGTH, 5))


def typed_head(text: str) -> str:
    """A head as it was typed: case, blanks and dashes do not matter, O is 0, I and L are 1.

    Raises
    ------
    SurveyError
        If it is none.
    """
    plain = "".join(c for c in text.upper() if c not in "- \t").translate(
        str.maketrans("OIL", "011")
    )
    if len(plain) != _LENGTH or any(c not in _LETTERS for c in plain):
        raise SurveyError(
            Problem(
                "this is no seal",
                "seal",
                shown(text),
                "20 letters and digits, as the signed record prints them",
                "groups and case do not matter",
            )
        )
    return "-".join(plain[k : k + 5] for k in range(0, _LENGTH, 5))


def add_witness(folder: Path, entry: LedgerEntry) -> None:
    """Write one line for a closing or reopening; a folder that refuses keeps the ledger alone."""
    session = str(entry.data.get("session", ""))
    what = f"session {session}" if session else "project"
    line = visible(f"{head_of(entry.sha256)}  {entry.at}  {entry.kind}  {what}").replace("\n", " ")
    path = folder / WITNESS_FILE
    try:
        handle = open_regular(path, os.O_RDWR | os.O_APPEND | os.O_CREAT)
    except OSError:
        return
    try:
        size = _whole_lines(handle)
        os.ftruncate(handle, size)  # what was torn off is no line, and none is joined to it
        data = f"{'' if size else _HEADING}{line}\n".encode()
        if os.write(handle, data) != len(data):
            os.ftruncate(handle, size)
        os.fsync(handle)
    except OSError:
        return
    finally:
        os.close(handle)


def _whole_lines(handle: int) -> int:
    """Bytes of an open file up to its last newline."""
    data = b""
    while part := os.read(handle, 1 << 20):
        data += part
    return data.rfind(b"\n") + 1


def witnessed(folder: Path) -> tuple[str, ...]:
    """Heads that stand in the list of closings; empty where there is none."""
    if not os.path.lexists(folder / WITNESS_FILE):
        return ()
    data = read_inside(folder, WITNESS_FILE, where=WITNESS_FILE)
    lines = decode(data.rpartition(b"\n")[0], where=WITNESS_FILE).splitlines()
    return tuple(line.split()[0] for line in lines if line.strip() and not line.startswith("#"))


def missing_entries(folder: Path, ledger: Ledger) -> list[str]:
    """Closings of the list that the ledger does not hold, in words."""
    try:
        heads = witnessed(folder)
    except SurveyError as error:
        return [f"{WITNESS_FILE}: {error.problems[0].what}"]
    known = {head_of(entry.sha256) for entry in ledger.entries}
    return [
        f"the entry {head} of {WITNESS_FILE} is not in the ledger"
        for head in heads
        if head not in known
    ]
