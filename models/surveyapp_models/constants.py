"""Physical constants and reference ellipsoids, each with its source."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

EARTH_RATE: Final = 7.292115e-5
"""Mean angular velocity of the Earth [rad/s].

Source: Groten (2004), Fundamental parameters and current best estimates, J. Geodesy 77:724-797;
the value of GRS 80 and WGS 84.
"""


@dataclass(frozen=True, slots=True)
class Ellipsoid:
    """A rotational ellipsoid.

    Parameters
    ----------
    name : str
        The geodetic name.
    semi_major_m : float
        Semi-major axis a [m].
    inverse_flattening : float
        1/f [-].
    source : str
        Where the two numbers come from.
    """

    name: str
    semi_major_m: float
    inverse_flattening: float
    source: str

    @property
    def flattening(self) -> float:
        """Flattening f [-]."""
        return 1.0 / self.inverse_flattening

    @property
    def first_eccentricity_squared(self) -> float:
        """First eccentricity squared, f (2 - f) [-]."""
        return self.flattening * (2.0 - self.flattening)

    @property
    def second_eccentricity_squared(self) -> float:
        """Second eccentricity squared, e^2 / (1 - e^2) [-]."""
        return self.first_eccentricity_squared / (1.0 - self.first_eccentricity_squared)


WGS84: Final = Ellipsoid("WGS 84", 6378137.0, 298.257223563, "NIMA TR8350.2 (2000), table 3.1")
GRS80: Final = Ellipsoid("GRS 80", 6378137.0, 298.257222101, "Moritz (1980), GRS 80")
