"""Azimuths that know what they refer to: deflection of the vertical, references, latitude limits.

Signs as in design.md section 2: grid = true - deflection - convergence - arc_to_chord.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from surveyapp.domain.project import Deflection
from surveyapp.domain.results import Reference
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said
from surveyapp_models.angles import wrap_pi

MAX_LATITUDE_DEG = 75.0
WARN_LATITUDE_DEG = 70.0
"""physics.md 1.5: a maker's limit, not a singularity."""


@dataclass(frozen=True, slots=True)
class DeflectionTerm:
    """Deflection correction of one azimuth: A_geodetic = A_astronomic - value.

    Parameters
    ----------
    value : float
        [rad].
    by_xi, by_eta : float
        Its derivatives with respect to the two components [-].
    """

    value: float
    by_xi: float
    by_eta: float


def deflection_term(
    deflection: Deflection, *, latitude: float, azimuth: float, zenith: float
) -> DeflectionTerm:
    """Deflection term eta tan(phi) + (xi sin A - eta cos A) cot z.

    Source: physics.md 3.5; Torge & Mueller (2012), Geodesy, 4th ed., eq. 6.18.

    ``latitude``, ``azimuth``, ``zenith`` [rad].
    """
    cot_z = math.cos(zenith) / math.sin(zenith)
    by_xi = math.sin(azimuth) * cot_z
    by_eta = math.tan(latitude) - math.cos(azimuth) * cot_z
    return DeflectionTerm(by_xi * deflection.xi + by_eta * deflection.eta, by_xi, by_eta)


@dataclass(frozen=True, slots=True)
class Azimuth:
    """An azimuth that knows what it refers to.

    Parameters
    ----------
    value : float
        [rad], clockwise.
    reference : str
        GYRO, ASTRONOMIC, GEODETIC, GRID or MAGNETIC.
    """

    value: float
    reference: Reference

    def with_constant(self, constant: float) -> Azimuth:
        """GYRO to ASTRONOMIC: add the instrument constant [rad]."""
        return self._moved("GYRO", "ASTRONOMIC", constant)

    def without_deflection(self, deflection: float) -> Azimuth:
        """ASTRONOMIC to GEODETIC: subtract the deflection term [rad]."""
        return self._moved("ASTRONOMIC", "GEODETIC", -deflection)

    def to_grid(self, *, convergence: float, arc_to_chord: float) -> Azimuth:
        """GEODETIC to GRID: subtract convergence and arc-to-chord [rad]."""
        return self._moved("GEODETIC", "GRID", -convergence - arc_to_chord)

    def minus(self, other: Azimuth) -> float:
        """Difference [rad] in (-pi, pi] of two azimuths of one reference."""
        if other.reference != self.reference:
            raise SurveyError(_mixed(self.reference, other.reference))
        return wrap_pi(self.value - other.value)

    def _moved(self, needed: Reference, result: Reference, change: float) -> Azimuth:
        if self.reference != needed:
            raise SurveyError(_mixed(self.reference, needed))
        return Azimuth(self.value + change, result)


def _mixed(found: Reference, expected: Reference) -> Problem:
    return Problem(
        what="azimuths of different reference cannot be mixed",
        found=found,
        expected=expected,
        hint="Declination belongs to MAGNETIC, the instrument constant to GYRO, "
        "the deflection to ASTRONOMIC, the convergence to GEODETIC.",
    )


def latitude_problem(latitude: float, where: str) -> Problem | None:
    """Refuse a latitude at which a suspended gyro does not work; None where it does.

    ``latitude`` [rad].
    """
    if abs(math.degrees(latitude)) <= MAX_LATITUDE_DEG:
        return None
    return Problem(
        what="a suspended gyro is not used beyond latitude 75 degrees",
        where=where,
        found=said("latitude {latitude:.4f} degrees", latitude=math.degrees(latitude)),
        expected="at most 75 degrees north or south",
        hint="The meridian-seeking moment is below 26 % of that at the equator there; "
        "check the coordinates, or set latitude_max_deg in the instrument's [range].",
    )
