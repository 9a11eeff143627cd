"""What a project says of a sensor log: which file, of which kind, and how it is to be read."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import date
from typing import Final, Literal

from surveyapp.domain.instrument import AdoptedEffect

SensorKind = Literal["compass", "tilt", "rate", "fog-station", "edm"]
SENSOR_KINDS: Final[tuple[SensorKind, ...]] = ("compass", "tilt", "rate", "fog-station", "edm")


@dataclass(frozen=True, slots=True)
class SensorLogEntry:
    """One ``[[sensor_log]]`` of project.toml: which file, and how it is to be read.

    Parameters
    ----------
    id : str
    kind : SensorKind or None
        None = not stated: the command that reads it decides.
    file : str
        As written, relative to the project folder.
    columns : mapping of str to str
        Canonical name to the name in the file.
    units : mapping of str to str
        Name in the file to a unit token.
    scale : mapping of str to float
        Name in the file to the value of one count.
    rate_hz : float or None
        Replaces a missing ``time_s``.
    header_rows : int or None
        Lines before the names of the columns; None = found by looking.
    sha256 : str or None
        The file is refused if it has another.
    instrument, serial : str or None
        Whose sensor it is.
    programme : str or None
        Of a rate sensor: six-position, temperature, ...
    latitude_deg : float or None
    calibrated_on : datetime.date or None
        Day of the record.
    options : mapping
        Further keys that the subject knows, as they stand in the file.
    effects : tuple of AdoptedEffect
        What a diagnosis named in it and a person adopted.
    """

    id: str
    kind: SensorKind | None
    file: str
    columns: Mapping[str, str] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    scale: Mapping[str, float] = field(default_factory=dict)
    rate_hz: float | None = None
    header_rows: int | None = None
    sha256: str | None = None
    instrument: str | None = None
    serial: str | None = None
    programme: str | None = None
    latitude_deg: float | None = None
    calibrated_on: date | None = None
    options: Mapping[str, object] = field(default_factory=dict)
    effects: tuple[AdoptedEffect, ...] = ()
