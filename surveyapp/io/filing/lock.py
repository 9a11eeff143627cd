"""One writer to a project folder: a lock file beside project.toml, never a lock on a book.

Whoever comes second, and whoever stands before a read-only folder, reads. Nothing waits.
"""

from __future__ import annotations

import os
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Final

from surveyapp.errors import SurveyError
from surveyapp.io.filing.journal import settle
from surveyapp.io.guarded import is_regular

if TYPE_CHECKING:
    from filelock import BaseFileLock

LOCK_FILE: Final = ".surveyapp.lock"


class ProjectLock:
    """The right to write to a project folder, where it is to be had.

    Use it as a context manager, or call ``release`` when done.

    Parameters
    ----------
    folder : Path
        The project folder.
    even_closed : bool
        For closing and reopening: a closed project is read-only for everybody else.

    Attributes
    ----------
    writable : bool
        Whether this handle may write. False for the second opener, in a read-only folder and in
        a closed project.
    closed : bool
        Whether the project is closed.
    """

    __slots__ = ("_lock", "closed", "folder", "writable")

    def __init__(self, folder: Path, *, even_closed: bool = False) -> None:
        from surveyapp.io.filing.seals import is_closed

        self.folder = folder
        self.writable = False
        self.closed = is_closed(folder)
        self._lock: BaseFileLock | None = None
        if even_closed or not self.closed:
            self._acquire()

    def _acquire(self) -> None:
        path = self.folder / LOCK_FILE
        if not self.folder.is_dir() or (os.path.lexists(path) and not is_regular(path)):
            return
        import filelock

        lock = filelock.FileLock(str(self.folder / LOCK_FILE), timeout=0)
        try:
            lock.acquire()
        except (filelock.Timeout, OSError, ValueError, NotImplementedError):
            return
        self._lock = lock
        try:
            settle(self.folder)
        except (SurveyError, OSError):  # a disk that refuses: who only reads sees the old state
            self.release()
            return
        self.writable = True

    def release(self) -> None:
        """Give the right to write back; a second call does nothing."""
        if self._lock is not None:
            self._lock.release()
        self._lock = None
        self.writable = False

    def __enter__(self) -> ProjectLock:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.release()
