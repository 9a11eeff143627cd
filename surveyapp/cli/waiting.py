"""A progress bar for commands that may last: on standard error, only on a terminal.

It appears after a second, says what is done and for how long, and is gone before the result is
printed. Nothing is written where standard error is no terminal.
"""

from __future__ import annotations

import io
import sys
import threading
import time
from types import TracebackType
from typing import Final, TextIO, cast

PATIENCE_S: Final = 1.0
"""Nothing is shown of what takes no longer."""
BEAT_S: Final = 0.2
BAR: Final = 24


class Waiting:
    """A bar while a command runs; a context manager.

    Parameters
    ----------
    name : str
        The command.
    stream : TextIO or None
        Standard error; nothing is shown unless it is a terminal.
    """

    def __init__(self, name: str, stream: TextIO | None) -> None:
        self.name = name
        self.shown = stream is not None and stream.isatty()
        self._stream = stream
        self._state = ("", 0, 0)
        self._begin = time.monotonic()
        self._over = threading.Event()
        self._lock = threading.Lock()
        self._drawn = 0
        self._output = sys.stdout

    def advance(self, what: str, done: int, total: int) -> None:
        """How far it is; drawn at the next beat."""
        self._state = (what, done, total)

    def __enter__(self) -> Waiting:
        if self.shown:
            self._output = sys.stdout
            sys.stdout = cast("TextIO", _Clearing(self._output, self))
            threading.Thread(target=self._beat, daemon=True).start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self.shown:
            self.clear()
            sys.stdout = self._output

    def clear(self) -> None:
        """Take the bar away for good: something is about to be printed."""
        self._over.set()
        with self._lock:
            self._write("")

    def _beat(self) -> None:
        while not self._over.wait(BEAT_S):
            with self._lock:
                if not self._over.is_set() and time.monotonic() - self._begin >= PATIENCE_S:
                    self._write(self.text(time.monotonic() - self._begin))

    def text(self, elapsed_s: float) -> str:
        """What is shown after so many seconds."""
        what, done, total = self._state
        parts = [self.name]
        if total > 0:
            full = min(BAR, BAR * done // total)
            parts.append(f"[{'#' * full}{'.' * (BAR - full)}] {what} {done} of {total}")
        elif what:
            parts.append(f"{what} {done}" if done else what)
        return "  ".join([*parts, f"{elapsed_s:.0f} s"])

    def _write(self, text: str) -> None:
        if self._stream is not None and (text or self._drawn):
            self._stream.write("\r" + text + " " * max(0, self._drawn - len(text)))
            self._stream.write("" if text else "\r")
            self._stream.flush()
            self._drawn = len(text)


class _Clearing(io.TextIOBase):
    """Standard output that takes the bar away before the first word."""

    def __init__(self, output: TextIO, waiting: Waiting) -> None:
        super().__init__()
        self._output, self._waiting = output, waiting

    def write(self, text: str) -> int:
        """Clear, then write."""
        self._waiting.clear()
        return self._output.write(text)

    def flush(self) -> None:
        """Flush what is behind."""
        self._output.flush()

    def fileno(self) -> int:
        """File behind."""
        return self._output.fileno()

    def isatty(self) -> bool:
        """Whether a terminal is behind."""
        return self._output.isatty()

    @property
    def encoding(self) -> str:  # type: ignore[override]
        """That of the output behind."""
        return self._output.encoding
