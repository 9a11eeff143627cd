"""Observations of a network, each of which checks itself when it is built.

What joins them (points, constants, datum) is ``surveyapp.domain.traverse``. Lengths in metres,
angles clockwise and in radians. Nothing here computes an equation.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import joined, said
from surveyapp.languages.names import by_id


class ObservationKind(StrEnum):
    """What was observed."""

    ANGLE = "angle"
    DIRECTION = "direction"
    DISTANCE = "distance"
    SLOPE_DISTANCE = "slope_distance"
    ZENITH = "zenith"
    HEIGHT_DIFFERENCE = "height_difference"
    AZIMUTH = "azimuth"
    GYRO = "gyro"
    GYRO_CONSTANT = "gyro_constant"
    COORDINATE_E = "coordinate_e"
    COORDINATE_N = "coordinate_n"
    COORDINATE_H = "coordinate_h"
    VECTOR_E = "vector_e"
    VECTOR_N = "vector_n"
    VECTOR_H = "vector_h"


@dataclass(frozen=True, slots=True)
class KindOfObservation:
    """What a kind of observation is.

    Parameters
    ----------
    kind : ObservationKind
    title : str
        In the trade's words.
    angular : bool
        Value, sigma and residual in radians; else in metres.
    single_point : bool
        Without a target.
    positive : bool
        A value of zero or below is impossible.
    book : str
        What a row of a traverse book holds for it: ``value``; ``none`` where the value comes from
        elsewhere; empty where no row may have this kind.
    """

    kind: ObservationKind
    title: str
    angular: bool = False
    single_point: bool = False
    positive: bool = False
    book: str = ""


KINDS: tuple[KindOfObservation, ...] = (
    KindOfObservation(
        ObservationKind.ANGLE, "angle from the back to the fore sight", angular=True, book="value"
    ),
    KindOfObservation(ObservationKind.DIRECTION, "direction of a set", angular=True, book="value"),
    KindOfObservation(ObservationKind.DISTANCE, "horizontal distance", positive=True, book="value"),
    KindOfObservation(
        ObservationKind.SLOPE_DISTANCE, "slope distance", positive=True, book="value"
    ),
    KindOfObservation(ObservationKind.ZENITH, "zenith angle", angular=True, book="value"),
    KindOfObservation(
        ObservationKind.HEIGHT_DIFFERENCE, "height difference, to minus at", book="value"
    ),
    KindOfObservation(ObservationKind.AZIMUTH, "known grid azimuth", angular=True, book="value"),
    KindOfObservation(
        ObservationKind.GYRO, "gyro azimuth of a session of this project", angular=True, book="none"
    ),
    KindOfObservation(
        ObservationKind.GYRO_CONSTANT,
        "instrument constant known beforehand",
        angular=True,
        single_point=True,
    ),
    KindOfObservation(ObservationKind.COORDINATE_E, "observed east", single_point=True),
    KindOfObservation(ObservationKind.COORDINATE_N, "observed north", single_point=True),
    KindOfObservation(ObservationKind.COORDINATE_H, "observed height", single_point=True),
    KindOfObservation(ObservationKind.VECTOR_E, "east of a vector"),
    KindOfObservation(ObservationKind.VECTOR_N, "north of a vector"),
    KindOfObservation(ObservationKind.VECTOR_H, "height of a vector"),
)
"""Every kind once; its equation stands in ``core.network.linearise``."""

ANGULAR = frozenset(item.kind for item in KINDS if item.angular)
"""Kinds whose value, sigma and residual are in radians; the others are in metres."""

SINGLE_POINT = frozenset(item.kind for item in KINDS if item.single_point)
"""Kinds without a target."""

_POSITIVE = frozenset(item.kind for item in KINDS if item.positive)


@dataclass(frozen=True, slots=True)
class EstimatedSigma:
    """That part of an observation's variance which is that of its reading.

    Parameters
    ----------
    name : str
        Observations of one name share the estimate, and so its error.
    variance : float
        [rad^2] or [m^2].
    dof : float
        Degrees of freedom of the estimate, above 0; infinite where it is known.
    rest_assumed : bool
        Whether the rest of the variance, centring and heights, is a mere assumption: it may be
        smaller.
    """

    name: str
    variance: float
    dof: float
    rest_assumed: bool = False


@dataclass(frozen=True, slots=True)
class Observation:
    """One observation.

    Parameters
    ----------
    kind : ObservationKind
    at : str
        Occupied point; for ``gyro_constant`` the name of the constant.
    to : str
        Target (fore sight of an angle); empty for coordinates and constants.
    value : float
        [rad] or [m], see ``ANGULAR``. An angle is clockwise from ``back`` to ``to``.
    sigma : float
        Standard deviation [rad] or [m], positive.
    back : str
        Back sight of an angle.
    set : str
        Directions of one ``at`` and ``set`` share one orientation unknown.
    hi, ht : float
        Heights of instrument and target above their points [m].
    constant : str
        For ``gyro``: which instrument constant the observation contains.
    convergence : float
        For ``gyro``: what is subtracted from the true azimuth to get the grid azimuth [rad]
        (convergence of its own station, deflection, arc-to-chord).
    group : str
        Variance component group; empty = the kind.
    note, extern : str
    length_m : float or None
        Length of the levelled section of a height difference [m]; None where nobody says.
    line : int
        Line of the file, 0 = unknown.
    estimated : EstimatedSigma or None
        What of its variance is an estimate; None where the sigma is known beforehand.

    Raises
    ------
    SurveyError
        With everything that is impossible about it.
    """

    kind: ObservationKind
    at: str
    to: str
    value: float
    sigma: float
    back: str = ""
    set: str = ""
    hi: float = 0.0
    ht: float = 0.0
    constant: str = ""
    convergence: float = 0.0
    group: str = ""
    note: str = ""
    extern: str = ""
    line: int = 0
    length_m: float | None = None
    estimated: EstimatedSigma | None = None

    def __post_init__(self) -> None:
        if (
            self.at
            and self.at != self.to
            and (self.to or self.kind in SINGLE_POINT)
            and self.kind is not ObservationKind.ANGLE
            and math.isfinite(self.value)
            and 0.0 < self.sigma < math.inf
            and (self.value > 0.0 or self.kind not in _POSITIVE)
            and (self.length_m is None or 0.0 < self.length_m < math.inf)
            and math.isfinite(self.hi + self.ht + self.convergence)
        ):
            return
        problems = _observation_problems(self)
        if problems:
            raise SurveyError(problems)

    @property
    def where(self) -> str:
        """Where the observation stands, for messages."""
        sight = "-".join(name for name in (self.back, self.at, self.to) if name)
        what = joined(" ", (by_id(self.kind.value), sight))
        return said("line {line}, {what}", line=self.line, what=what) if self.line else what


def _observation_problems(obs: Observation) -> list[Problem]:
    problems = []

    def add(what: str, found: str, expected: str, hint: str = "") -> None:
        problems.append(Problem(what, obs.where, found, expected, hint))

    if not obs.at:
        add("The occupied point is not named", "''", "the name of a point")
    if not obs.to and obs.kind not in SINGLE_POINT:
        add("The target is not named", "''", "the name of a point")
    if obs.to and obs.at == obs.to:
        add("A point is observed from itself", obs.at, "two different points")
    if obs.kind is ObservationKind.ANGLE:
        if not obs.back:
            add("The back sight of an angle is not named", "''", "the name of a point")
        elif obs.back == obs.to:
            add("Both targets of an angle are the same", obs.to, "two different targets")
        elif obs.back == obs.at:
            add("A point is observed from itself", obs.at, "two different points")
    if not math.isfinite(obs.value):
        add("The value is no number", str(obs.value), "a finite number")
    elif obs.kind in _POSITIVE and obs.value <= 0.0:
        add("A side has no length", f"{obs.value:g} m", "a length above 0 m")
    if not (0.0 < obs.sigma < math.inf):
        add("The standard deviation is not positive", str(obs.sigma), "a number above 0")
    if obs.length_m is not None and not 0.0 < obs.length_m < math.inf:
        add("A levelled section has no length", f"{obs.length_m:g} m", "a length above 0 m")
    if not math.isfinite(obs.hi + obs.ht + obs.convergence):
        add("A height or a convergence is no number", f"{obs.hi}, {obs.ht}", "finite numbers")
    return problems


@dataclass(frozen=True, slots=True)
class CorrelatedBlock:
    """Observations with a common covariance matrix.

    Parameters
    ----------
    members : tuple of int
        Places in ``Network.observations``, without repetition.
    covariance : tuple of tuple of float
        Shape (k, k), symmetric and positive definite, in the units of the observations squared.

    Raises
    ------
    SurveyError
        If shape, symmetry or definiteness is wrong.
    """

    members: tuple[int, ...]
    covariance: tuple[tuple[float, ...], ...]

    def __post_init__(self) -> None:
        size = len(self.members)
        where = said("covariance matrix of {size} observations", size=size)
        if len(set(self.members)) != size or size == 0:
            raise SurveyError(
                Problem("An observation stands twice in a block", where, str(self.members), "once")
            )
        matrix = np.asarray(self.covariance, dtype=np.float64)
        if matrix.shape != (size, size):
            found = "x".join(str(item) for item in matrix.shape)
            raise SurveyError(
                Problem("The covariance matrix has a wrong size", where, found, f"{size}x{size}")
            )
        if not np.isfinite(matrix).all() or not np.allclose(matrix, matrix.T, rtol=1e-9, atol=0.0):
            raise SurveyError(
                Problem("The covariance matrix is not symmetric", where, "", "a symmetric matrix")
            )
        scale = np.sqrt(np.abs(np.diag(matrix)))
        if (scale <= 0.0).any() or float(np.linalg.eigvalsh(matrix / np.outer(scale, scale))[0]) < (
            1e-12
        ):
            hint = "Are the covariances in the same order and units as the observations?"
            raise SurveyError(
                Problem(
                    "The covariance matrix is not positive definite",
                    where,
                    "",
                    "a positive definite matrix",
                    hint,
                )
            )
