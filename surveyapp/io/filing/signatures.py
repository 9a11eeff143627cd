"""Who closed it: a statement of each closing, signed with a key in the format of minisign.

``signatures/HEAD.txt`` says what was closed, when and by whom, with the sha256 of the closing's
entry in the ledger; ``HEAD.txt.minisig`` beside it is its signature, which the program minisign
checks as well. The entry holds the hashes of what was closed, so that the signature covers them.
"""

from __future__ import annotations

from pathlib import Path
from typing import Final

from surveyapp.errors import Problem, SurveyError
from surveyapp.io.files import decode, read_inside, shown_path, visible
from surveyapp.io.filing.ledger import LedgerEntry, read_ledger
from surveyapp.io.filing.seals import CLOSING, closings_in_force
from surveyapp.io.filing.witness import head_of
from surveyapp.io.guarded import checked_inside
from surveyapp.io.minisign import SUFFIX, PublicKey, SecretKey, signature_text, verified
from surveyapp.io.tomltext import atomic_write
from surveyapp.languages import said

SIGNATURES: Final = "signatures"


def _name(head: str) -> str:
    return f"{SIGNATURES}/{head}.txt"


def statement(entry: LedgerEntry) -> str:
    """What is signed of a closing: some lines that a person can read."""
    session = str(entry.data.get("session", ""))
    what = f"session {session}" if session else "the project"
    by = " ".join(visible(str(entry.data.get("by", ""))).split()) or "-"
    return (
        f"closing of {visible(what)}\nby {by}\nat {entry.at}\nsoftware {entry.software}\n"
        f"seal {head_of(entry.sha256)}\nsha256 of the entry in ledger.jsonl {entry.sha256}\n"
    )


def sign_closing(folder: Path, seq: int, secret: SecretKey) -> str:
    """Write statement and signature of a closing, and return the name of the signature.

    Raises
    ------
    SurveyError
        If they cannot be written; the closing stands all the same.
    """
    entry = next(e for e in read_ledger(folder).entries if e.seq == seq)
    name = _name(head_of(entry.sha256))
    checked_inside(folder, name, where=SIGNATURES)
    data = statement(entry).encode("utf-8")
    text = signature_text(data, secret, comment=f"surveyapp closing {head_of(entry.sha256)}")
    try:
        (folder / SIGNATURES).mkdir(exist_ok=True)
    except OSError as error:
        what = said(
            "the signature cannot be written ({strerror})", strerror=error.strerror or error
        )
        raise SurveyError(Problem(what, SIGNATURES, "", "", "the closing stands")) from None
    atomic_write(folder / name, data)
    atomic_write(folder / f"{name}{SUFFIX}", text.encode("utf-8"))
    return f"{name}{SUFFIX}"


def closing_faults(folder: Path, public: PublicKey) -> dict[str, list[str]]:
    """Why a closing in force is not signed by a key, by the session (empty: the project)."""
    return {
        name: _faults(folder, entry, public)
        for name, entry in closings_in_force(read_ledger(folder)).items()
        if entry.kind == CLOSING
    }


def _faults(folder: Path, entry: LedgerEntry, public: PublicKey) -> list[str]:
    name = _name(head_of(entry.sha256))
    try:
        data = read_inside(folder, name, where=name)
        text = decode(read_inside(folder, f"{name}{SUFFIX}", where=name), where=name)
    except SurveyError:
        return ["this closing is not signed with a key"]
    if data != statement(entry).encode("utf-8"):
        return [f"{name} is not about the closing in the ledger"]
    fault = verified(data, text, public)
    return [fault] if fault else []


def sign_file(path: Path, data: bytes, secret: SecretKey) -> str:
    """Write the signature of a file beside it, and return its path."""
    target = path.with_name(path.name + SUFFIX)
    text = signature_text(data, secret, comment=f"file:{path.name} hashed")
    atomic_write(target, text.encode("utf-8"))
    return str(target)


def file_faults(path: Path, public: PublicKey) -> list[str]:
    """Why a file is not signed by a key; empty where it is.

    Raises
    ------
    SurveyError
        If the file cannot be read.
    """
    from surveyapp.io.files import read_bytes

    data = read_bytes(path, where=shown_path(path))
    try:
        text = read_bytes(path.with_name(path.name + SUFFIX), where=shown_path(path))
    except SurveyError:
        return [f"there is no {path.name}{SUFFIX} beside it"]
    fault = verified(data, text.decode("utf-8", "replace"), public)
    return [fault] if fault else []
