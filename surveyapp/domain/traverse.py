"""A network of points and observations: what a traverse book or a .gkf file says, and no more.

The network checks what joins its observations. Nothing here computes coordinates. East, north and
height are true east, north and up in metres; angles are clockwise and in radians.
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, field
from enum import StrEnum
from typing import Any

from surveyapp.domain.observations import CorrelatedBlock, Observation, ObservationKind
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.languages import said


class Status(StrEnum):
    """What the adjustment does with one coordinate of a point."""

    FIXED = "fixed"
    CONSTRAINED = "constrained"
    FREE = "free"
    UNUSED = "unused"


@dataclass(frozen=True, slots=True)
class NetworkPoint:
    """A point with the status of each coordinate.

    Parameters
    ----------
    name : str
    e, n, h : float or None
        Given or approximate coordinates [m]; a fixed one must be there.
    status_e, status_n, status_h : Status
        ``constrained``: an unknown that carries the datum of a free network; ``unused``: the
        network does not deal with this coordinate.

    Raises
    ------
    SurveyError
        If a fixed coordinate has no value, a value is not finite or the name is empty.
    """

    name: str
    e: float | None = None
    n: float | None = None
    h: float | None = None
    status_e: Status = Status.FREE
    status_n: Status = Status.FREE
    status_h: Status = Status.UNUSED

    def __post_init__(self) -> None:
        problems = []
        if not self.name:
            problems.append(Problem("A point has no name", "point", "''", "a name"))
        for label, value, status in self.components():
            where = said("point {name}, {label}", name=self.name, label=label)
            if value is not None and not math.isfinite(value):
                problems.append(Problem("A coordinate is no number", where, str(value), "metres"))
            if status is Status.FIXED and value is None:
                problems.append(
                    Problem(
                        "A fixed coordinate has no value", where, "nothing", "a value in metres"
                    )
                )
        if problems:
            raise SurveyError(problems)

    def components(self) -> tuple[tuple[str, float | None, Status], ...]:
        """Name, value and status of each coordinate in the order e, n, h."""
        return (
            ("e", self.e, self.status_e),
            ("n", self.n, self.status_n),
            ("h", self.h, self.status_h),
        )


@dataclass(frozen=True, slots=True)
class GyroConstant:
    """An instrument constant that gyro sides share: true azimuth = gyro azimuth + constant.

    Parameters
    ----------
    name : str
    value : float
        Known beforehand, or an approximation [rad].
    sigma : float or None
        Its standard deviation [rad]; None: nothing is known beforehand, the network finds it.
    """

    name: str
    value: float = 0.0
    sigma: float | None = None


@dataclass(frozen=True, slots=True)
class OrientedLine:
    """A line oriented by gyro, as the orientation results deliver it.

    Parameters
    ----------
    station, target : str
    gyro_azimuth : float
        Without the instrument constant [rad].
    sigma : float
        Of the gyro azimuth alone, constant excluded [rad].
    constant : str
        Name of the constant that it shares, usually the instrument's id.
    convergence : float
        True minus grid azimuth at the occupied station: convergence + deflection + arc-to-chord
        [rad].
    covariance : tuple of (int, float)
        Covariance with other lines of the same sequence, by their place in it [rad^2].
    """

    station: str
    target: str
    gyro_azimuth: float
    sigma: float
    constant: str
    convergence: float = 0.0
    covariance: tuple[tuple[int, float], ...] = ()


@dataclass(frozen=True, slots=True)
class Network:
    """Points, observations and what is known of their errors.

    Parameters
    ----------
    points : tuple of NetworkPoint
    observations : tuple of Observation
    blocks : tuple of CorrelatedBlock
        An observation outside all blocks is independent.
    constants : tuple of GyroConstant
    sigma_apriori : float
        Standard deviation of unit weight, in the unit in which ``sigma0`` is to be reported.
    confidence : float
        Probability of tests and confidence regions.
    scaled_by_residuals : bool
        Whether covariances are scaled by the a-posteriori sigma0.
    tolerance_m : float or None
        Misclosure [m] beyond which an observation is taken for gross and left out, None = never.
    name, description : str
    axes : str
        Directions of x and y in the source, ``en`` | ``ne`` | ``sw`` | ...; values are converted.
    left_handed : bool
        Whether the source's angles are clockwise; values are converted.
    warnings : tuple of ResultWarning

    Raises
    ------
    SurveyError
        Two points of one name, an unknown point or constant, an observation in two blocks.
    """

    points: tuple[NetworkPoint, ...]
    observations: tuple[Observation, ...]
    blocks: tuple[CorrelatedBlock, ...] = ()
    constants: tuple[GyroConstant, ...] = ()
    sigma_apriori: float = 1.0
    confidence: float = 0.95
    scaled_by_residuals: bool = False
    tolerance_m: float | None = None
    name: str = ""
    description: str = ""
    axes: str = "en"
    left_handed: bool = True
    warnings: tuple[ResultWarning, ...] = field(default=())

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON, schema ``surveyapp.network/1``: metres and radians."""
        return {
            "schema": "surveyapp.network/1",
            "name": self.name,
            "points": [
                {"name": p.name, "e": p.e, "n": p.n, "h": p.h, "status": [str(s) for s in _of(p)]}
                for p in self.points
            ],
            "observations": [
                {
                    "kind": str(o.kind),
                    "at": o.at,
                    "from": o.back or None,
                    "to": o.to,
                    "value": o.value,
                    "sigma": o.sigma,
                }
                for o in self.observations
            ],
            "constants": [asdict(constant) for constant in self.constants],
            "warnings": [warning.to_dict() for warning in self.warnings],
        }

    def __post_init__(self) -> None:
        problems = _name_problems(self) + _block_problems(self) + _parameter_problems(self)
        if problems:
            raise SurveyError(problems)


def _of(point: NetworkPoint) -> tuple[Status, Status, Status]:
    return point.status_e, point.status_n, point.status_h


def _parameter_problems(network: Network) -> list[Problem]:
    problems = []
    if not 0.0 < network.sigma_apriori < math.inf:
        found = f"{network.sigma_apriori:g}"
        problems.append(Problem("The a-priori sigma is not positive", "network", found, "above 0"))
    if not 0.0 < network.confidence < 1.0:
        found = f"{network.confidence:g}"
        problems.append(Problem("The probability is impossible", "network", found, "0 to 1"))
    if not network.points:
        problems.append(Problem("The network has no points", "network", "none", "points"))
    if not network.observations:
        problems.append(Problem("There are no observations", "network", "none", "observations"))
    return problems


def _name_problems(network: Network) -> list[Problem]:
    known = {point.name for point in network.points}
    problems = []
    if len(known) != len(network.points):
        seen: set[str] = set()
        for point in network.points:
            if point.name in seen:
                hint = "Rename one of them."
                problems.append(
                    Problem("Two points have one name", "points", point.name, "unique names", hint)
                )
            seen.add(point.name)
    constants = {constant.name for constant in network.constants}
    unknown: dict[str, str] = {}
    for obs in network.observations:
        if obs.kind is ObservationKind.GYRO_CONSTANT:
            continue
        for name in (obs.back, obs.at, obs.to):
            if name and name not in known:
                unknown.setdefault(name, obs.where)
        if obs.kind is ObservationKind.GYRO and obs.constant not in constants:
            hint = nearest_names(obs.constant, constants)
            problems.append(
                Problem("Unknown instrument constant", obs.where, obs.constant, "a constant", hint)
            )
    problems += [
        Problem("Unknown point", where, name, "a point of the network", nearest_names(name, known))
        for name, where in unknown.items()
    ]
    return problems


def _block_problems(network: Network) -> list[Problem]:
    seen: set[int] = set()
    problems = []
    for block in network.blocks:
        for member in block.members:
            if member in seen or not 0 <= member < len(network.observations):
                problems.append(
                    Problem(
                        "An observation stands in two covariance matrices or in none that exists",
                        said("observation {number}", number=member + 1),
                        "",
                        "one covariance matrix",
                    )
                )
            seen.add(member)
    return problems
