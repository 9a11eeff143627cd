"""Planning the stops of a vehicle: how long, how often, and what heading that leaves.

A stop of T seconds leaves a rate of N / sqrt(T), never less than the instability of the bias, and
a heading of that rate over the level earth rate. Temperature control is the other way to a small
instability: it costs power and warm-up, indexing costs a moving part; neither is planned here.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Final

from surveyapp_models.constants import EARTH_RATE

STOPS_S: Final = (10.0, 20.0, 30.0, 50.0, 100.0, 170.0, 200.0, 300.0)
SPACINGS_M: Final = (0.0, 10.0, 20.0, 30.0, 50.0, 100.0)
"""Of source 004."""
DELTAS_DEG_H: Final = (0.01, 0.05, 0.08, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0)
ROUTE_M: Final = 1000.0
SPEED_M_S: Final = 1.0
"""Of a vehicle between stops: a walking pace underground."""
_EARTH_DEG_H = math.degrees(EARTH_RATE) * 3600.0


@dataclass(frozen=True, slots=True)
class Grade:
    """A grade of gyro.

    Parameters
    ----------
    id, title : str
    repeatability_deg_h : float
        From switching on to switching on.
    instability_deg_h : float
        Of the bias in one run.
    walk_deg_sqrt_h : float
        Angle random walk.
    source : str
    """

    id: str
    title: str
    repeatability_deg_h: float
    instability_deg_h: float
    walk_deg_sqrt_h: float
    source: str

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "id": self.id,
            "title": self.title,
            "repeatability_deg_h": self.repeatability_deg_h,
            "instability_deg_h": self.instability_deg_h,
            "walk_deg_sqrt_h": self.walk_deg_sqrt_h,
            "source": self.source,
        }


_OF_004 = "source 004: repeatability and instability; its walk is an example"
GRADES: Final = {
    grade.id: grade
    for grade in (
        Grade("mems", "MEMS gyro", 20.0, 0.2, 0.15, _OF_004),
        Grade("mems-example", "MEMS gyro of the example", 20.0, 0.05, 0.15, _OF_004),
        Grade("apogee-a", "Apogee-A", 20.0, 0.08, 0.15, _OF_004),
        Grade("fog-low", "fibre-optic gyro, low grade", 2.0, 0.2, 0.05, _OF_004),
        Grade("fog", "fibre-optic gyro, medium to high grade", 0.01, 0.01, 0.005, _OF_004),
    )
}


@dataclass(frozen=True, slots=True)
class PlannedStop:
    """One line of the plan; lateral is None where the vehicle does not move."""

    stop_s: float
    spacing_m: float
    heading_sd_deg: float
    lateral_sd_m: float | None
    hours: float | None
    enough: bool | None

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "stop_s": self.stop_s,
            "spacing_m": self.spacing_m,
            "heading_sd_deg": self.heading_sd_deg,
            "lateral_sd_m": self.lateral_sd_m,
            "hours": self.hours,
            "enough": self.enough,
        }


@dataclass(frozen=True, slots=True)
class StopPlan:
    """A plan; ``pointing`` is bias [deg/h] and arctan(bias / level earth rate) [deg]."""

    grade: Grade
    latitude_deg: float
    want_deg: float | None
    route_m: float
    rows: tuple[PlannedStop, ...]
    pointing: tuple[tuple[float, float], ...]
    words: str

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON, schema ``surveyapp.north/1``."""
        return {
            "schema": "surveyapp.north/1",
            "method": "plan",
            "grade": self.grade.to_dict(),
            "latitude_deg": self.latitude_deg,
            "want_deg": self.want_deg,
            "route_m": self.route_m,
            "plan": [row.to_dict() for row in self.rows],
            "pointing": [{"bias_deg_h": d, "theta_deg": t} for d, t in self.pointing],
            "grades": [grade.to_dict() for grade in GRADES.values()],
        }


def heading_sd(stop_s: float, grade: Grade, *, latitude: float) -> float:
    """Standard deviation of the heading after one stop [rad].

    Parameters
    ----------
    stop_s : float
    grade : Grade
    latitude : float
        [rad]
    """
    rate = grade.walk_deg_sqrt_h / math.sqrt(stop_s / 3600.0)
    return rate / (_EARTH_DEG_H * math.cos(latitude))


def pointing(bias_deg_h: float, *, latitude: float) -> float:
    """Pointing error of a bias [rad], arctan: at a bias of the whole earth rate 45 degrees."""
    return math.atan(bias_deg_h / (_EARTH_DEG_H * math.cos(latitude)))


def plan_stops(
    grade: Grade, *, latitude_deg: float, want_deg: float | None, route_m: float = ROUTE_M
) -> StopPlan:
    """Every stop by every spacing.

    Headings of different stops are independent, so the lateral error of a route of n stretches of
    d metres is d sqrt(n) times the heading's.
    """
    latitude = math.radians(latitude_deg)
    rows = []
    for stop in STOPS_S:
        sd = heading_sd(stop, grade, latitude=latitude)
        for spacing in SPACINGS_M:
            enough = None if want_deg is None else math.degrees(sd) <= want_deg
            lateral = hours = None
            if spacing > 0.0:
                count = max(route_m / spacing, 1.0)
                lateral = min(sd, 1.0) * spacing * math.sqrt(count)
                hours = (count * stop + route_m / SPEED_M_S) / 3600.0
            rows.append(PlannedStop(stop, spacing, math.degrees(sd), lateral, hours, enough))
    table = tuple((d, math.degrees(pointing(d, latitude=latitude))) for d in DELTAS_DEG_H)
    floor = math.degrees(pointing(grade.instability_deg_h, latitude=latitude))
    words = (
        f"The instability of {grade.instability_deg_h:g} deg/h alone leaves {floor:.2f} degrees, "
        "however long the stop. Temperature control lowers it at the cost of power and warm-up."
    )
    return StopPlan(grade, latitude_deg, want_deg, route_m, tuple(rows), table, words)
