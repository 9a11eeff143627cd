"""Output in which no name, note or path of a stranger steers the terminal."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Iterator
from typing import Any, TextIO

from surveyapp.io.files import visible


class SafeStream:
    """A text stream that writes control characters as escapes; all else is the stream's own."""

    def __init__(self, stream: TextIO) -> None:
        self.stream = stream

    def write(self, text: str) -> int:
        """Write a text, its control characters as escapes.

        A carriage return at the ends is the program's own, of a line that is drawn again.
        """
        inner = text.strip("\r")
        begin, _, end = text.partition(inner) if inner else (text, "", "")
        self.stream.write(f"{begin}{visible(inner)}{end}")
        return len(text)

    def __getattr__(self, name: str) -> Any:
        return getattr(self.stream, name)


@contextlib.contextmanager
def safe_output() -> Iterator[None]:
    """Standard output and error escape control characters inside; the JSON has escaped its own."""
    before = sys.stdout, sys.stderr
    for name, stream in zip(("stdout", "stderr"), before, strict=True):
        if stream is not None and not isinstance(stream, SafeStream):
            setattr(sys, name, SafeStream(stream))
    try:
        yield
    finally:
        sys.stdout, sys.stderr = before
