"""State of motion of a vehicle from its inertial record, schema ``surveyapp.motion/1``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final, Literal

from surveyapp.domain.warning import ResultWarning
from surveyapp_models.arrays import Floats

MOTION_SCHEMA: Final = "surveyapp.motion/1"
State = Literal["stationary", "steady", "accelerating", "braking", "turning"]
STATES: Final[tuple[State, ...]] = (
    "stationary",
    "steady",
    "accelerating",
    "braking",
    "turning",
)


@dataclass(frozen=True, slots=True)
class MotionSegment:
    """One state from ``start_s`` to ``end_s`` of the log's time."""

    start_s: float
    end_s: float
    state: State

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {"start_s": self.start_s, "end_s": self.end_s, "state": self.state}


@dataclass(frozen=True, slots=True)
class Snapped:
    """One correction of the path.

    Parameters
    ----------
    from_m, to_m : float
        Along the path.
    kind : str
        linear (drift since the stop before) | constant (since a power cycle).
    heading_deg : float
        Correction at its end.
    """

    from_m: float
    to_m: float
    kind: Literal["linear", "constant"]
    heading_deg: float

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "from_m": self.from_m,
            "to_m": self.to_m,
            "kind": self.kind,
            "heading_deg": self.heading_deg,
        }


@dataclass(frozen=True, slots=True)
class Path:
    """Where the vehicle went.

    Parameters
    ----------
    mode : str
        inertial | odometer
    closure_m : float or None
        From the end to where it should be: the stated point, else the beginning.
    end_m : tuple of float
        East, north, up of the end; from the beginning where none is stated.
    sides_m : tuple of float
        Straight distances between successive stops.
    points : ndarray, shape (m, 6)
        Distance, east, north, their sigmas [m], the covariance of east and north [m2]; in steps of
        half a metre with an odometer.
    length_m : float
    """

    mode: Literal["inertial", "odometer"]
    closure_m: float | None
    end_m: tuple[float, ...]
    sides_m: tuple[float, ...]
    points: Floats
    length_m: float

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        names = ("distance_m", "e", "n", "sigma_e_m", "sigma_n_m", "covariance_en_m2")
        return {
            "mode": self.mode,
            "closure_m": self.closure_m,
            "end_m": list(self.end_m),
            "sides_m": list(self.sides_m),
            "length_m": self.length_m,
            "points": [dict(zip(names, p, strict=True)) for p in self.points.tolist()],
        }


@dataclass(frozen=True, slots=True)
class Motion:
    """Result of ``motion``.

    Parameters
    ----------
    source : str
    n : int
    rate_hz : float
    segments : tuple of MotionSegment
    false_alarm : float
        Stated, of a window at rest called moving.
    thresholds : mapping of str to float
        Of the tests, in their own units.
    detectors : mapping
        Agreement of the two rest detectors; ready for JSON.
    path : Path or None
    zero_velocity : mapping or None
        Test of the gate by its innovations; ready for JSON.
    snapped : tuple of Snapped
    warnings : tuple of ResultWarning
    met : bool
        False ends with exit 1.
    sha256 : str
    """

    source: str
    n: int
    rate_hz: float
    segments: tuple[MotionSegment, ...]
    false_alarm: float
    thresholds: Mapping[str, float]
    detectors: Mapping[str, Any]
    path: Path | None = None
    zero_velocity: Mapping[str, Any] | None = None
    snapped: tuple[Snapped, ...] = ()
    warnings: tuple[ResultWarning, ...] = ()
    met: bool = True
    sha256: str = ""

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON, schema ``surveyapp.motion/1``."""
        return {
            "schema": MOTION_SCHEMA,
            "source": self.source,
            "sha256": self.sha256,
            "n": self.n,
            "rate_hz": self.rate_hz,
            "segments": [s.to_dict() for s in self.segments],
            "false_alarm": self.false_alarm,
            "thresholds": dict(self.thresholds),
            "detectors": dict(self.detectors),
            "path": None if self.path is None else self.path.to_dict(),
            "zero_velocity": None if self.zero_velocity is None else dict(self.zero_velocity),
            "snapped": [s.to_dict() for s in self.snapped],
            "warnings": [w.to_dict() for w in self.warnings],
        }
