"""Lateral refraction of a sight along a mine wall: how far a target appears beside its place.

A wall that is warmer or colder than the air makes a horizontal temperature gradient; the ray bends
towards the cold side, so that the target appears displaced towards the warm side.
"""

from __future__ import annotations

from typing import Final

KELVIN: Final = 273.15
REFRACTIVITY_K_PER_HPA: Final = 78.9e-6
"""n - 1 = 78.9e-6 p/T for visible light, dry air [K/hPa] (penetration.md section 1)."""


def curvature_per_gradient(*, pressure_hpa: float, temperature_c: float) -> float:
    """Curvature of a ray per horizontal temperature gradient [1/m per K/m].

    kappa = 78.9e-6 p / T^2 dT/dx, from n - 1 = 78.9e-6 p/T: 9.6285e-7 at 1013.25 hPa, 15 C.
    """
    temperature = temperature_c + KELVIN
    return REFRACTIVITY_K_PER_HPA * pressure_hpa / (temperature * temperature)


def sight_displacement(length_m: float, *, at_station: float, at_target: float) -> float:
    """Angle by which a target appears displaced towards the warm side [rad].

    Parameters
    ----------
    length_m : float
        Length of the sight [m].
    at_station, at_target : float
        Curvature at both ends [1/m]; it changes linearly between them.

    Notes
    -----
    y'' = kappa(s) from station to target, y = 0 at both: the tangent at the station makes the
    angle s (kappa_i/3 + kappa_j/6) with the chord.
    """
    return length_m * (at_station / 3.0 + at_target / 6.0)
