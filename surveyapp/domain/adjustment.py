"""Results of an adjusted network, and their JSON.

Frozen values only; ``to_dict`` is the ``adjust`` object of the command line. Sigmas are one sigma;
azimuths of ellipses and angles are clockwise from north.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from surveyapp.domain.network_tests import GlobalTest, LeftOut, Removal, Snooping, Suspect
from surveyapp.domain.observations import ANGULAR, ObservationKind
from surveyapp.domain.records import Cell, Recorded, rows_of
from surveyapp.domain.warning import ResultWarning
from surveyapp_models.angles import RHO_ARCSEC, wrap_two_pi

__all__ = [
    "SCHEMA",
    "SIGMAS",
    "AdjustedObservation",
    "AdjustedPoint",
    "AdjustmentResult",
    "Closure",
    "Ellipse",
    "GlobalTest",
    "LeftOut",
    "RelativeEllipse",
    "Removal",
    "SharedValue",
    "Snooping",
    "Suspect",
]

SCHEMA = "surveyapp.adjust/1"
SIGMAS = 3.0
"""A closure within this many of its standard deviations passes."""


@dataclass(frozen=True, slots=True)
class Ellipse:
    """Standard (one sigma) error ellipse.

    Parameters
    ----------
    a_m, b_m : float
        Semi-axes [m], a >= b.
    azimuth : float
        Of the major axis [rad], in [0, pi).
    """

    a_m: float
    b_m: float
    azimuth: float

    def to_dict(self) -> dict[str, float]:
        """Keys of the JSON."""
        return {"a_m": self.a_m, "b_m": self.b_m, "azimuth_deg": math.degrees(self.azimuth)}


@dataclass(frozen=True, slots=True)
class AdjustedPoint:
    """A point after the adjustment.

    Parameters
    ----------
    name : str
    e, n, h : float or None
        [m]; None where the network does not deal with the coordinate.
    sigma_e, sigma_n, sigma_h : float or None
        [m]; 0 for fixed coordinates.
    ellipse : Ellipse or None
        None unless e and n are both unknowns.
    covariance : tuple of tuple of float
        Shape (3, 3) in e, n, h [m^2]; 0 where fixed or unused.
    """

    name: str
    e: float | None
    n: float | None
    h: float | None
    sigma_e: float | None
    sigma_n: float | None
    sigma_h: float | None
    ellipse: Ellipse | None
    covariance: tuple[tuple[float, float, float], ...]

    def to_dict(self) -> dict[str, object]:
        """Keys of the JSON."""
        return {
            "name": self.name,
            "e": self.e,
            "n": self.n,
            "h": self.h,
            "sigma_e_m": self.sigma_e,
            "sigma_n_m": self.sigma_n,
            "sigma_h_m": self.sigma_h,
            "ellipse": None if self.ellipse is None else self.ellipse.to_dict(),
        }


@dataclass(frozen=True, slots=True)
class AdjustedObservation:
    """An observation after the adjustment; [rad] or [m] by its kind.

    Parameters
    ----------
    place : int
        Place in ``Network.observations``; -1 for a constant known beforehand.
    kind, at, back, to
        As observed.
    observed, adjusted, residual : float
        residual = adjusted - observed.
    sigma, sigma_adjusted : float
        Before (a priori) and after the adjustment.
    standardized : float or None
        Residual over its standard deviation; None where nothing controls the observation.
    redundancy : float
        Its share of the degrees of freedom, 0 (uncontrolled) to 1; within a correlated block it
        may lie outside, the sum is right all the same.
    mdb : float or None
        Smallest bias that the test detects with the stated power.
    mdb_effect_m : float or None
        Largest change of a coordinate of its own points by a bias of that size [m].
    group : str
        Variance component group.
    line : int
    left_out : bool
        Missed by more than the stated tolerance: not adjusted, its residual is against the points.
    """

    place: int
    kind: ObservationKind
    at: str
    back: str
    to: str
    observed: float
    adjusted: float
    residual: float
    sigma: float
    sigma_adjusted: float
    standardized: float | None
    redundancy: float
    mdb: float | None
    mdb_effect_m: float | None
    group: str = ""
    line: int = 0
    left_out: bool = False

    @property
    def angular(self) -> bool:
        """Whether the values are angles [rad]."""
        return self.kind in ANGULAR

    def to_dict(self) -> dict[str, object]:
        """Keys of the JSON: angles in degrees, residual, mdb and sigma in arcsec; lengths in m."""
        big = math.degrees if self.angular else float
        small = RHO_ARCSEC if self.angular else 1.0
        wrapped = self.kind in ANGULAR and self.kind is not ObservationKind.GYRO_CONSTANT
        values = [
            big(wrap_two_pi(value) if wrapped else value)
            for value in (self.observed, self.adjusted)
        ]
        return {
            "kind": str(self.kind),
            "at": self.at,
            "from": self.back or None,
            "to": self.to or None,
            "observed": values[0],
            "adjusted": values[1],
            "residual": self.residual * small,
            "standardized": self.standardized,
            "redundancy": self.redundancy,
            "mdb": None if self.mdb is None else self.mdb * small,
            "mdb_effect_m": self.mdb_effect_m,
            "sigma": self.sigma * small,
            "sigma_adjusted": None if self.left_out else self.sigma_adjusted * small,
            "left_out": self.left_out,
            "unit": "deg" if self.angular else "m",
            "small_unit": "arcsec" if self.angular else "m",
            "group": self.group or str(self.kind),
        }


@dataclass(frozen=True, slots=True)
class Closure:
    """A misclosure found before the adjustment.

    Parameters
    ----------
    kind : str
        ``loop`` | ``connecting`` | ``height``.
    stations : tuple of str
        In order; a loop does not repeat the first one.
    angular : float or None
        Angular misclosure [rad].
    angles : int
        Number of angles in it.
    angular_sigma : float or None
        Its standard deviation from the sigmas of the angles [rad].
    linear_m, length_m : float or None
        Misclosure and length of the route [m]; of a height route the levelled length, None where a
        section has none.
    height_m, height_sigma_m : float or None
        Height misclosure and its standard deviation [m].
    passed : bool or None
        Whether all of it stays within 3 sigma; None where no sigma is known.
    """

    kind: str
    stations: tuple[str, ...]
    angular: float | None = None
    angles: int = 0
    angular_sigma: float | None = None
    linear_m: float | None = None
    length_m: float | None = None
    height_m: float | None = None
    height_sigma_m: float | None = None
    passed: bool | None = None

    @property
    def height_per_sqrt_km(self) -> float | None:
        """Height misclosure over the square root of the length [mm per root of km]."""
        if self.height_m is None or not self.length_m:
            return None
        return self.height_m * 1e3 / math.sqrt(self.length_m / 1e3)

    @property
    def height_allowed_m(self) -> float | None:
        """Largest height misclosure that passes [m]: 3 sigma."""
        return None if self.height_sigma_m is None else SIGMAS * self.height_sigma_m

    def to_dict(self) -> dict[str, object]:
        """Keys of the JSON."""
        relative = None
        if self.linear_m is not None and self.length_m and self.linear_m > 0.0:
            relative = self.length_m / self.linear_m
        arc = None if self.angular is None else self.angular * RHO_ARCSEC
        sigma = None if self.angular_sigma is None else self.angular_sigma * RHO_ARCSEC
        return {
            "kind": self.kind,
            "stations": list(self.stations),
            "angular_arcsec": arc,
            "angles": self.angles,
            "angular_sigma_arcsec": sigma,
            "linear_m": self.linear_m,
            "length_m": self.length_m,
            "relative_1_in": relative,
            "height_m": self.height_m,
            "height_sigma_m": self.height_sigma_m,
            "height_mm_per_sqrt_km": self.height_per_sqrt_km,
            "height_allowed_m": self.height_allowed_m,
            "pass": self.passed,
        }


@dataclass(frozen=True, slots=True)
class SharedValue:
    """An adjusted orientation or gyro constant [rad] with its sigma."""

    kind: str
    name: str
    value: float
    sigma: float

    def to_dict(self) -> dict[str, object]:
        """Keys of the JSON: orientations in degrees, constants in arcsec."""
        orientation = self.kind == "orientation"
        value = math.degrees(wrap_two_pi(self.value)) if orientation else self.value * RHO_ARCSEC
        return {
            "kind": self.kind,
            "name": self.name,
            "deg" if orientation else "arcsec": value,
            "sigma_arcsec": self.sigma * RHO_ARCSEC,
        }


@dataclass(frozen=True, slots=True)
class RelativeEllipse:
    """Standard ellipse of the difference of two points that an observation joins."""

    start: str
    end: str
    ellipse: Ellipse

    def to_dict(self) -> dict[str, object]:
        """Keys of the JSON."""
        return {"from": self.start, "to": self.end, **self.ellipse.to_dict()}


@dataclass(frozen=True, slots=True)
class AdjustmentResult:
    """Everything that the adjustment of a network says.

    Parameters
    ----------
    points : tuple of AdjustedPoint
    observations : tuple of AdjustedObservation
    sigma0 : float or None
        A-posteriori standard deviation of unit weight, in the unit of ``sigma_apriori``.
    dof, defect, iterations : int
    global_test : GlobalTest
    sigma_scale : float
        Factor that stands in every sigma of this result (1 = a priori).
    confidence_scale : float or None
        Factor from a standard ellipse to the ellipse of the stated probability.
    closures : tuple of Closure
    shared : tuple of SharedValue
    relative : tuple of RelativeEllipse
    snooping : Snooping
    warnings : tuple of ResultWarning
    left_out : tuple of LeftOut
        What missed by more than the stated tolerance.
    removals : tuple of Removal
        The removal that helps most first; empty where nothing is suspected.
    """

    points: tuple[AdjustedPoint, ...]
    observations: tuple[AdjustedObservation, ...]
    sigma0: float | None
    dof: int
    defect: int
    iterations: int
    global_test: GlobalTest
    sigma_scale: float
    confidence_scale: float | None
    closures: tuple[Closure, ...]
    shared: tuple[SharedValue, ...]
    relative: tuple[RelativeEllipse, ...]
    snooping: Snooping
    warnings: tuple[ResultWarning, ...] = ()
    left_out: tuple[LeftOut, ...] = ()
    removals: tuple[Removal, ...] = ()

    def point(self, name: str) -> AdjustedPoint:
        """Point by name."""
        return next(item for item in self.points if item.name == name)

    def rows(
        self, table: Literal["points", "observations", "closures"] = "points"
    ) -> list[dict[str, Cell]]:
        """One flat record a point, observation or closure."""
        tables: dict[str, Sequence[Recorded]] = {
            "points": self.points,
            "observations": self.observations,
            "closures": self.closures,
        }
        return rows_of(tables[table])

    def to_dict(self) -> dict[str, object]:
        """Object of ``adjust --json``."""
        return {
            "schema": SCHEMA,
            "points": [item.to_dict() for item in self.points],
            "sigma0": self.sigma0,
            "dof": self.dof,
            "defect": self.defect,
            "iterations": self.iterations,
            "global_test": self.global_test.to_dict(),
            "sigma_scale": self.sigma_scale,
            "confidence_scale": self.confidence_scale,
            "observations": [item.to_dict() for item in self.observations],
            "closures": [item.to_dict() for item in self.closures],
            "shared": [item.to_dict() for item in self.shared],
            "relative_ellipses": [item.to_dict() for item in self.relative],
            "snooping": self.snooping.to_dict(),
            "removals": [item.to_dict() for item in self.removals],
            "checks": [item.to_dict() for item in self.left_out],
            "warnings": [item.to_dict() for item in self.warnings],
        }
