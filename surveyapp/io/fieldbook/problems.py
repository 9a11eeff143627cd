"""Why a reading cannot be written down now, in words."""

from __future__ import annotations

from pathlib import Path

from surveyapp.errors import Problem


def edited_problem(path: Path) -> Problem:
    """Another hand wrote in the book while it was open here."""
    return Problem(
        "the book was changed by another hand meanwhile",
        path.name,
        "",
        "the book as it was left here",
        "It is read again and shown: look, then press the key once more.",
    )


def read_only_problem(folder: Path, *, closed: bool) -> Problem:
    """Nothing may be written: the session is closed, or the folder cannot be written to now."""
    if closed:
        return Problem(
            "this session is closed and signed",
            folder.name,
            "a closing in the ledger",
            "an open session",
            "surveyapp reopen opens it again and keeps the reason.",
        )
    return Problem(
        "this project cannot be written to now",
        folder.name,
        "it is open in another program, or the folder is read-only",
        "the only program that has the project open",
        "Close the other one and open the session again; it is shown for reading until then.",
    )
