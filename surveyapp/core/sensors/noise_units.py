"""Names and units of noise coefficients: of a gyro, of an accelerometer, of anything else.

Names after IEEE 952 (gyros) and IEEE 1293 (accelerometers).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

from surveyapp.core.sensors.noise_coefficients import Coefficient, nulls
from surveyapp.domain.noise import NoiseCoefficient

_ARCSEC: Final = 180.0 / math.pi * 3600.0
_DEG: Final = 180.0 / math.pi


@dataclass(frozen=True, slots=True)
class Scale:
    """Name, unit and factor from SI of one coefficient."""

    name: str
    unit: str
    factor: float


GYRO: Final = {
    "Q": Scale("quantization_noise", "arcsec", _ARCSEC),
    "N": Scale("angle_random_walk", "deg/sqrt(h)", _DEG * 60.0),
    "B": Scale("bias_instability", "deg/h", _ARCSEC),
    "K": Scale("rate_random_walk", "deg/h/sqrt(h)", _ARCSEC * 60.0),
    "R": Scale("rate_ramp", "deg/h^2", _ARCSEC * 3600.0),
}
"""From rad/s and seconds; a rad/s is 206265 deg/h."""

ACCELEROMETER: Final = {
    "Q": Scale("quantization_noise", "m/s", 1.0),
    "N": Scale("velocity_random_walk", "m/s/sqrt(h)", 60.0),
    "B": Scale("bias_instability", "m/s2", 1.0),
    "K": Scale("acceleration_random_walk", "m/s2/sqrt(h)", 60.0),
    "R": Scale("acceleration_ramp", "m/s2/h", 3600.0),
}


def scales_of(unit: str) -> tuple[dict[str, Scale], float]:
    """Scales of a channel, and the factor from its unit to SI.

    Parameters
    ----------
    unit : str
        rad/s, deg/s, deg/h, m/s2, g, mg, or any other.
    """
    rates = {"rad/s": 1.0, "deg/s": 1.0 / _DEG, "deg/h": 1.0 / _ARCSEC}
    accelerations = {"m/s2": 1.0, "g": 9.80665, "mg": 9.80665e-3}
    if unit in rates:
        return GYRO, rates[unit]
    if unit in accelerations:
        return ACCELEROMETER, accelerations[unit]
    return {
        "Q": Scale("quantization_noise", f"{unit} s", 1.0),
        "N": Scale("random_walk", f"{unit}/sqrt(Hz)", 1.0),
        "B": Scale("bias_instability", unit, 1.0),
        "K": Scale("rate_random_walk", f"{unit}/sqrt(s)", 1.0),
        "R": Scale("rate_ramp", f"{unit}/s", 1.0),
    }, 1.0


def named_coefficients(
    found: tuple[Coefficient, ...] | None, *, unit: str
) -> tuple[NoiseCoefficient, ...]:
    """Coefficients in the units of their kind; without a unit all null, reason ``unit``."""
    if unit in ("1", "LSB") or found is None:
        found, unit = nulls("unit"), unit if unit != "1" else "rad/s"
        scales, _ = scales_of(unit)
        return tuple(
            NoiseCoefficient(scales[c.symbol].name, c.symbol, None, None, "1", c.reason)
            for c in found
        )
    scales, si = scales_of(unit)
    named = []
    for item in found:
        scale = scales[item.symbol]
        factor = si * scale.factor
        named.append(
            NoiseCoefficient(
                scale.name,
                item.symbol,
                None if item.value is None else item.value * factor,
                None if item.sigma is None else item.sigma * factor,
                scale.unit,
                item.reason,
            )
        )
    return tuple(named)
