"""Runs a command as on a system without what POSIX alone has: ``python simulated_windows.py ...``.

Away are the flags and calls that Windows lacks; folders cannot be opened for syncing; a file that
is replaced is held by another program at first; the console has the code page of PYTHONIOENCODING.
It is a simulation on another system, no test on Windows.
"""

from __future__ import annotations

import errno
import os
import signal
import sys
from pathlib import Path
from typing import Any

AWAY = (
    "O_NOFOLLOW", "O_CLOEXEC", "O_NONBLOCK", "O_NOCTTY", "O_DIRECTORY", "O_SYNC", "fork", "mkfifo",
    "getuid", "geteuid", "fchmod", "fchown", "chown", "statvfs", "wait4", "posix_spawn", "pread",
    "setsid", "killpg", "getpgid", "mknod",
)  # fmt: skip
SIGNALS = ("SIGHUP", "SIGQUIT", "SIGKILL", "SIGALRM", "SIGUSR1", "SIGWINCH", "SIGCHLD", "SIGPIPE")


def simulate() -> None:
    """Take away what Windows lacks, and make it refuse what it refuses.

    Other packages bring their own code for Windows: what this system's code of them needs is bound
    before, and the lock is one that needs no system call of its own.
    """
    import filelock
    import platformdirs.unix  # noqa: F401
    import reportlab.lib.utils  # noqa: F401

    filelock.FileLock = filelock.SoftFileLock
    for name in AWAY:
        if hasattr(os, name):
            delattr(os, name)
    for name in SIGNALS:
        if hasattr(signal, name):
            delattr(signal, name)
    os.O_BINARY = 0  # type: ignore[attr-defined]
    real_open, real_replace = os.open, Path.replace
    held: dict[str, int] = {}

    def open_file(path: Any, flags: int, *rest: Any, **named: Any) -> int:
        if Path(os.fsdecode(path)).is_dir():
            raise PermissionError(errno.EACCES, "Permission denied", os.fsdecode(path))
        return real_open(path, flags, *rest, **named)

    def replace(self: Path, target: Any) -> Path:
        tries = held[str(target)] = held.get(str(target), 0) + 1
        if tries <= 2:  # a virus scanner or a sync service looks at it
            raise PermissionError(errno.EACCES, "held by another program", str(target))
        return real_replace(self, target)

    os.open = open_file
    Path.replace = replace  # type: ignore[assignment,method-assign]


if __name__ == "__main__":
    simulate()
    from surveyapp.__main__ import run

    sys.argv[0] = "surveyapp"
    run()
