"""Planning the constant of a gyro on a total station: equation 15 of source 001."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Final

from surveyapp_models.angles import ARCSEC

SAMPLES_OF_STABILITY: Final = 1000.0
"""Samples behind the 10 s bias stability at 100 Hz: one sample has its sqrt(1000) fold (eq. 13)."""
BIAS_STABILITY_DEG_H: Final = 0.05
"""Of the source's gyro over 10 s."""
ELEVATION_DEG: Final = 10.0
RATE_DEG_S: Final = 30.0
SAMPLES: Final = 300
RELATIVE_RATE_SIGMA: Final = 1e-4
"""The source's own example: v = 10 degrees, 30 deg/s, 300 samples, a rate good to 1e-4."""
_DEG_H = math.radians(1.0) / 3600.0


def elevation_sigma(
    *,
    elevation: float,
    rate: float,
    samples: float,
    relative_rate_sigma: float,
    bias_stability: float = BIAS_STABILITY_DEG_H * _DEG_H,
) -> float:
    """Standard deviation of the elevation [rad]. Source: Yu, Wang and Wang 2016, equation 15.

    Parameters
    ----------
    elevation : float
        [rad]
    rate : float
        Of the table, both ways [rad/s].
    samples : float
        Each way (2nm).
    relative_rate_sigma : float
        Of the table's rate.
    bias_stability : float
        Over 10 s at 100 Hz [rad/s].
    """
    noise = 0.5 * SAMPLES_OF_STABILITY * bias_stability**2  # eq. 15, first term
    first = noise / (samples * rate**2 * math.cos(elevation) ** 2)
    second = 0.5 * (math.tan(elevation) * relative_rate_sigma) ** 2  # eq. 15, second term
    return math.sqrt(first + second)


@dataclass(frozen=True, slots=True)
class Curve:
    """One curve of the plan: abscissa and sigma [arcsec]."""

    figure: int
    title: str
    abscissa: str
    rate_deg_s: float
    points: tuple[tuple[float, float], ...]

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "figure": self.figure,
            "title": self.title,
            "abscissa": self.abscissa,
            "rate_deg_s": self.rate_deg_s,
            "points": [{"x": x, "sigma_arcsec": y} for x, y in self.points],
        }


@dataclass(frozen=True, slots=True)
class FogStationPlan:
    """What a programme would reach.

    Parameters
    ----------
    elevation_deg, rate_deg_s : float
    samples : int
    relative_rate_sigma : float
    sigma_arcsec, second_pass_arcsec : float
        Of one pass, and of a second one near level.
    curves : tuple of Curve
        The source's figures 4 to 6.
    """

    elevation_deg: float
    rate_deg_s: float
    samples: int
    relative_rate_sigma: float
    sigma_arcsec: float
    second_pass_arcsec: float
    curves: tuple[Curve, ...]

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "schema": "surveyapp.calibrate/1",
            "kind": "fog-station-plan",
            "elevation_deg": self.elevation_deg,
            "rate_deg_s": self.rate_deg_s,
            "samples": self.samples,
            "relative_rate_sigma": self.relative_rate_sigma,
            "bias_stability_deg_h": BIAS_STABILITY_DEG_H,
            "sigma_arcsec": self.sigma_arcsec,
            "second_pass_sigma_arcsec": self.second_pass_arcsec,
            "figures": [curve.to_dict() for curve in self.curves],
        }


def plan_fog_station(
    *,
    elevation_deg: float = ELEVATION_DEG,
    rate_deg_s: float = RATE_DEG_S,
    samples: int = SAMPLES,
    relative_rate_sigma: float = RELATIVE_RATE_SIGMA,
) -> FogStationPlan:
    """Sigma of one and of two passes, and the source's figures 4 to 6 around it."""

    def sigma(v: float, w: float, n: float, r: float) -> float:
        found = elevation_sigma(
            elevation=math.radians(v), rate=math.radians(w), samples=n, relative_rate_sigma=r
        )
        return found / ARCSEC

    counts = (10, 20, 40, 80, 150, 300, 600, 1200)
    elevations = (0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 6.6, 7.0, 8.0, 9.0, 10.0)
    errors = (1e-5, 2e-5, 5e-5, 1e-4, 2e-4, 5e-4, 1e-3)
    v, w, n, r = elevation_deg, rate_deg_s, samples, relative_rate_sigma
    curves = [
        Curve(
            4,
            f"figure 4: samples each way, elevation {v:g} degrees, {rate:g} deg/s",
            "samples",
            rate,
            tuple((float(k), sigma(v, rate, k, r)) for k in counts),
        )
        for rate in dict.fromkeys((10.0, 30.0, 120.0, w))
    ]
    points = tuple((e, sigma(e, w, n, r)) for e in elevations)
    curves.append(Curve(5, f"figure 5: elevation, {w:g} deg/s", "elevation_deg", w, points))
    points = tuple((e, sigma(v, w, n, e)) for e in errors)
    title = f"figure 6: relative error of the rate, elevation {v:g} degrees, {w:g} deg/s"
    curves.append(Curve(6, title, "relative_rate_sigma", w, points))
    one = sigma(v, w, n, r)
    left = math.degrees(one * ARCSEC)  # where the second pass stands
    return FogStationPlan(v, w, n, r, one, sigma(left, w, n, r), tuple(curves))
