"""Closing and reopening for scripts, and the key that signs, re-exported by ``surveyapp.api``."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING

from surveyapp.api.project import SOFTWARE, Folder
from surveyapp.errors import Problem, SurveyError

if TYPE_CHECKING:
    from surveyapp.domain.filing import ClosingResult
    from surveyapp.io.minisign import SecretKey


def _local_now() -> datetime:
    return datetime.now().astimezone()


def no_password() -> str:
    """Where nobody can be asked: an encrypted key cannot be used.

    Raises
    ------
    SurveyError
        Always.
    """
    raise SurveyError(
        Problem("this key is encrypted and nobody can be asked for its password", "key")
    )


def close(
    folder: Folder,
    *,
    session: str | None = None,
    by: str = "",
    note: str = "",
    key: Folder | None = None,
    password: Callable[[], str] = no_password,
    now: Callable[[], datetime] = _local_now,
) -> ClosingResult:
    """Close a project, or one session of it: files and ledger are sealed by a hash chain.

    Parameters
    ----------
    folder : path
    session : str or None
        One session alone; None: the whole project.
    by, note : str
        Who closes it, and a sentence for the ledger.
    key : path or None
        Secret key in the format of minisign, with which the closing is signed.
    password : callable
        Asked for the password of an encrypted key.
    now : callable
        The clock.

    Raises
    ------
    SurveyError
        If it cannot be read, is closed already, is open elsewhere, or cannot be written, or if the
        key cannot be used: nothing is closed then.
    """
    from surveyapp.io.filing.closing import close_project

    secret = None if key is None else secret_of(key, password)
    at = now().isoformat(timespec="seconds")
    made = close_project(Path(folder), session=session, by=by, note=note, at=at, software=SOFTWARE)
    if secret is None:
        return made
    from surveyapp.io.filing.signatures import sign_closing

    return replace(made, signature=sign_closing(Path(folder), made.entry, secret))


def secret_of(key: Folder, password: Callable[[], str]) -> SecretKey:
    """The secret key of a file.

    Raises
    ------
    SurveyError
        If it cannot be used.
    """
    from surveyapp.io.minisign import read_secret_key

    return read_secret_key(Path(key), password)


def reopen(
    folder: Folder,
    *,
    reason: str,
    session: str | None = None,
    by: str = "",
    now: Callable[[], datetime] = _local_now,
) -> ClosingResult:
    """Reopen a closed project or session; reason and what was changed go into the ledger.

    Raises
    ------
    SurveyError
        If it is not closed, or no reason is given.
    """
    from surveyapp.io.filing.closing import reopen_project

    at = now().isoformat(timespec="seconds")
    return reopen_project(
        Path(folder), session=session, by=by, reason=reason, at=at, software=SOFTWARE
    )
