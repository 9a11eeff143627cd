"""One reading taken over from a total station on the cable, and a turning point that was followed.

Angles in radians, lengths in metres. Nothing here knows a protocol.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from surveyapp_models.angles import RHO_ARCSEC


@dataclass(frozen=True, slots=True)
class InstrumentReading:
    """What the instrument answered.

    Parameters
    ----------
    hz : float
        Circle reading [rad].
    v : float or None
        From the zenith, face right from pi on [rad].
    slope_distance : float or None
        As the instrument gives it, its own corrections inside [m].
    source : str
        Protocol and port.
    """

    hz: float
    v: float | None
    slope_distance: float | None
    source: str

    @property
    def face(self) -> str:
        """``L``, ``R`` or empty without a vertical reading."""
        if self.v is None:
            return ""
        return "R" if self.v > math.pi else "L"

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON, schema ``surveyapp.instrument/1``."""
        return {
            "schema": "surveyapp.instrument/1",
            "hz_deg": math.degrees(self.hz),
            "v_deg": None if self.v is None else math.degrees(self.v),
            "slope_distance_m": self.slope_distance,
            "face": self.face or None,
            "source": self.source,
            "turning_point": None,
        }


@dataclass(frozen=True, slots=True)
class FollowedTurn:
    """A turning point from following readings.

    Parameters
    ----------
    value : float
        Circle reading at the turn [rad].
    sigma : float
        Its standard deviation, the slowness of the follower in it [rad].
    moment_s : float
        Of the turn, seconds after the first reading.
    moment_sigma_s : float
    readings : int
    curvature : float
        Second derivative at the turn [rad/s^2]; positive at the smallest reading.
    """

    value: float
    sigma: float
    moment_s: float
    moment_sigma_s: float
    readings: int
    curvature: float

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "value_deg": math.degrees(self.value),
            "sigma_arcsec": self.sigma * RHO_ARCSEC,
            "moment_s": self.moment_s,
            "moment_sigma_s": self.moment_sigma_s,
            "readings": self.readings,
            "side": "L" if self.curvature > 0.0 else "R",
        }
