"""Every protocol of a total station: one line each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from surveyapp.domain.instrument_reading import InstrumentReading
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.io.instruments import geocom, gsi_online, sokkia
from surveyapp.io.instruments.cable import BAUD, Cable


@dataclass(frozen=True, slots=True)
class Protocol:
    """One protocol: its name, what it is, and what reads by it."""

    id: str
    title: str
    angles: Callable[[Cable], InstrumentReading]
    everything: Callable[[Cable], InstrumentReading]


PROTOCOLS: Final[tuple[Protocol, ...]] = (
    Protocol("geocom", "Leica GeoCOM (ASCII)", geocom.read_angles, geocom.read_all),
    Protocol("gsi", "Leica GSI Online", gsi_online.read_angles, gsi_online.read_all),
    Protocol("sokkia", "Sokkia two-way commands", sokkia.read_angles, sokkia.read_all),
)
"""Protocols by name."""


@dataclass(frozen=True, slots=True)
class InstrumentPort:
    """Where an instrument is and what it speaks.

    Parameters
    ----------
    protocol : Protocol
    port : str
    baud : int
    """

    protocol: Protocol
    port: str
    baud: int = BAUD

    @property
    def text(self) -> str:
        """``protocol:port@baud``."""
        return f"{self.protocol.id}:{self.port}@{self.baud}"


def instrument_port(text: str) -> InstrumentPort:
    """Port from ``protocol:port`` or ``protocol:port@baud``.

    Raises
    ------
    SurveyError
        For an unknown protocol, no port, or an impossible baud rate.
    """
    name, _, rest = text.partition(":")
    port, at, baud = rest.rpartition("@") if "@" in rest else (rest, "", "")
    found = next((item for item in PROTOCOLS if item.id == name), None)
    if found is None or not port:
        hint = nearest_names(name, [item.id for item in PROTOCOLS])
        expected = "protocol:port, such as geocom:COM3 or gsi:/dev/ttyUSB0@2400"
        raise SurveyError(Problem("this names no instrument", "instrument", text, expected, hint))
    if at and not (baud.isdigit() and 50 <= int(baud) <= 4_000_000):
        raise SurveyError(Problem("this is no baud rate", "instrument", baud, "9600 or the like"))
    return InstrumentPort(found, port, int(baud) if at else BAUD)
