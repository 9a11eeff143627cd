"""A simulated total station on the other end of a pseudo-terminal, by the public manuals."""

from __future__ import annotations

import math
import os
import pty
import select
import threading
import tty
from collections.abc import Callable
from types import TracebackType


class Station:
    """Answers requests in a thread until it is closed or its cable is pulled.

    Parameters
    ----------
    answer : callable
        From a request without its end to the bytes that come back; None: silence.
    """

    def __init__(self, answer: Callable[[bytes], bytes | None]) -> None:
        self.answer = answer
        self.requests: list[bytes] = []
        self._master, self._slave = pty.openpty()
        tty.setraw(self._slave)
        self.port = os.ttyname(self._slave)
        self._over = threading.Event()
        self._pulled = False
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

    def _serve(self) -> None:
        data = b""
        while not self._over.is_set():
            try:
                if not select.select([self._master], [], [], 0.05)[0]:
                    continue
                data += os.read(self._master, 256)
            except (OSError, ValueError):
                return
            while b"\n" in data:
                request, _, data = data.partition(b"\n")
                request = request.rstrip(b"\r")
                self.requests.append(request)
                reply = self.answer(request)
                if reply is not None:
                    try:
                        os.write(self._master, reply)
                    except OSError:
                        return

    def pull_cable(self) -> None:
        """What happens to a port whose cable is pulled out; called by the answering thread."""
        self._over.set()
        self._pulled = True
        os.close(self._slave)
        os.close(self._master)

    def __enter__(self) -> Station:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._over.set()
        self._thread.join()  # before its handle may be another's
        if not self._pulled:
            os.close(self._slave)
            os.close(self._master)


def geocom(hz: Callable[[], float], v: float, length: float | None) -> Callable[[bytes], bytes]:
    """Angles in radians [rad]; no prism where the length is None."""

    def answer(request: bytes) -> bytes:
        name = request.partition(b",")[2].partition(b":")[0]
        if name == b"2107":
            return f"%R1P,0,0:0,{hz()!r},{v!r},0,0,0,0,0,0,0\r\n".encode()
        if name == b"2008":
            return b"%R1P,0,0:0\r\n"
        if name == b"2108":
            if length is None:
                return b"%R1P,0,0:1285,0,0,0\r\n"
            return f"%R1P,0,0:0,{hz()!r},{v!r},{length!r}\r\n".encode()
        return b"%R1P,0,0:3\r\n"

    return answer


def gsi(hz: float, v: float, length: float, *, unit: str = "2") -> Callable[[bytes], bytes]:
    """Angles [degrees] in gon (unit 2) or decimal degrees (3), lengths in mm."""
    factor = 1e5 / 0.9 if unit == "2" else 1e5

    def answer(request: bytes) -> bytes:
        if not request.startswith(b"GET/"):
            return b"@W427\r\n"
        text = f"*21.32{unit}+{round(hz * factor):016d} 22.32{unit}+{round(v * factor):016d} "
        if b"WI31" in request:
            text += f"31..00+{round(length * 1000):016d} "
        return text.encode() + b"\r\n"

    return answer


def sokkia(
    hz: str, v: str, length_mm: int, *, settings: str = "0,0,0,-30,0,0,0,0,0,0,0"
) -> Callable[[bytes], bytes]:
    """Angles as DDDMMSS."""

    def answer(request: bytes) -> bytes:
        if request == b"B":
            return f"B {settings}, 00\r\n".encode()
        if request == b"\x11":
            return f"{length_mm:07d} {v} {hz} 55\r\n".encode()
        if request == b"\x00":
            return f"0000000 {v} {hz} 55\r\n".encode()
        return b"E100\r\n"

    return answer


def radians(degrees: float) -> float:
    """Degrees to radians."""
    return math.radians(degrees)
