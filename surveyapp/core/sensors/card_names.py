"""Names of the parameters and constants that a sensor card may hold, by kind of sensor.

Every calibration writes, and every correction reads, names of these lists; what is spelt otherwise
would silently be nominal. Cards of other kinds are read by no correction.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import permutations, product
from typing import Final

from surveyapp.core.sensors import compass_attitude, compass_calibration, swing, tilt_axes
from surveyapp.core.sensors.dividing_head_rows import RANGES
from surveyapp.domain.sensor_entry import SensorKind

_AXES: Final = "xyz"
_TRIAD: Final = (
    *(f"scale_factor_{axis}" for axis in _AXES),
    *(f"misalignment_{a}{b}" for a, b in permutations(_AXES, 2)),
    *(f"bias_{axis}" for axis in _AXES),
)
_RATE: Final = (
    *_TRIAD,
    *(f"accelerometer_{name}" for name in _TRIAD),
    *(f"rest_rate_{axis}" for axis in _AXES),
    *(f"scale_factor_asymmetry_{axis}" for axis in _AXES),
    *(f"g_sensitivity_{a}{b}" for a, b in product(_AXES, repeat=2)),
)
_DIVIDING_HEAD: Final = (
    *("sensitivity", "zero", "zero_stability", "zero_stability_detrended", "tilt_reversal"),
    *(f"transverse_{test}" for test in ("seven_position", "sinusoid", "direction")),
    *(
        f"linearity_{span}{form}"
        for span in RANGES.values()
        for form in ("", "_small_angle", "_arcsine")
    ),
    *(f"capacitance_{plate}" for plate in ("upper", "lower")),
    *(f"capacitance_difference_over_{what}" for what in ("mean", "sum")),
    "bandwidth",
)
_COMPASS: Final = (*compass_calibration.NAMES, *compass_attitude.NAMES)

PARAMETERS: Final[Mapping[SensorKind, tuple[str, ...]]] = {
    "compass": (*_COMPASS, *swing.NAMES),
    "tilt": (*map("_".join, product(tilt_axes.TERMS, tilt_axes.AXES)), *_DIVIDING_HEAD),
    "rate": _RATE,
}
CONSTANTS: Final[Mapping[SensorKind, tuple[str, ...]]] = {
    "compass": (
        *(f"used_{name}" for name in _COMPASS),
        *("dip_deg", "heading_sigma_deg", "reading_sigma_uT", "reading_sigma_deg"),
        "largest_tilt_deg",
    ),
    "tilt": ("reference_temperature_c", "reading_sigma_arcsec", "largest_reading_arcsec"),
    "rate": ("reference_temperature_c",),
}
