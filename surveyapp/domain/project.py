"""A project: stations, instruments, orientation sessions, traverses, grid and rule book.

Read from a folder by ``surveyapp.io.project``; nothing here touches a file.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from datetime import date
from typing import Any, Literal

from surveyapp.domain.closing import Filing
from surveyapp.domain.constant_choice import ConstantChoice
from surveyapp.domain.instrument import AdoptedEffect, Instrument
from surveyapp.domain.mine_grid import MineGrid, StatedConvergence
from surveyapp.domain.penetration import PenetrationTable
from surveyapp.domain.readings import FieldBook
from surveyapp.domain.rulebook import RuleBook
from surveyapp.domain.sensor_entry import SensorLogEntry
from surveyapp.domain.session_sensors import LogLevelling, PreOrientation
from surveyapp.domain.shaft import ShaftTables
from surveyapp.domain.traverse_book import Traverse
from surveyapp.domain.warning import ResultWarning
from surveyapp_models.angles import ARCSEC, AngleUnit

Method = Literal["tracking", "amplitude", "transit", "automatic"]
Purpose = Literal["calibration", "survey"]
Day = date

DEFAULT_DEFLECTION_SIGMA = 5.0 * ARCSEC
"""Sigma of an unknown deflection of the vertical, each component (design.md section 2)."""
DEFLECTION_LENGTH_M = 20_000.0
"""Distance over which the correlation of unknown deflections falls to 1/e: a default of reason."""


@dataclass(frozen=True, slots=True)
class Deflection:
    """Deflection of the vertical at a station.

    Parameters
    ----------
    xi, eta : float
        Components towards north and east [rad].
    sigma : float
        Standard deviation of each component [rad].
    known : bool
        False where nobody gave one: then both are 0 and sigma is the default.
    """

    xi: float = 0.0
    eta: float = 0.0
    sigma: float = DEFAULT_DEFLECTION_SIGMA
    known: bool = False


@dataclass(frozen=True, slots=True)
class Station:
    """A station. Every position is optional; ``e`` and ``n`` are always true east and north.

    Parameters
    ----------
    name : str
    e, n : float or None
        Grid coordinates [m].
    latitude, longitude : float or None
        Geographic coordinates [rad], north and east positive.
    h : float or None
        Height [m].
    fixed : bool
    deflection : Deflection
    sigma_m : float or None
        Standard deviation of each coordinate against the neighbouring stations [m].
    convergence : StatedConvergence or None
        As the record prints it.
    planned : bool
        Not yet built; an adjustment leaves it out.
    """

    name: str
    e: float | None = None
    n: float | None = None
    latitude: float | None = None
    longitude: float | None = None
    h: float | None = None
    fixed: bool = False
    deflection: Deflection = field(default_factory=Deflection)
    sigma_m: float | None = None
    convergence: StatedConvergence | None = None
    planned: bool = False

    @property
    def has_grid_position(self) -> bool:
        """Whether e and n are both known."""
        return self.e is not None and self.n is not None


@dataclass(frozen=True, slots=True)
class Eccentric:
    """A set-up or a target beside its mark.

    One rule for both: ``direction`` is the direction from where the thing really stood TOWARDS its
    mark, on the instrument's own circle (clockwise, as a circle reading).

    Parameters
    ----------
    distance_m : float
        Horizontal distance between the mark and where instrument (or target) really stood [m].
    direction : float
        Circle reading from there towards the mark [rad].
    at : str
        ``station``: the instrument stood beside its mark; ``target``: the target did.
    sigma_m : float or None
        Standard deviation of the offset, each component [m].
    """

    distance_m: float
    direction: float
    at: Literal["station", "target"] = "station"
    sigma_m: float | None = None


@dataclass(frozen=True, slots=True)
class OrientationSession:
    """One occupation of a station with a gyro.

    Parameters
    ----------
    id, station, instrument : str
    method : str
        tracking | amplitude | transit | automatic.
    purpose : str
        calibration | survey.
    book : FieldBook
    book_path : str
        As written in project.toml.
    target : str or None
    azimuth_known : float or None
        Known grid azimuth of the line [rad].
    azimuth_known_sigma : float or None
        Its standard deviation [rad]; None: from the coordinates' sigma.
    constant_choice : ConstantChoice or None
        Overrides the instrument's.
    date : datetime.date or None
    order : float or None
        Place in the sequence where times are missing.
    circle_shift : float or None
        [rad].
    observer : str
    reference_temperature_c : float or None
    resolution : float or None
        Reading resolution [rad].
    eccentric : Eccentric or None
    effects : tuple of AdoptedEffect
    convergence : StatedConvergence or None
        As the record prints it.
    recentred : bool
        The instrument was centred anew for this session: its centring error is its own.
    refraction_sigma : float or None
        Lateral refraction of its sights, along a wall or over a shaft [rad].
    levelling : LogLevelling or None
        Tilt of its standing axis from a calibrated log.
    pre_orientation : PreOrientation or None
    pressure_hpa, humidity_percent : float or None
        Of the air at the instrument.
    hours_since_transport : float or None
        Since the instrument was last carried or driven; None: from the sessions.
    override : tuple of (str, object)
        Further keys of the table, kept for those who know them.
    """

    id: str
    station: str
    instrument: str
    method: Method
    purpose: Purpose
    book: FieldBook
    book_path: str = ""
    target: str | None = None
    azimuth_known: float | None = None
    azimuth_known_sigma: float | None = None
    constant_choice: ConstantChoice | None = None
    date: date | None = None
    order: float | None = None
    circle_shift: float | None = None
    observer: str = ""
    reference_temperature_c: float | None = None
    resolution: float | None = None
    eccentric: Eccentric | None = None
    effects: tuple[AdoptedEffect, ...] = ()
    convergence: StatedConvergence | None = None
    recentred: bool = False
    refraction_sigma: float | None = None
    levelling: LogLevelling | None = None
    pre_orientation: PreOrientation | None = None
    pressure_hpa: float | None = None
    humidity_percent: float | None = None
    hours_since_transport: float | None = None
    override: tuple[tuple[str, object], ...] = ()

    @property
    def book_day(self) -> Day | None:
        """Day of the first time in its book."""
        return next((row.time.date() for row in self.book.live if row.time is not None), None)

    @property
    def day(self) -> Day | None:
        """Day of the session: its date, else the first in its book."""
        return self.book_day if self.date is None else self.date


@dataclass(frozen=True, slots=True)
class Centring:
    """Standard deviation of centring, each horizontal component [m]."""

    instrument_m: float = 0.001
    target_m: float = 0.001
    known: bool = False


@dataclass(frozen=True, slots=True)
class Project:
    """A whole project as read: everything that its folder says, once.

    Parameters
    ----------
    name : str
    stations : tuple of Station
    instruments : tuple of Instrument
    sessions : tuple of OrientationSession
    traverses : tuple of Traverse
        With the rows of their books.
    crs : str or None
        As written.
    grid : MineGrid or None
        The mine's own grid; wins over ``crs``, which is then its base.
    deflection_length_m : float
        Correlation length of unknown deflections of the vertical [m]; 0: independent.
    station_sigma_m : float or None
        Standard deviation of a station's coordinates where it states none [m].
    angle_unit : AngleUnit
    angle_typing : str
        How the screens take a plain number for dms: ``separated`` or ``packed``.
    rule_book : str or None
        Id of an installed rule book or a path, as written.
    rules : RuleBook or None
        The rule book itself; None where none is named.
    centring : Centring
        For sights of orientation sessions.
    digest : str
        sha256 over project.toml and every file it names.
    filing : Filing
        Closings, and what was changed since.
    path : str
        Folder; empty for a project that was never on a disk.
    penetration : PenetrationTable or None
        With what is wrong in it, which only a prediction minds.
    shafts : ShaftTables or None
        With their books and what is wrong in them, which only their use minds.
    sensor_logs : tuple of SensorLogEntry
    warnings : tuple of ResultWarning
    """

    name: str
    stations: tuple[Station, ...] = ()
    instruments: tuple[Instrument, ...] = ()
    sessions: tuple[OrientationSession, ...] = ()
    traverses: tuple[Traverse, ...] = ()
    crs: str | None = None
    grid: MineGrid | None = None
    deflection_length_m: float = DEFLECTION_LENGTH_M
    station_sigma_m: float | None = None
    angle_unit: AngleUnit = AngleUnit.DMS
    angle_typing: str = "separated"
    rule_book: str | None = None
    rules: RuleBook | None = None
    centring: Centring = field(default_factory=Centring)
    digest: str = ""
    filing: Filing = field(default_factory=Filing)
    path: str = ""
    penetration: PenetrationTable | None = None
    shafts: ShaftTables | None = None
    sensor_logs: tuple[SensorLogEntry, ...] = ()
    warnings: tuple[ResultWarning, ...] = ()
    _stations: dict[str, Station] = field(
        default_factory=dict, init=False, repr=False, compare=False
    )
    _sessions: dict[str, OrientationSession] = field(
        default_factory=dict, init=False, repr=False, compare=False
    )

    def station(self, name: str) -> Station:
        """Station by name; io has made sure that every name used exists."""
        if not self._stations:
            self._stations.update({item.name: item for item in reversed(self.stations)})
        return self._stations[name]

    def instrument(self, identity: str) -> Instrument:
        """Instrument by id; io has made sure that every id used exists."""
        return next(item for item in self.instruments if item.id == identity)

    def session(self, identity: str) -> OrientationSession:
        """Session by id."""
        if not self._sessions:
            self._sessions.update({item.id: item for item in reversed(self.sessions)})
        return self._sessions[identity]

    def to_dict(self) -> dict[str, Any]:
        """What a folder holds, schema ``surveyapp.project/1``; the readings stand in its books."""
        return {
            "schema": "surveyapp.project/1",
            "name": self.name,
            "path": self.path or None,
            "crs": self.crs,
            "angle_unit": str(self.angle_unit),
            "rule_book": self.rule_book,
            "input_sha256": self.digest,
            "stations": [item.name for item in self.stations],
            "instruments": [{"id": i.id, "card": i.card.id} for i in self.instruments],
            "sessions": [
                {
                    "id": item.id,
                    "station": item.station,
                    "target": item.target,
                    "instrument": item.instrument,
                    "method": item.method,
                    "purpose": item.purpose,
                    "rows": len(item.book.live),
                }
                for item in self.sessions
            ],
            "traverses": [{"name": t.name, "rows": len(t.rows)} for t in self.traverses],
            "closed": self.filing.project_closing is not None,
            "warnings": [warning.to_dict() for warning in self.warnings],
        }

    def traverse(self, name: str) -> Traverse:
        """Traverse by name."""
        return next(item for item in self.traverses if item.name == name)


def grid_bearing(start: Station, end: Station) -> float | None:
    """Grid azimuth [rad, not wrapped] of the line between two stations, None without positions."""
    if start.e is None or start.n is None or end.e is None or end.n is None:
        return None
    return math.atan2(end.e - start.e, end.n - start.n)


def grid_distance_m(start: Station, end: Station) -> float | None:
    """Grid distance of two stations [m], None without positions."""
    if start.e is None or start.n is None or end.e is None or end.n is None:
        return None
    return math.hypot(end.e - start.e, end.n - start.n)
