"""A command that is killed in a forked process at a chosen moment: at a line, or inside a write."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path
from types import FrameType
from typing import Any

WATCHED = ("/surveyapp/io/", "/surveyapp/workflows/adopting")


def run_killed(
    act: Callable[[], object],
    at: int,
    *,
    half_write: bool = False,
    watched: tuple[str, ...] = WATCHED,
) -> int:
    """Run an act in a fork and kill it at the line number ``at`` of what is watched.

    Returns
    -------
    int
        Lines that were passed if the act came to its end, else -1.
    """
    read_end, write_end = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(read_end)
        _child(act, at, write_end, half_write=half_write, watched=watched)
    os.close(write_end)
    with os.fdopen(read_end) as stream:
        said = stream.read()
    os.waitpid(child, 0)
    return int(said) if said else -1


def _child(
    act: Callable[[], object], at: int, out: int, *, half_write: bool, watched: tuple[str, ...]
) -> None:
    count = 0
    real_write = os.write

    def write(handle: int, data: Any) -> int:
        if half_write and count >= at:
            real_write(handle, data[: len(data) // 2])
            os._exit(9)
        return real_write(handle, data)

    def line(frame: FrameType, event: str, _: Any) -> Any:
        nonlocal count
        if event == "line":
            count += 1
            if count >= at and not half_write:
                os._exit(9)
        return line

    def call(frame: FrameType, event: str, _: Any) -> Any:
        name = frame.f_code.co_filename
        return line if any(part in name for part in watched) else None

    os.write = write
    sys.settrace(call)
    code = 0
    try:
        act()
    except BaseException:
        code = 1
    sys.settrace(None)
    if code == 0:
        real_write(out, str(count).encode())
    os._exit(code)


def state_of(folder: Path) -> dict[str, bytes]:
    """Every file of a folder but the lock."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.name != ".surveyapp.lock"
    }
