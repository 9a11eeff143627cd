"""The constant of an instrument as results hold it: by line, by determination, in force."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from surveyapp.domain.angle_result import finite, to_arcsec, to_degrees
from surveyapp.domain.subject import Subject
from surveyapp_models.angles import wrap_pi


class InArcsec:
    """A constant and its standard deviation [rad] in the units of the output."""

    __slots__ = ()

    value: float | None
    sigma: float | None

    @property
    def arcsec(self) -> float | None:
        """The constant in arc-seconds, None where it is not determined."""
        return to_arcsec(self.value)

    @property
    def deg(self) -> float | None:
        """The constant in decimal degrees with its sign, None where it is not determined."""
        return None if self.arcsec is None else self.arcsec / 3600.0

    @property
    def sigma_arcsec(self) -> float | None:
        """Its standard deviation in arc-seconds."""
        return to_arcsec(self.sigma)


@dataclass(frozen=True, slots=True)
class LineConstant(InArcsec):
    """Instrument constant from one calibration line [rad]."""

    station: str
    target: str
    value: float
    sigma: float
    count: int
    rounds: int
    distance_m: float | None

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "station": self.station,
            "target": self.target,
            "arcsec": to_arcsec(self.value),
            "sigma_arcsec": to_arcsec(self.sigma),
            "n": self.count,
            "rounds": self.rounds,
            "distance_m": finite(self.distance_m),
        }


@dataclass(frozen=True, slots=True)
class Determination(InArcsec):
    """One determination of the instrument constant, for the plot through time."""

    session: str
    station: str
    target: str
    value: float
    sigma: float
    moment_s: float | None
    phase: str
    known_azimuth: float
    from_coordinates: float | None

    @property
    def subject(self) -> Subject:
        """The session and its target as a value."""
        return Subject.session(self.session, self.target)

    @property
    def known_minus_coordinates(self) -> float | None:
        """Known grid azimuth minus the one from the coordinates [rad], None without those."""
        if self.from_coordinates is None:
            return None
        return wrap_pi(self.known_azimuth - self.from_coordinates)

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "subject": self.subject.to_dict(),
            "session": self.session,
            "station": self.station,
            "target": self.target,
            "arcsec": to_arcsec(self.value),
            "sigma_arcsec": to_arcsec(self.sigma),
            "phase": self.phase,
            "azimuth_known_deg": to_degrees(self.known_azimuth),
            "known_minus_coordinates_arcsec": to_arcsec(self.known_minus_coordinates),
        }


@dataclass(frozen=True, slots=True)
class ConstantResult(InArcsec):
    """Instrument constant (true minus gyro, astronomic terms) of one instrument [rad]."""

    instrument: str
    value: float | None
    sigma: float | None
    interval95: float | None
    count: int
    stable: bool | None
    choice: str
    by_line: tuple[LineConstant, ...]
    determinations: tuple[Determination, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "instrument": self.instrument,
            "arcsec": to_arcsec(self.value),
            "sigma_arcsec": to_arcsec(self.sigma),
            "interval95_arcsec": to_arcsec(self.interval95),
            "n": self.count,
            "stable": self.stable,
            "choice": self.choice,
            "by_line": [line.to_dict() for line in self.by_line],
            "determinations": [item.to_dict() for item in self.determinations],
        }
