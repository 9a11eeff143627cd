"""What a field file of another program says, as read, and what became of it in a project.

A ``Pointing`` is one reading of one target in one face, with nothing averaged. Angles in radians,
lengths in metres; None where the file says nothing. Nothing here touches a file.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal

from surveyapp.domain.warning import ResultWarning

Face = Literal["L", "R", ""]
State = Literal["added", "same", "conflict"]


@dataclass(frozen=True, slots=True)
class Pointing:
    """One pointing as read.

    Parameters
    ----------
    line : int
        Line of the file, from 1.
    at, to : str
    setup : str
        Set-up it belongs to: pointings of one set-up share instrument height and centring.
    face : str
        ``L``, ``R``, or empty where nothing tells.
    hz, v : float or None
        Circle readings [rad]; ``v`` counts from the zenith, face right from pi to 2 pi.
    sd, hd : float or None
        Slope and horizontal distance as stored [m].
    hi, ht : float or None
        Heights of instrument and target [m].
    set : str
        Set as the file names it; empty where it does not.
    ppm, prism_m : float or None
        Atmospheric correction and prism constant that belong to the distance.
    temperature_c, pressure_hpa : float or None
    time, code, note : str
    raw : bool
        Whether the distance lacks its prism constant, as the file says of this one.
    """

    line: int
    at: str
    to: str
    setup: str
    face: Face
    hz: float | None
    v: float | None
    sd: float | None
    hd: float | None
    hi: float | None
    ht: float | None
    set: str = ""
    ppm: float | None = None
    prism_m: float | None = None
    temperature_c: float | None = None
    pressure_hpa: float | None = None
    time: str = ""
    code: str = ""
    note: str = ""
    raw: bool = False


@dataclass(frozen=True, slots=True)
class KnownPoint:
    """Coordinates that the file holds for a point: true east and north [m]."""

    name: str
    e: float | None
    n: float | None
    h: float | None
    line: int = 0


@dataclass(frozen=True, slots=True)
class SkippedLine:
    """A line that was left out, and why."""

    line: int
    code: str
    text: str

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {"line": self.line, "code": self.code, "text": self.text}


@dataclass(frozen=True, slots=True)
class FieldFile:
    """A whole field file as read.

    Parameters
    ----------
    format, variant : str
        ``gsi`` and ``GSI-16, station blocks``.
    pointings : tuple of Pointing
    points : tuple of KnownPoint
        Each name once.
    atmosphere_applied, constant_applied : bool or None
        Whether ``sd`` holds these corrections after the reduction; None: the file does not say.
    corrected : bool
        Whether the reduction adds ``prism_m`` and ``ppm`` to ``sd`` (files with raw distances).
    skipped : tuple of SkippedLine
    warnings : tuple of ResultWarning
    parts : tuple of (int, int)
        First and last lines of parts that are books of their own if the whole is too large.
    """

    format: str
    variant: str
    pointings: tuple[Pointing, ...]
    points: tuple[KnownPoint, ...] = ()
    atmosphere_applied: bool | None = None
    constant_applied: bool | None = None
    corrected: bool = False
    skipped: tuple[SkippedLine, ...] = ()
    warnings: tuple[ResultWarning, ...] = ()
    parts: tuple[tuple[int, int], ...] = ()


@dataclass(frozen=True, slots=True)
class ReducedSight:
    """One target of one set, mean of the faces; angles [rad], lengths [m].

    ``faces`` counts the faces behind the direction (1 or 2); ``lines`` are those of the file.
    """

    to: str
    direction: float | None
    zenith: float | None
    slope_distance: float | None
    distance: float | None
    hi: float | None
    ht: float | None
    faces: int
    lines: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class ReducedSet:
    """One set of one set-up.

    Parameters
    ----------
    name, at : str
    sights : tuple of ReducedSight
    collimation, index : float or None
        Mean error of the line of sight and of the vertical circle [rad]; None with one face.
    spread : tuple of float
        Collimation of each target that has both faces [rad], for the sigma of a direction.
    index_spread : tuple of float
        Index of each target that has both faces [rad], for the sigma of a zenith angle.
    length_gaps : tuple of float
        Half the difference of the distances in both faces [m], for the sigma of a distance.
    unlike : frozenset of str
        Targets whose faces disagree otherwise than all others of the file: they count in the means,
        and in none of these sigmas.
    """

    name: str
    at: str
    sights: tuple[ReducedSight, ...]
    collimation: float | None
    index: float | None
    spread: tuple[float, ...] = ()
    index_spread: tuple[float, ...] = ()
    length_gaps: tuple[float, ...] = ()
    unlike: frozenset[str] = frozenset()

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "set": self.name,
            "at": self.at,
            "targets": [sight.to for sight in self.sights],
            "faces": max((sight.faces for sight in self.sights), default=0),
            "collimation_arcsec": _arcsec(self.collimation),
            "index_arcsec": _arcsec(self.index),
        }


def _arcsec(value: float | None) -> float | None:
    return None if value is None else math.degrees(value) * 3600.0


@dataclass(frozen=True, slots=True)
class ImportedStation:
    """A point of the file in the project: [m], None where nobody knows."""

    name: str
    e: float | None
    n: float | None
    h: float | None
    state: State

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {"name": self.name, "e": self.e, "n": self.n, "h": self.h, "state": self.state}


@dataclass(frozen=True, slots=True)
class ImportResult:
    """What an import understood and wrote.

    Parameters
    ----------
    format, variant, file, sha256 : str
    stations : tuple of ImportedStation
    traverse, book : str
        Name of the traverse and path of its book; empty for gyro readings.
    raw : str
        Path of the readings as read.
    rows, readings : int
        Rows of the books, and pointings.
    sets : tuple of ReducedSet
    sessions : tuple of str
        Ids of the orientation sessions that were made.
    skipped : tuple of SkippedLine
    warnings : tuple of ResultWarning
    written : bool
        False for a preview.
    """

    format: str
    variant: str
    file: str
    sha256: str
    stations: tuple[ImportedStation, ...]
    traverse: str
    book: str
    raw: str
    rows: int
    readings: int
    sets: tuple[ReducedSet, ...]
    sessions: tuple[str, ...]
    skipped: tuple[SkippedLine, ...]
    warnings: tuple[ResultWarning, ...]
    written: bool = True

    @property
    def has_conflict(self) -> bool:
        """Whether a station of the project lies elsewhere than the file says."""
        return any(station.state == "conflict" for station in self.stations)

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON, schema ``surveyapp.import/1``."""
        return {
            "schema": "surveyapp.import/1",
            "format": self.format,
            "variant": self.variant,
            "file": self.file,
            "sha256": self.sha256,
            "stations": [item.to_dict() for item in self.stations],
            "traverse": self.traverse or None,
            "book": self.book or None,
            "raw": self.raw,
            "rows": self.rows,
            "readings": self.readings,
            "sets": [item.to_dict() for item in self.sets],
            "sessions": list(self.sessions),
            "skipped": [item.to_dict() for item in self.skipped],
            "warnings": [item.to_dict() for item in self.warnings],
            "written": self.written,
        }
