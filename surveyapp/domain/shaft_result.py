"""The orientation through shafts: what ``shaft`` prints, schema ``surveyapp.shaft/1``.

Radians and metres (millimetres where the trade speaks of them); ``to_dict`` gives the JSON.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from surveyapp.domain.angle_result import finite, to_arcsec, to_degrees
from surveyapp.domain.shaft import CHECK_IDS, PlumbingCheck
from surveyapp.domain.warning import ResultWarning


@dataclass(frozen=True, slots=True)
class WireRest:
    """Rest position of a swinging wire on its scales [mm], and its period [s]."""

    name: str
    x_mm: float | None
    sigma_x_mm: float | None
    y_mm: float | None
    sigma_y_mm: float | None
    period_s: float

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "name": self.name,
            "x_mm": finite(self.x_mm),
            "sigma_x_mm": finite(self.sigma_x_mm),
            "y_mm": finite(self.y_mm),
            "sigma_y_mm": finite(self.sigma_y_mm),
            "period_s": self.period_s,
        }


@dataclass(frozen=True, slots=True)
class TriangleCheck:
    """Distance of the wires, measured against computed from the triangle.

    Parameters
    ----------
    place, station : str
    f_mm, limit_mm : float
    passed : bool
    gamma : float
        Angle at the station between the wires [rad].
    ratio : float
        Distance to the nearer wire over the distance of the wires.
    """

    place: str
    station: str
    f_mm: float
    limit_mm: float
    passed: bool
    gamma: float
    ratio: float

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "place": self.place,
            "station": self.station,
            "f_mm": self.f_mm,
            "limit_mm": self.limit_mm,
            "pass": self.passed,
            "gamma_deg": to_degrees(self.gamma),
        }


@dataclass(frozen=True, slots=True)
class ScaleCheck:
    """Distance of two shafts above against below, plumb convergence removed."""

    misclosure_mm: float
    limit_mm: float
    passed: bool

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "misclosure_mm": self.misclosure_mm,
            "limit_mm": self.limit_mm,
            "pass": self.passed,
        }


@dataclass(frozen=True, slots=True)
class DepthCheck:
    """Depth by two determinations.

    Parameters
    ----------
    m : float
        Mean [m].
    sigma_m : float or None
        Of the mean; None where nothing was measured.
    difference_mm : float or None
    limit_mm : float
        h/8 with h in metres.
    passed : bool or None
    """

    m: float
    sigma_m: float | None
    difference_mm: float | None
    limit_mm: float
    passed: bool | None

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "m": self.m,
            "sigma_m": finite(self.sigma_m),
            "difference_mm": finite(self.difference_mm),
            "limit_mm": self.limit_mm,
            "pass": self.passed,
        }


@dataclass(frozen=True, slots=True)
class SideAzimuth:
    """Grid azimuth of a side with its sigma [rad]."""

    value: float
    sigma: float

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {"deg": to_degrees(self.value), "sigma_arcsec": to_arcsec(self.sigma)}


@dataclass(frozen=True, slots=True)
class JointAzimuth:
    """Wires and gyro together.

    Parameters
    ----------
    azimuth : SideAzimuth or None
        None where they contradict each other: then nothing is averaged.
    chi2 : float or None
        None where there is only one of them.
    dof : int
    consistent : bool or None
    """

    azimuth: SideAzimuth | None
    chi2: float | None
    dof: int
    consistent: bool | None

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        found = self.azimuth
        return {
            "deg": None if found is None else to_degrees(found.value),
            "sigma_arcsec": None if found is None else to_arcsec(found.sigma),
            "chi2": finite(self.chi2),
            "dof": self.dof,
            "consistent": self.consistent,
        }


@dataclass(frozen=True, slots=True)
class PlumbedPoint:
    """A point below with its position in the frame of the surface points [m].

    ``sigma_m`` is of east and north together, sqrt(sigma_E^2 + sigma_N^2), relative to the surface
    points with coordinates.
    """

    station: str
    e: float
    n: float
    sigma_m: float

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {"station": self.station, "e": self.e, "n": self.n, "sigma_m": self.sigma_m}


@dataclass(frozen=True, slots=True)
class ShaftBudgetLine:
    """Share of one source in the sigma of the orientation through a shaft [rad]."""

    shaft: str
    source: str
    sigma: float
    share: float

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "shaft": self.shaft,
            "source": self.source,
            "sigma_arcsec": to_arcsec(self.sigma),
            "share": finite(self.share),
        }


@dataclass(frozen=True, slots=True)
class ShaftDrawing:
    """What a picture of a shaft shows.

    Parameters
    ----------
    swings : tuple of (wire, axis, readings)
        Turning points in order [mm].
    triangles : tuple of (place, points)
        Names with east and north of each connecting triangle [m].
    """

    swings: tuple[tuple[str, str, tuple[float, ...]], ...] = ()
    triangles: tuple[tuple[str, tuple[tuple[str, float, float], ...]], ...] = ()


@dataclass(frozen=True, slots=True)
class ShaftOrientation:
    """One shaft, or one pair of shafts.

    Parameters
    ----------
    id, kind : str
    at, to : str
        The oriented side.
    azimuth : SideAzimuth
        By the wires.
    wires : tuple of WireRest
    triangles : tuple of TriangleCheck
    scale : ScaleCheck or None
    convergence_mm : float
    depth : DepthCheck
    gyro : SideAzimuth or None
    combined : JointAzimuth
    budget : tuple of ShaftBudgetLine
    checks : tuple of PlumbingCheck
    points : tuple of PlumbedPoint
        Ends of the oriented side whose place is determined.
    drawing : ShaftDrawing
        Not in the JSON.
    """

    id: str
    kind: str
    at: str
    to: str
    azimuth: SideAzimuth
    wires: tuple[WireRest, ...]
    triangles: tuple[TriangleCheck, ...]
    scale: ScaleCheck | None
    convergence_mm: float
    depth: DepthCheck
    gyro: SideAzimuth | None
    combined: JointAzimuth
    budget: tuple[ShaftBudgetLine, ...]
    checks: tuple[PlumbingCheck, ...] = ()
    points: tuple[PlumbedPoint, ...] = ()
    drawing: ShaftDrawing = field(default_factory=ShaftDrawing)

    @property
    def passed(self) -> bool:
        """Whether triangles, scale, depth and the joint survey all pass."""
        verdicts = [item.passed for item in self.triangles]
        verdicts += [] if self.scale is None else [self.scale.passed]
        verdicts += [self.depth.passed is not False, self.combined.consistent is not False]
        return all(verdicts)

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        recorded = {check.id: check for check in self.checks}
        return {
            "id": self.id,
            "kind": self.kind,
            "azimuth": {"at": self.at, "to": self.to, **self.azimuth.to_dict()},
            "wires": [wire.to_dict() for wire in self.wires],
            "triangles": [item.to_dict() for item in self.triangles],
            "scale": None if self.scale is None else self.scale.to_dict(),
            "convergence_mm": self.convergence_mm,
            "depth": self.depth.to_dict(),
            "gyro": None if self.gyro is None else self.gyro.to_dict(),
            "combined": self.combined.to_dict(),
            "points": [item.to_dict() for item in self.points],
            "checks": [_check_dict(recorded.get(name, PlumbingCheck(name))) for name in CHECK_IDS],
        }


def _check_dict(check: PlumbingCheck) -> dict[str, Any]:
    return {
        "id": check.id,
        "done": bool(check.done_at),
        "done_at": check.done_at or None,
        "by": check.by or None,
        "note": check.note or None,
    }


@dataclass(frozen=True, slots=True)
class ShaftResult:
    """Everything that ``shaft`` finds."""

    project: str
    software: str
    input_sha256: str
    shafts: tuple[ShaftOrientation, ...]
    warnings: tuple[ResultWarning, ...] = field(default=())

    @property
    def passed(self) -> bool:
        """Whether every check of every shaft passes."""
        return all(shaft.passed for shaft in self.shafts)

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON, schema ``surveyapp.shaft/1``."""
        return {
            "schema": "surveyapp.shaft/1",
            "project": self.project,
            "software": self.software,
            "input_sha256": self.input_sha256,
            "shafts": [shaft.to_dict() for shaft in self.shafts],
            "budget": [line.to_dict() for shaft in self.shafts for line in shaft.budget],
            "warnings": [warning.to_dict() for warning in self.warnings],
        }
