"""Effects that a simulated log of a rate sensor can have, with the unit of their size."""

from __future__ import annotations

import math
from typing import Final

from surveyapp.core.simulate.rate.table_programmes import DEG_H
from surveyapp.core.simulate.specification import EffectKind
from surveyapp_models.angles import ARCSEC

TABLE_EFFECTS: Final = (
    EffectKind("flip_error", "arcsec", ARCSEC, "sigma of the seating about each body axis"),
    EffectKind("rate_error", "1", 1.0, "relative sigma of the table's rate, each way anew"),
    EffectKind("scale_asymmetry", "1", 1.0, "excess of the scale factor for positive rates"),
    EffectKind(
        "g_sensitivity", "deg/h/g", DEG_H, "bias of gyro x per g along y, half of it z to x"
    ),
    EffectKind("bias_ramp", "deg/h/h", DEG_H / 3600.0, "drift of every bias"),
    EffectKind("temperature", "deg/h/K", DEG_H, "bias per kelvin; the record warms by 5 K"),
    EffectKind("interference_line", "deg/h", DEG_H, "amplitude of a line", (("hz", 2.48),)),
    EffectKind("magnetic_sensitivity", "deg/h/uT", DEG_H, "bias per field along the axis"),
    EffectKind("gross_error", "deg/h", DEG_H, "output of gyro x is off in one position, clockwise"),
)
"""Effects of a unit on a table."""

STATIC_EFFECTS: Final = (
    *(e for e in TABLE_EFFECTS[4:8]),
    EffectKind("gross_error", "deg/h", DEG_H, "output of gyro x is off for a minute"),
)
"""Effects of a unit at rest."""

FOG_EFFECTS: Final = (
    EffectKind("rate_error", "1", 1.0, "relative sigma of the table's rate, each way anew"),
    EffectKind("scale_factor", "ppm", 1e-6, "error of the gyro's scale factor"),
    EffectKind("gross_error", "deg/h", DEG_H, "one set's output is off while turning clockwise"),
    *(e for e in TABLE_EFFECTS[4:7]),
)
"""Effects of a gyro on a total station."""

INDEXING_EFFECTS: Final = (
    EffectKind("index_error", "deg", math.radians(1.0), "error of every index angle but the first"),
    EffectKind(
        "g_sensitivity", "deg/h/g", DEG_H, "bias of gyro x per g along y, half of it z to x"
    ),
    EffectKind("bias_step", "deg/h", DEG_H, "step of the bias of x at the second stop"),
)
"""Effects of a unit that is turned at rest."""

VEHICLE_EFFECTS: Final = (
    EffectKind("noise", "1", 1.0, "factor on the noise and the vibration"),
    EffectKind("power_cycle", "1", 1.0, "number of the rest in which the unit was switched off"),
    EffectKind("gyro_drift", "deg/h", DEG_H, "bias of the vertical gyro from the first stop on"),
)
"""Effects of a vehicle."""

HAND_EFFECTS: Final = (
    EffectKind("g_sensitivity", "deg/s per m/s2", math.radians(1.0), "bias of each gyro per force"),
    EffectKind("temperature", "deg/s/K", math.radians(1.0), "bias per kelvin"),
    EffectKind("bias_ramp", "deg/s", math.radians(1.0), "drift of every bias over the record"),
    EffectKind("scale_asymmetry", "1", 1.0, "excess of the scale factor for positive rates"),
    EffectKind("gross_error", "deg/s", math.radians(1.0), "one stop of one gyro is off"),
    EffectKind("random_walk", "deg/s", math.radians(1.0), "walk of every bias from stop to stop"),
    EffectKind("stops", "1", 1.0, "number of stops"),
)
"""Effects of a unit that is turned by hand."""
