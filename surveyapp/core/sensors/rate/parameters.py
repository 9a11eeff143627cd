"""Parameters of rate sensors under their names in results: IEEE Std 952 and 1554 terms.

Scale factors in ppm from one, misalignments in arc-seconds (gyro x to a rate about y is ``xy``),
biases in degrees per hour; of accelerometers m/s2. NaN becomes "not determined".
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from surveyapp.core.sensors.rate.accelerometers import AccelerometerTriad
from surveyapp.core.sensors.rate.six_position import GyroTriad
from surveyapp.domain.calibration import SensorParameter
from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats

DEG_H = math.radians(1.0) / 3600.0
"""One degree per hour [rad/s]."""
PPM = 1e-6
AXES = "xyz"


def _parameter(
    name: str, value: float, sigma: float, scale: float, *, unit: str
) -> SensorParameter:
    if not math.isfinite(value):
        return SensorParameter(name, None, None, unit)
    return SensorParameter(
        name, value / scale, sigma / scale if math.isfinite(sigma) else None, unit
    )


def gyro_parameters(triad: GyroTriad) -> tuple[SensorParameter, ...]:
    """The twelve parameters of a gyro triad."""
    tilt, sigma_tilt = triad.misalignment()
    scale, sigma_scale = triad.scale, triad.sigma_scale
    found = [
        _parameter(f"scale_factor_{a}", scale[i], sigma_scale[i], PPM, unit="ppm")
        for i, a in enumerate(AXES)
    ]
    found += _off_diagonal("misalignment", tilt, sigma_tilt)
    found += [
        _parameter(f"bias_{a}", triad.bias[i], triad.sigma_bias[i], DEG_H, unit="deg/h")
        for i, a in enumerate(AXES)
    ]
    return tuple(found)


def _off_diagonal(name: str, value: Floats, sigma: Floats) -> Iterator[SensorParameter]:
    for i, a in enumerate(AXES):
        for j, b in enumerate(AXES):
            if i != j:
                yield _parameter(f"{name}_{a}{b}", value[i, j], sigma[i, j], ARCSEC, unit="arcsec")


def accelerometer_parameters(triad: AccelerometerTriad) -> tuple[SensorParameter, ...]:
    """The twelve parameters of an accelerometer triad."""
    found = [
        _parameter(
            f"accelerometer_scale_factor_{a}", triad.scale[i], triad.sigma_scale[i], PPM, unit="ppm"
        )
        for i, a in enumerate(AXES)
    ]
    found += _off_diagonal(
        "accelerometer_misalignment", triad.misalignment, triad.sigma_misalignment
    )
    found += [
        _parameter(f"accelerometer_bias_{a}", triad.bias[i], triad.sigma_bias[i], 1.0, unit="m/s2")
        for i, a in enumerate(AXES)
    ]
    return tuple(found)


def undetermined(parameters: tuple[SensorParameter, ...]) -> tuple[str, ...]:
    """Names of those without a value."""
    return tuple(p.name for p in parameters if p.value is None)


def condition_of(matrix: Floats) -> float | None:
    """Condition of a matrix, None where it is not known throughout."""
    if not np.all(np.isfinite(matrix)):
        return None
    return float(np.linalg.cond(matrix))
