"""The cable: bytes out, a line back in time, and every failure in words.

pyserial is an extra of the program and imported only here.
"""

from __future__ import annotations

import time
from types import TracebackType
from typing import Any, Final

from surveyapp.errors import Problem, SurveyError
from surveyapp.io.files import shown
from surveyapp.languages import said

BAUD: Final = 9600
_LONGEST: Final = 400
"""No answer of a total station is longer."""


def cable_problem(what: str, port: str, found: str = "", hint: str = "") -> SurveyError:
    """An error of the cable."""
    return SurveyError(
        Problem(
            what, said("instrument on {port}", port=port), shown(found) if found else "", "", hint
        )
    )


class Cable:
    """An open serial port.

    Parameters
    ----------
    port : str
        Name of the port: ``COM3``, ``/dev/ttyUSB0``.
    baud : int
    timeout_s : float
        How long an answer may take.

    Raises
    ------
    SurveyError
        If pyserial is not installed or the port cannot be opened.
    """

    def __init__(self, port: str, *, baud: int = BAUD, timeout_s: float = 5.0) -> None:
        try:
            import serial
        except ImportError:
            raise cable_problem(
                "reading instruments needs pyserial",
                port,
                hint="pip install 'surveyapp[instruments]'",
            ) from None
        self.port, self.timeout_s = port, timeout_s
        try:
            self._serial: Any = serial.Serial(port, baudrate=baud, timeout=0.05, write_timeout=2.0)
        except (OSError, ValueError) as error:
            raise cable_problem(
                "the port cannot be opened",
                port,
                str(error),
                "is the cable in, and the name right?",
            ) from None

    def ask(self, request: bytes, *, timeout_s: float | None = None) -> str:
        """Send a request and return the line that answers it, without its end.

        Raises
        ------
        SurveyError
            No answer in time, an answer without end, or a cable that was pulled out.
        """
        limit = self.timeout_s if timeout_s is None else timeout_s
        try:
            self._serial.reset_input_buffer()
            self._serial.write(request)
            answer = self._line(limit)
        except OSError as error:  # serial.SerialException is one
            hint = "put the cable in again and repeat the reading: nothing was written"
            raise cable_problem("the cable is broken", self.port, str(error), hint) from None
        text = answer.decode("latin-1").strip("\r\n\x02\x03 ")
        if not text:
            hint = "is the instrument on, in measuring mode, with this protocol and baud rate?"
            raise cable_problem(
                said("no answer within {limit:g} s", limit=limit), self.port, "", hint
            )
        return text

    def _line(self, limit: float) -> bytes:
        deadline = time.monotonic() + limit
        data = bytearray()
        while time.monotonic() < deadline:
            data += self._serial.read(1)
            data += self._serial.read(self._serial.in_waiting)
            stripped = data.lstrip(b"\r\n")
            end = min(
                (i for i in (stripped.find(b"\r"), stripped.find(b"\n")) if i >= 0), default=-1
            )
            if end >= 0:
                return bytes(stripped[:end])
            if len(data) > _LONGEST:
                break
        if data.strip():
            hint = "another protocol or baud rate?"
            raise cable_problem("the answer is cut short", self.port, data.decode("latin-1"), hint)
        return b""

    def close(self) -> None:
        """Give the port back."""
        self._serial.close()

    def __enter__(self) -> Cable:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()
