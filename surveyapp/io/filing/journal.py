"""Project file and ledger change together or not at all, whenever the program or the power ends.

A small journal is written first, then the ledger is appended to, then project.toml is replaced,
then the journal is taken away. Whoever takes the lock next and finds a journal finishes the work:
with the new project.toml all stands written; with the old one the ledger is cut back to where it
was. Cutting needs no room, so that a full disk is no obstacle. The caller holds the project's lock.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

from surveyapp.errors import SurveyError
from surveyapp.io.files import read_inside
from surveyapp.io.filing.ledger import LEDGER_FILE
from surveyapp.io.guarded import is_regular, open_regular
from surveyapp.io.tomltext import atomic_write, sync_folder

JOURNAL_FILE: Final = ".surveyapp.journal"
PROJECT_FILE: Final = "project.toml"
_LEFTOVER: Final = re.compile(r"\.(project\.toml|ledger\.jsonl|\.surveyapp\.journal)\.\w+\.tmp")
_BOOK_LEFTOVER: Final = re.compile(r"\..+\.csv\.\w+\.tmp")


def write_together(folder: Path, after: bytes, append: Callable[[], object]) -> None:
    """Append to the ledger and replace project.toml: both, or neither.

    Parameters
    ----------
    folder : Path
    after : bytes
        The new project.toml.
    append : callable
        Appends to the ledger; it leaves it as it was where it raises.

    Raises
    ------
    SurveyError
        If the system refuses; both files stand as before.
    """
    before = read_inside(folder, PROJECT_FILE, where=PROJECT_FILE)
    ledger = _ledger(folder)
    whole = ledger[: ledger.rfind(b"\n") + 1]
    journal = {
        "before": _digest(before),
        "after": _digest(after),
        "ledger_bytes": len(whole),
        "ledger_sha256": _digest(whole),
    }
    atomic_write(folder / JOURNAL_FILE, (json.dumps(journal) + "\n").encode("utf-8"))
    try:
        append()
        atomic_write(folder / PROJECT_FILE, after)
    except SurveyError:
        settle(folder)
        raise
    _take_away(folder)


def unsettled(folder: Path) -> bool:
    """Whether an interrupted program has left a journal or temporary files."""
    names = _names(folder)
    if any(name == JOURNAL_FILE or _LEFTOVER.fullmatch(name) for name in names):
        return True
    return any(_BOOK_LEFTOVER.fullmatch(name) for name in _names(folder / "observations"))


def _names(folder: Path) -> list[str]:
    if folder.is_symlink():  # it may lead out of the project
        return []
    try:
        return [item.name for item in folder.iterdir()]
    except (OSError, ValueError):  # a path with a null character is no folder
        return []


def settle(folder: Path) -> None:
    """Finish what an interrupted program has left, and take its temporary files away."""
    path = folder / JOURNAL_FILE
    if is_regular(path):
        journal = _read(folder)
        try:
            now = _digest(read_inside(folder, PROJECT_FILE, where=PROJECT_FILE))
        except SurveyError:
            return
        if journal is not None and now == journal["before"]:
            _cut_ledger(folder, journal)
        _take_away(folder)
    for place, pattern in ((folder, _LEFTOVER), (folder / "observations", _BOOK_LEFTOVER)):
        if place.is_symlink():
            continue
        with contextlib.suppress(OSError):
            for item in place.iterdir():
                if pattern.fullmatch(item.name) and is_regular(item):
                    item.unlink()


def _read(folder: Path) -> dict[str, Any] | None:
    keys = {"before": str, "after": str, "ledger_bytes": int, "ledger_sha256": str}
    try:
        value = json.loads(read_inside(folder, JOURNAL_FILE, where=JOURNAL_FILE))
    except (SurveyError, ValueError, RecursionError):
        return None
    if not isinstance(value, dict) or set(value) != set(keys):
        return None
    return value if all(type(value[name]) is kind for name, kind in keys.items()) else None


def _cut_ledger(folder: Path, journal: dict[str, Any]) -> None:
    """Cut the ledger back to what stood in it, if it begins with that."""
    ledger, size = _ledger(folder), journal["ledger_bytes"]
    if not 0 <= size < len(ledger) or _digest(ledger[:size]) != journal["ledger_sha256"]:
        return
    path = folder / LEDGER_FILE
    if not size:
        path.unlink(missing_ok=True)
        return
    handle = open_regular(path, os.O_RDWR)
    try:
        os.ftruncate(handle, size)
        with contextlib.suppress(OSError):  # a disk that refuses even this has cut it all the same
            os.fsync(handle)
    finally:
        os.close(handle)


def _ledger(folder: Path) -> bytes:
    if not os.path.lexists(folder / LEDGER_FILE):
        return b""
    return read_inside(folder, LEDGER_FILE, where=LEDGER_FILE)


def _take_away(folder: Path) -> None:
    (folder / JOURNAL_FILE).unlink(missing_ok=True)
    sync_folder(folder)


def _digest(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()
