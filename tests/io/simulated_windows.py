"""Runs a command as on a system without what POSIX alone has: ``python simulated_windows.py ...``.

Away are the flags and calls that Windows lacks; folders cannot be opened for syncing; a file that
is replaced is held by another program at first; what this program itself holds open can be neither
replaced nor taken away; the console has the code page of PYTHONIOENCODING.
``--steps FILE.json`` runs many commands in one process, each a list of words, and prints one JSON
object a line for each: its exit code and what it wrote.
It is a simulation on another system, no test on Windows.
"""

from __future__ import annotations

import contextlib
import errno
import io
import json
import multiprocessing
import os
import shutil
import signal
import sys
from pathlib import Path
from typing import Any

AWAY = (
    "O_NOFOLLOW", "O_CLOEXEC", "O_NONBLOCK", "O_NOCTTY", "O_DIRECTORY", "O_SYNC", "fork", "mkfifo",
    "getuid", "geteuid", "fchmod", "fchown", "chown", "statvfs", "wait4", "posix_spawn", "pread",
    "setsid", "killpg", "getpgid", "mknod", "getpgrp", "sync", "fdatasync",
    "lockf", "sched_getaffinity", "get_blocking", "set_blocking", "nice", "wait3", "openpty",
)  # fmt: skip
SIGNALS = ("SIGHUP", "SIGQUIT", "SIGKILL", "SIGALRM", "SIGUSR1", "SIGWINCH", "SIGCHLD", "SIGPIPE")


def simulate(*, denials: int) -> list[str]:
    """Take away what Windows lacks, and make it refuse what it refuses.

    Other packages bring their own code for Windows: what this system's code of them needs is bound
    before, and the lock is one that needs no system call of its own.

    Parameters
    ----------
    denials : int
        How often another program holds what is replaced, each time.

    Returns
    -------
    list of str
        Fills with the paths that were held.
    """
    import filelock
    import platformdirs.unix  # noqa: F401
    import reportlab.lib.utils  # noqa: F401

    filelock.FileLock = filelock.SoftFileLock
    multiprocessing.set_start_method("spawn")
    for name in AWAY:
        if hasattr(os, name):
            delattr(os, name)
    for name in SIGNALS:
        if hasattr(signal, name):
            delattr(signal, name)
    os.O_BINARY = 0  # type: ignore[attr-defined]
    shutil._use_fd_functions = False  # type: ignore[attr-defined]
    return _refuse_what_is_held(denials)


def _refuse_what_is_held(denials: int) -> list[str]:
    """Files and folders in use: opened, replaced, renamed and taken away as Windows does."""
    real_open, real_replace, real_unlink = os.open, os.replace, os.unlink
    held: dict[str, int] = {}
    told: list[str] = []

    def open_file(path: Any, flags: int, *rest: Any, **named: Any) -> int:
        if Path(os.fsdecode(path)).is_dir():
            raise PermissionError(errno.EACCES, "Permission denied", os.fsdecode(path))
        return real_open(path, flags, *rest, **named)

    def replace(source: Any, target: Any, **_: Any) -> None:
        if is_open(source) or is_open(target) or Path(os.fsdecode(target)).is_dir():
            raise PermissionError(errno.EACCES, "this program holds it", str(target))
        tries = held[str(target)] = held.get(str(target), 0) + 1
        if tries <= denials:  # a virus scanner or a sync service looks at it
            told.append(str(target))
            raise PermissionError(errno.EACCES, "held by another program", str(target))
        held[str(target)] = 0
        real_replace(source, target)

    def rename(source: Any, target: Any, **_: Any) -> None:
        if os.path.lexists(target):
            raise FileExistsError(errno.EEXIST, "File exists", str(target))
        replace(source, target)

    def unlink(path: Any, **_: Any) -> None:
        if is_open(path):
            raise PermissionError(errno.EACCES, "this program holds it", str(path))
        real_unlink(path)

    os.open, os.replace, os.rename = open_file, replace, rename  # type: ignore[assignment]
    os.unlink = os.remove = unlink
    return told


def is_open(path: Any) -> bool:
    """Whether this process holds a file, or anything below a folder, open."""
    real, handles = os.path.realpath(os.fsdecode(path)), Path("/proc/self/fd")
    for link in handles.iterdir() if handles.is_dir() else ():
        try:
            opened = str(link.readlink())
        except OSError:
            continue
        if opened == real or opened.startswith(real + os.sep):
            return True
    return False


def run_steps(file: str) -> None:
    """Run every command of a file; what one prints is told after it."""
    from surveyapp.cli.main import main

    sys.stdout.reconfigure(line_buffering=True)  # type: ignore[union-attr]
    for words in json.loads(Path(file).read_text("utf-8")):
        # the code page of the console, as sys.stdout has it
        raw = [io.BytesIO(), io.BytesIO()]
        console = [
            io.TextIOWrapper(r, encoding=sys.stdout.encoding, errors="backslashreplace")
            for r in raw
        ]
        with contextlib.redirect_stdout(console[0]), contextlib.redirect_stderr(console[1]):
            try:
                code: Any = main(words)
            except SystemExit as end:
                code = end.code
            except BaseException as fault:  # what a command lets through is what is looked for
                code = repr(fault)
        for stream in console:
            stream.flush()
        texts = [r.getvalue().decode(sys.stdout.encoding) for r in raw]
        print(json.dumps({"words": words, "code": code, "out": texts[0], "err": texts[1]}))


if __name__ == "__main__":
    if sys.argv[1:2] == ["--steps"]:
        held_paths = simulate(denials=1)
        run_steps(sys.argv[2])
        print(json.dumps({"held": held_paths}))
    else:
        simulate(denials=2)
        from surveyapp.__main__ import run

        sys.argv[0] = "surveyapp"
        run()
