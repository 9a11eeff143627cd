"""What a session says while it is observed: the values that screens show. Nothing is computed here.

The observation of every method fills one ``Progress``; ``observing.by_method`` chooses who.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from surveyapp.core.observing.forecast import PointForecast
from surveyapp.core.observing.passage_forecast import PassageForecast
from surveyapp.core.observing.run_alert import Alert


@dataclass(frozen=True, slots=True)
class Point:
    """One turning point, or round, of a run under observation.

    Readings, offsets and residuals in radians, those of a scale in divisions.
    """

    seq: int
    index: int
    side: Literal["L", "R", ""]
    reading: float
    offset: float
    residual: float | None


@dataclass(frozen=True, slots=True)
class Progress:
    """What is known of a run that is being observed.

    Parameters
    ----------
    points : tuple of Point
        ``offset`` is the reading relative to ``origin``, unwrapped.
    scale : bool
        Whether points, forecast, curve, middle, Schuler means and channels are divisions of the
        gyro scale and not angles.
    origin : float
        First reading [rad]; 0 on the scale.
    next : PointForecast or None
        Next turning point; None before the first, and where nothing swings.
    next_reading : float or None
        Its circle reading [rad] in [0, 2 pi), or scale reading [div].
    passage : PassageForecast or None
        Next timed passage.
    period_s : float or None
        T1 (clamped: T2) in force, from card, latitude and points.
    schuler_means : tuple of float
    time_differences : tuple of float
        East minus west of every three passages in a row [s].
    north : float or None
        Gyro north (``delivered``: the gyro azimuth) as ``orient`` would give it now [rad].
    delivered : bool
    interval95, interval95_two_more : float or None
        Half-width now, and expected after two more points [rad]; None where nothing tells.
    sigma_source : str or None
    missing : str
        Why there is no north although there are readings enough, empty where there is one.
    midpoint, amplitude : tuple of float
        Residuals in the two channels.
    curve : tuple of (float, float)
        The swing with its forecast: number of half swings, offset.
    middle : float or None
        Middle of the swing relative to ``origin``, without the tape-zero correction.
    alert : Alert or None
    """

    points: tuple[Point, ...] = ()
    scale: bool = False
    origin: float = 0.0
    next: PointForecast | None = None
    next_reading: float | None = None
    passage: PassageForecast | None = None
    period_s: float | None = None
    schuler_means: tuple[float, ...] = ()
    time_differences: tuple[float, ...] = ()
    north: float | None = None
    delivered: bool = False
    interval95: float | None = None
    interval95_two_more: float | None = None
    sigma_source: str | None = None
    missing: str = ""
    midpoint: tuple[float, ...] = ()
    amplitude: tuple[float, ...] = ()
    curve: tuple[tuple[float, float], ...] = ()
    middle: float | None = None
    alert: Alert | None = None

    @property
    def due_s(self) -> float | None:
        """Moment of what is waited for: the next passage, else the next turning point [s]."""
        if self.passage is not None:
            return self.passage.moment_s
        return None if self.next is None else self.next.moment_s

    def enough(self, target: float | None) -> bool:
        """Whether the interval is at or below the wanted one [rad]."""
        return target is not None and self.interval95 is not None and self.interval95 <= target
