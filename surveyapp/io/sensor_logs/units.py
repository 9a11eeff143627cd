"""Units that a log may be given in, and the factor to the unit in which a column is held.

The token of a unit is case-sensitive: ``mg`` is a thousandth of g, ``mG`` a milligauss.
"""

from __future__ import annotations

import math
import re
from typing import Final

from surveyapp.domain.sensor_log import NUMBER_COLUMNS, STANDARD_GRAVITY_M_S2

COUNTS: Final = "LSB"
"""Counts of a converter: they mean nothing without a scale."""

DIMENSIONLESS: Final = "1"

_DEG: Final = math.pi / 180.0

UNITS: Final[dict[str, tuple[str, float]]] = {
    "uT": ("field", 1.0),
    "nT": ("field", 1e-3),
    "mT": ("field", 1e3),
    "G": ("field", 100.0),
    "mG": ("field", 0.1),
    "m/s2": ("acceleration", 1.0),
    "g": ("acceleration", STANDARD_GRAVITY_M_S2),
    "mg": ("acceleration", 1e-3 * STANDARD_GRAVITY_M_S2),
    "rad/s": ("rate", 1.0),
    "deg/s": ("rate", _DEG),
    "deg/h": ("rate", _DEG / 3600.0),
    "rad": ("angle", 1.0),
    "deg": ("angle", _DEG),
    "arcsec": ("angle", _DEG / 3600.0),
    "gon": ("angle", math.pi / 200.0),
    "s": ("time", 1.0),
    "ms": ("time", 1e-3),
    "us": ("time", 1e-6),
    "C": ("temperature", 1.0),
    "Hz": ("frequency", 1.0),
    "ohm": ("impedance", 1.0),
    "m": ("length", 1.0),
    "hPa": ("pressure", 1.0),
    "kPa": ("pressure", 10.0),
    "%": ("share", 1.0),
    COUNTS: ("counts", 1.0),
    DIMENSIONLESS: ("number", 1.0),
}
"""Token to dimension and value in the SI unit of the dimension (fields in uT)."""

_BRACKETS = re.compile(r"[(\[]\s*([^)\]]+?)\s*[)\]]\s*$")


def factor_to(column: str, unit: str) -> float | None:
    """Factor from a unit to that of a canonical column; None if the dimensions differ.

    Counts fit every column: their scale gives them the column's own unit.
    """
    held = NUMBER_COLUMNS[column]
    if unit == COUNTS:
        return 1.0
    dimension, factor = UNITS[unit]
    held_dimension, held_factor = UNITS[held]
    if dimension != held_dimension:
        return 1.0 if column == "output" else None
    return factor / held_factor


def unit_in_name(name: str) -> str | None:
    """Unit in brackets at the end of a column's name, as in ``Gyroscope X (deg/s)``."""
    match = _BRACKETS.search(name)
    return match[1] if match and match[1] in UNITS else None
