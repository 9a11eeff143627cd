"""A breakthrough as planned: headings, their starts, gyro sides, tolerance, and what was measured.

What ``[penetration]`` of project.toml says, and no more. Lengths in metres, angles clockwise and
in radians. How large the miss will be is computed in ``surveyapp.core.penetration``.
"""

from __future__ import annotations

import datetime as dt
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING, Literal

from surveyapp.errors import Problem

if TYPE_CHECKING:
    from surveyapp.domain.warning import ResultWarning

Wall = Literal["right", "left", "none"]


class ExcavationCase(StrEnum):
    """How the drive is cut."""

    OPPOSITE = "opposite"
    SAME_DIRECTION = "same_direction"
    ONE_END = "one_end"

    @property
    def headings(self) -> int:
        """How many headings meet; one meets the fixed meeting point."""
        return 1 if self is ExcavationCase.ONE_END else 2


class TunnelCase(StrEnum):
    """What is holed through; the class of the rule book."""

    WITHIN_MINE = "within_mine"
    BETWEEN_MINES = "between_mines"
    SHAFT = "shaft"


@dataclass(frozen=True, slots=True)
class MeetingPoint:
    """Where the headings are to meet [m]."""

    e: float
    n: float
    h: float | None = None


@dataclass(frozen=True, slots=True)
class HeadingStart:
    """What is known where a heading begins.

    Parameters
    ----------
    azimuth_sigma : float or None
        Standard deviation of the azimuth of the first side [rad]; None: gyro sides orient.
    position_sigma_m : float
        East and north each [m].
    group : str
        Starts of one group share one error; empty: the heading's own.
    """

    azimuth_sigma: float | None = None
    position_sigma_m: float = 0.0
    group: str = ""


@dataclass(frozen=True, slots=True)
class Heading:
    """One heading: its route from a fixed point towards the meeting point.

    Parameters
    ----------
    name : str
    route : tuple of str
        Stations, the fixed start first.
    traverse : str
        Name of the traverse whose rows replace the assumed ones; empty: none yet.
    wall : tuple of str
        Along which wall each station stands, looking along the route; empty: not said.
    start : HeadingStart
    height_transfer_m : float or None
        Depth through which the height is brought down [m].
    shaft : str
        Id of the shaft through which the heading starts; empty: none.
    """

    name: str
    route: tuple[str, ...]
    traverse: str = ""
    wall: tuple[Wall, ...] = ()
    start: HeadingStart = field(default_factory=HeadingStart)
    height_transfer_m: float | None = None
    shaft: str = ""

    @property
    def sides(self) -> tuple[tuple[str, str], ...]:
        """Sides of the route in order."""
        return tuple(zip(self.route[:-1], self.route[1:], strict=True))

    def wall_signs(self) -> tuple[float, ...]:
        """+1 right, -1 left, 0 none, one per station."""
        if not self.wall:
            return (0.0,) * len(self.route)
        return tuple({"right": 1.0, "left": -1.0, "none": 0.0}[w] for w in self.wall)


@dataclass(frozen=True, slots=True)
class GyroSide:
    """A side of a route that is to be, or was, observed with a gyro.

    Parameters
    ----------
    at, to : str
        Ends of the side in the order of observation.
    instrument : str
    sigma : float
        One determination, the independent part [rad].
    reciprocal : bool
        Whether it is observed from both ends.
    """

    at: str
    to: str
    instrument: str
    sigma: float
    reciprocal: bool = False


@dataclass(frozen=True, slots=True)
class WallRefraction:
    """Temperature gradients along the walls.

    Parameters
    ----------
    gradient_sigma : float
        1 sigma of the horizontal gradient at a wall [K/m].
    pressure_hpa, temperature_c : float
    shared : str
        ``all``: one gradient for all headings; ``heading``: one for each.
    """

    gradient_sigma: float
    pressure_hpa: float = 1013.25
    temperature_c: float = 15.0
    shared: Literal["all", "heading"] = "all"


@dataclass(frozen=True, slots=True)
class DeflectionField:
    """Unknown deflections of the vertical as a random field along the drive.

    Parameters
    ----------
    sigma : float
        1 sigma of the component across the meridian, eta [rad].
    correlation_length_m : float
    latitude : float
        [rad].
    calibrated_at : str
        Station at which the instrument constants were formed.
    """

    sigma: float
    correlation_length_m: float
    latitude: float
    calibrated_at: str


@dataclass(frozen=True, slots=True)
class HeightMethod:
    """How heights are carried along the routes.

    Parameters
    ----------
    method : str
        ``levelling`` or ``trig``.
    sigma_m_per_sqrt_km : float
        Levelling [m].
    sigma_zenith : float
        One zenith angle [rad].
    sigma_hi_m, sigma_ht_m : float
        Heights of instrument and target [m].
    reciprocal : bool
    """

    method: Literal["levelling", "trig"]
    sigma_m_per_sqrt_km: float = 0.0
    sigma_zenith: float = 0.0
    sigma_hi_m: float = 0.0
    sigma_ht_m: float = 0.0
    reciprocal: bool = False


@dataclass(frozen=True, slots=True)
class StatedTolerance:
    """A tolerance that the project states itself [m]; None: not stated for that component."""

    lateral_m: float | None = None
    longitudinal_m: float | None = None
    vertical_m: float | None = None
    source: str = ""


@dataclass(frozen=True, slots=True)
class MonteCarloPlan:
    """How many surveys are simulated, and from which seed."""

    runs: int = 10_000
    seed: int = 1


@dataclass(frozen=True, slots=True)
class MeasuredMiss:
    """The measured closure: heading 1 minus heading 2, right, along and up [m]."""

    lateral_m: float | None = None
    longitudinal_m: float | None = None
    vertical_m: float | None = None
    date: dt.date | None = None
    by: str = ""


@dataclass(frozen=True, slots=True)
class ProcedureStep:
    """One entry of the six steps of the procedure; step 5 has one entry for every check.

    Parameters
    ----------
    id : int
        1 to 6.
    done_at : str
        Date as written; empty: not done.
    by, note, file : str
    centre_line_mm, waist_line_mm : float or None
        Readings of a check: offset of the face from the centre line (+ right), height of the
        waist line against the plan (+ high).
    """

    id: int
    done_at: str = ""
    by: str = ""
    note: str = ""
    file: str = ""
    centre_line_mm: float | None = None
    waist_line_mm: float | None = None


@dataclass(frozen=True, slots=True)
class AssumedSigmas:
    """Sigmas of angles and distances before anything is measured.

    Parameters
    ----------
    angle : float or None
        One angle, readings only [rad].
    distance_mm, distance_ppm : float or None
    scale_ppm : float or None
        Scale of the distance meter, common to all sides.
    centring_instrument_m, centring_target_m : float or None
        Each component [m].
    """

    angle: float | None = None
    distance_mm: float | None = None
    distance_ppm: float | None = None
    scale_ppm: float | None = None
    centring_instrument_m: float | None = None
    centring_target_m: float | None = None


@dataclass(frozen=True, slots=True)
class Penetration:
    """The whole ``[penetration]`` table.

    Parameters
    ----------
    case : ExcavationCase
    tunnel : TunnelCase
    meeting : MeetingPoint
    axis_azimuth : float
        Grid azimuth of the drive at the meeting point [rad].
    headings : tuple of Heading
    gyro : tuple of GyroSide
    sigmas : AssumedSigmas
    independent_surveys : int
    factor : float or None
        Wins over the rule book's.
    axis_across : bool
        Whether an axis across the last sides is meant.
    height : HeightMethod or None
    tolerance : StatedTolerance or None
    monte_carlo : MonteCarloPlan
    refraction : WallRefraction or None
    deflection : DeflectionField or None
    measured : MeasuredMiss or None
    steps : tuple of ProcedureStep
    """

    case: ExcavationCase
    tunnel: TunnelCase
    meeting: MeetingPoint
    axis_azimuth: float
    headings: tuple[Heading, ...]
    gyro: tuple[GyroSide, ...] = ()
    sigmas: AssumedSigmas = field(default_factory=AssumedSigmas)
    independent_surveys: int = 1
    factor: float | None = None
    axis_across: bool = False
    height: HeightMethod | None = None
    tolerance: StatedTolerance | None = None
    monte_carlo: MonteCarloPlan = field(default_factory=MonteCarloPlan)
    refraction: WallRefraction | None = None
    deflection: DeflectionField | None = None
    measured: MeasuredMiss | None = None
    steps: tuple[ProcedureStep, ...] = ()


@dataclass(frozen=True, slots=True)
class PenetrationTable:
    """``[penetration]`` as read, with everything that is wrong with it.

    What is wrong keeps nobody from orienting: it is told by whoever predicts.

    Parameters
    ----------
    plan : Penetration
        Wrong values replaced.
    problems : tuple of Problem
    warnings : tuple of ResultWarning
    """

    plan: Penetration
    problems: tuple[Problem, ...] = ()
    warnings: tuple[ResultWarning, ...] = ()


STEP_TITLES = (
    "investigation and method",
    "prediction of the error",
    "feasibility",
    "plan and staking",
    "checks of centre line and waist line",
    "survey and evaluation after the breakthrough",
)
"""The six steps of the procedure (sensors.md 000-19)."""
