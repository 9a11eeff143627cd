"""A direction with its sigma as results hold it, and the numbers of their JSON.

Radians inside; decimal degrees, small quantities in arc-seconds, and None where something is not
determined in the JSON, never NaN.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal

from surveyapp_models.angles import RHO_ARCSEC, wrap_two_pi

Reference = Literal["GYRO", "ASTRONOMIC", "GEODETIC", "GRID", "MAGNETIC"]


def finite(value: float | None) -> float | None:
    """Replace what is not a finite number by None."""
    return value if value is not None and math.isfinite(value) else None


def to_degrees(angle: float | None) -> float | None:
    """Decimal degrees in [0, 360) of an angle [rad]."""
    if finite(angle) is None or angle is None:
        return None
    degrees = math.degrees(wrap_two_pi(angle))
    return 0.0 if degrees >= 360.0 else degrees


def to_arcsec(angle: float | None) -> float | None:
    """Arc-seconds of an angle [rad], None where it is not determined."""
    return None if finite(angle) is None or angle is None else angle * RHO_ARCSEC


@dataclass(frozen=True, slots=True)
class AngleResult:
    """A direction with its sigma.

    Parameters
    ----------
    value : float
        [rad] in [0, 2 pi).
    sigma, interval95 : float
        One standard deviation; half-width of the 95 % interval [rad]. Infinite where nothing tells.
    dof : float
        Effective degrees of freedom.
    reference : str or None
        What the azimuth refers to; None for a circle reading.
    """

    value: float
    sigma: float
    interval95: float
    dof: float = math.inf
    reference: Reference | None = None

    @property
    def deg(self) -> float:
        """Value in decimal degrees, [0, 360)."""
        return to_degrees(self.value) or 0.0

    @property
    def arcsec(self) -> float:
        """Value in arc-seconds, [0, 1296000)."""
        return self.deg * 3600.0

    @property
    def sigma_arcsec(self) -> float | None:
        """One standard deviation in arc-seconds, None where nothing tells it."""
        return to_arcsec(self.sigma)

    @property
    def interval95_arcsec(self) -> float | None:
        """Half-width of the 95 % interval in arc-seconds, None where nothing tells it."""
        return to_arcsec(self.interval95)

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        result: dict[str, Any] = {
            "deg": to_degrees(self.value),
            "sigma_arcsec": to_arcsec(self.sigma),
            "interval95_arcsec": to_arcsec(self.interval95),
        }
        if self.reference is not None:
            result["reference"] = self.reference
        return result
